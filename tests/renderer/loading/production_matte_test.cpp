// Which production made what is seen: in hits, in the matte and in its manifest.
#include "renderer/film/cryptomatte.h"
#include "renderer/film/film_parts.h"
#include "renderer/loading/load_scene.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/part_values.h"
#include "tests/renderer/image/scratch_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <map>

namespace meristem {
namespace {

using Names = std::vector<std::string>;

// A square column of four pieces, each 1 m high: base, two by the first rule, one by the second; the last face on top
// by a rule of a later step, after a subdivision with sharp edges.
const std::string column = R"json({ "format": 1,
  "models": {
    "column": { "base": { "type": "box", "crease": 10, "top": "stem(3)" },
      "steps": [
        { "grow": 4, "rules": { "stem(k)": [
            { "if": "k > 1", "template": "segment", "faces": { "cap": "stem(k - 1)" }, "crease": 10 },
            { "if": "k == 1", "template": "segment", "faces": { "cap": "top" }, "crease": 10 } ] } },
        { "subdivide": 2 },
        { "grow": 1, "rules": { "top": { "template": "spike", "length": 0.02 } } } ] },
    "never seen": { "base": { "type": "sphere" } } },
  "objects": [ { "model": "column", "name": "a" },
               { "model": "column", "name": "b", "seed": 7, "position": [40, 0, 0] } ],
  "camera": { "from": [0, 2, 400], "to": [0, 2, 0], "fov": 1 },
  "render": { "size": [96, 54], "samples": 16, "max_depth": 0, "detail": 0, "filter": { "type": "box" } } })json";

class ProductionMatte : public testing::Test {
 protected:
  LoadedScene load(const std::string& text, ExpandMode mode = ExpandMode::Lazy) const {
    std::ofstream(path_) << text;
    LoadOptions options;
    options.expand = mode;
    options.aovs = {Aov::CryptoObject, Aov::CryptoProduction};
    return load_scene(path_, options);
  }

  // Of what a ray meets, with the fields that hits of the same face share.
  static std::string production(const Scene& scene, Vec3f from, Vec3f direction, SurfaceHit* met = nullptr) {
    Ray ray;
    ray.origin = from;
    ray.direction = direction;
    SurfaceHit hit;
    if (!scene.intersector->intersect(ray, hit)) return "nothing";
    if (met) *met = hit;
    return hit.origin.production == no_production ? "none" : scene.names.productions[hit.origin.production];
  }

  ScratchFolder folder_;
  const std::string path_ = folder_ / "scene.jsonc";
};

TEST_F(ProductionMatte, FacesKnowWhatMadeThem) {
  for (const ExpandMode mode : {ExpandMode::Lazy, ExpandMode::Eager, ExpandMode::Flat}) {
    const LoadedScene loaded = load(column, mode);
    EXPECT_EQ(loaded.scene->names.productions,
              (Names{"column/box", "column/stem[0]", "column/stem[1]", "column/top[0]"}));
    for (const float x : {0.f, 40.f}) {  // another individual of the same model
      const auto at_height = [&](float y) { return production(*loaded.scene, {x, y, 9}, {0, 0, -1}); };
      EXPECT_EQ(at_height(0.5f), "column/box");
      EXPECT_EQ(at_height(1.1f), "column/stem[0]");
      EXPECT_EQ(at_height(2.9f), "column/stem[0]");
      EXPECT_EQ(at_height(3.1f), "column/stem[1]");
      EXPECT_EQ(production(*loaded.scene, {x + 0.3f, 9, 0.1f}, {0, -1, 0}), "column/top[0]");
      EXPECT_EQ(production(*loaded.scene, {x + 0.3f, -9, 0.1f}, {0, 1, 0}), "column/box");
    }
  }
}

TEST_F(ProductionMatte, CoverageIsThatOfWhatEachProductionMade) {
  std::map<ExpandMode, std::vector<float>> pixels;
  for (const ExpandMode mode : {ExpandMode::Lazy, ExpandMode::Eager}) {
    const LoadedScene loaded = load(column, mode);
    RenderSession session(*loaded.scene, {.threads = 2});
    session.render();
    const auto parts = film_parts(session.film(), loaded.scene->names, false);
    ASSERT_EQ(parts.back().name, "crypto_production");
    pixels[mode] = values_of(parts.back());

    // Ranks by the names of the manifest
    const Names& names = loaded.scene->names.productions;
    const auto hashes = cryptomatte::name_hashes(names);
    const auto& manifest = std::ranges::find_if(parts.back().metadata, [](const auto& entry) {
                             return entry.first.ends_with("/manifest");
                           })->second;
    std::map<std::string, double> coverage;
    for (std::size_t i = 0; i < pixels[mode].size(); i += 2) {
      if (pixels[mode][i + 1] == 0) continue;
      const auto found = std::ranges::find(hashes, std::bit_cast<std::uint32_t>(pixels[mode][i]));
      ASSERT_NE(found, hashes.end());
      coverage[names[std::size_t(found - hashes.begin())]] += double(pixels[mode][i + 1]);
    }
    for (std::size_t i = 0; i < names.size(); ++i)
      EXPECT_NE(manifest.find(fmt::format("\"{}\":\"{:08x}\"", names[i], hashes[i])), std::string::npos) << manifest;
    EXPECT_EQ(manifest.find("never seen"), std::string::npos);

    // Pieces of one height and width, seen from far away: 1 m is as many pixels
    const double metre = 54 / (2 * 400 * std::tan(0.5 * pi / 180));
    const double piece = metre * metre;
    EXPECT_NEAR(coverage["column/box"], piece, 0.03 * piece);
    EXPECT_NEAR(coverage["column/stem[0]"], 2 * piece, 0.03 * piece);
    EXPECT_NEAR(coverage["column/stem[1]"], piece, 0.03 * piece);
    EXPECT_LT(coverage["column/top[0]"], 0.03 * piece);
    // Whatever an object shows, some production made
    const Image object = session.film().develop_matte(Aov::CryptoObject, cryptomatte::name_hashes({"a", "b"}), 1);
    double of_objects = 0, of_productions = 0;
    for (std::size_t i = 1; i < object.pixels.size(); i += 2) of_objects += double(object.pixels[i]);
    for (const auto& [name, sum] : coverage) of_productions += sum;
    EXPECT_DOUBLE_EQ(of_productions, of_objects);
  }
  EXPECT_EQ(pixels[ExpandMode::Lazy], pixels[ExpandMode::Eager]);
}

TEST_F(ProductionMatte, ATreeIsStemsByLevelAndLeaves) {
  const LoadedScene loaded = load(R"json({ "format": 1,
    "models": { "aspen": { "base": { "type": "weber_penn", "species": "quaking_aspen", "leaf_material": "leaf" },
                           "material": "bark", "steps": [ { "subdivide": 1 } ] } },
    "materials": { "bark": {}, "leaf": {} },
    "objects": [ { "model": "aspen" } ],
    "camera": { "from": [0, 6, 20], "to": [0, 6, 0] }, "render": { "size": [64, 36] } })json");
  const Names& names = loaded.scene->names.productions;
  EXPECT_EQ(names, (Names{"aspen/weber_penn", "aspen/trunk", "aspen/branches", "aspen/twigs", "aspen/leaves"}));
  std::map<std::string, int> seen;
  for (int i = 0; i < 120; ++i)
    for (int j = 0; j < 120; ++j) {
      const Vec3f from{-5 + float(i) / 12, 0.05f + float(j) / 9, 20};
      SurfaceHit hit;
      const std::string name = production(*loaded.scene, from, {0, 0, -1}, &hit);
      ++seen[name];
      if (name == "nothing") continue;
      EXPECT_EQ(name == "aspen/leaves", loaded.scene->names.materials[std::size_t(hit.origin.material)] == "leaf");
      // The level that the parameters of a stem say
      const float level = hit.origin.parameters[0];
      EXPECT_TRUE(name != "aspen/trunk" || level == 0) << level;
      EXPECT_TRUE(name != "aspen/branches" || level == 1) << level;
      EXPECT_TRUE(name != "aspen/twigs" || level == 2) << level;
    }
  for (const char* name : {"aspen/trunk", "aspen/branches", "aspen/twigs", "aspen/leaves"}) EXPECT_GT(seen[name], 5);
  EXPECT_EQ(seen["none"], 0);
}

}  // namespace
}  // namespace meristem
