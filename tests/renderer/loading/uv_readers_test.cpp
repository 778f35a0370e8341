// Which surfaces keep u and v: those that a material, an AOV or the caller asks for.
#include "renderer/loading/load_scene.h"
#include "tests/renderer/image/scratch_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

namespace meristem {
namespace {

class UvReading : public testing::TestWithParam<ExpandMode> {
 protected:
  // What a ray meets that looks down on a plane of that material beside another that reads u.
  SurfaceHit hit_on(const std::string& material, LoadOptions options = {}) {
    const std::string path = folder_ / "scene.jsonc";
    std::ofstream(path) << fmt::format(R"json({{
        "materials": {{ "asked": {}, "other": {{ "base_color": "u" }} }},
        "models": {{ "near": {{ "base": {{ "type": "plane", "columns": 2, "rows": 2 }}, "material": "asked",
                                "steps": [ {{ "subdivide": 2 }} ] }},
                     "far": {{ "base": {{ "type": "plane" }}, "material": "other" }} }},
        "objects": [ {{ "model": "near" }}, {{ "model": "far", "position": [9, 0, 0] }} ],
        "camera": {{ "from": [0, 3, 1], "to": [0, 0, 0] }}, "render": {{ "size": [64, 64] }} }})json",
                                       material);
    options.threads = 1;
    options.expand = GetParam();
    const LoadedScene loaded = load_scene(path, options);
    SurfaceHit hit;
    EXPECT_TRUE(loaded.scene->intersector->intersect({{0.15f, 2, 0.1f}, {0, -1, 0}}, hit));
    return hit;
  }
  void expect_uv(const SurfaceHit& hit) {
    EXPECT_GT(hit.u, 0);
    EXPECT_GT(hit.v, 0);
    EXPECT_NE(hit.dpdu, Vec3f());
  }

 private:
  ScratchFolder folder_;
};

TEST_P(UvReading, OfMaterialsThatDoNotHitsHaveNone) {
  for (const char* material : {"{}", R"({ "base_color": [1, 0, 0] })", R"({ "base_color": "fbm(P) + key + N" })"}) {
    const SurfaceHit hit = hit_on(material);
    EXPECT_EQ(hit.u, 0) << material;
    EXPECT_EQ(hit.v, 0) << material;
    EXPECT_EQ(hit.dpdu, Vec3f()) << material;
  }
}

TEST_P(UvReading, OfMaterialsThatDoHitsHaveThem) {
  for (const char* material :
       {R"json({ "base_color": "u" })json", R"json({ "specular_roughness": "v" })json",
        R"json({ "geometry_bump": "0.01*sin(40*u)" })json", R"json({ "emission_luminance": "v" })json"})
    expect_uv(hit_on(material));
}

TEST_P(UvReading, WhoeverAsksGetsThem) {
  LoadOptions with_aov, all;
  with_aov.aovs = {Aov::Uv};
  all.keeps_uv = true;
  expect_uv(hit_on("{}", with_aov));
  expect_uv(hit_on("{}", all));
}

INSTANTIATE_TEST_SUITE_P(Modes, UvReading, testing::Values(ExpandMode::Lazy, ExpandMode::Eager, ExpandMode::Flat),
                         [](const auto& mode) {
                           return mode.param == ExpandMode::Lazy    ? "Lazy"
                                  : mode.param == ExpandMode::Eager ? "Eager"
                                                                    : "Flat";
                         });

}  // namespace
}  // namespace meristem
