#include "renderer/image/image.h"
#include "renderer/materials/bsdf.h"
#include "renderer/materials/ggx.h"
#include "renderer/materials/material_symbols.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_openpbr(MaterialRegistry& r);

namespace {

struct OpenPbrTest : testing::Test {
  OpenPbrTest() {
    point.hit.geometric_normal = point.hit.shading_normal = {0, 1, 0};
    point.hit.u = 0.25f;
    point.hit.v = 0.75f;
    point.hit.position = {1, 2, 3};
    point.wo = {0, 1, 0};
    point.hit.origin.key = 17;
    point.hit.origin.parameters = {0.5f, 0.1f};
  }
  Bsdf bsdf(const std::string& text) { return make<Material>(register_openpbr, text)->evaluate(point); }

  ShadingPoint point;
};

TEST_F(OpenPbrTest, DefaultsAreThoseOfTheStandard) {
  const Bsdf b = bsdf("{}");
  EXPECT_EQ(b.diffuse, Spectrum(0.8f));
  EXPECT_NEAR(b.f0, 0.04f, 1e-6f);
  EXPECT_NEAR(b.alpha, 0.09f, 1e-6f);
  EXPECT_EQ(b.opacity, 1);
  EXPECT_EQ(b.metalness, 0);
  EXPECT_EQ(b.emission, Spectrum{});
  EXPECT_EQ(b.transmitted, Spectrum{});
}

TEST_F(OpenPbrTest, ParametersAreExpressionsOfTheHit) {
  EXPECT_EQ(bsdf(R"({ "base_color": "[u, v, p0]" })").diffuse, (Spectrum{0.25f, 0.75f, 0.5f}));
  EXPECT_EQ(bsdf(R"({ "base_color": "0.1*P" })").diffuse, (Spectrum{0.1f, 0.2f, 0.3f}));
  EXPECT_FLOAT_EQ(bsdf(R"json({ "base_metalness": "-dot(I, N)" })json").metalness, 1);
  EXPECT_FLOAT_EQ(bsdf(R"({ "specular_roughness": "p1" })").alpha, 0.01f);
  const float key = bsdf(R"({ "geometry_opacity": "key" })").opacity;
  EXPECT_TRUE(key > 0 && key < 1);
  point.hit.origin.key = 18;
  EXPECT_NE(bsdf(R"({ "geometry_opacity": "key" })").opacity, key);
}

TEST_F(OpenPbrTest, FacesWithoutOriginHaveZeroParameters) {
  point.hit.origin = {};
  EXPECT_EQ(bsdf(R"({ "base_color": "[p0, 0.5, p1]" })").diffuse, (Spectrum{0, 0.5f, 0}));
}

TEST_F(OpenPbrTest, ValuesOutOfRangeAreClamped) {
  EXPECT_EQ(bsdf(R"({ "base_color": "[-1, 0.5, 7]" })").diffuse, (Spectrum{0, 0.5f, 1}));
  EXPECT_EQ(bsdf(R"({ "specular_roughness": "u-1" })").alpha, ggx::min_alpha);
  EXPECT_EQ(bsdf(R"({ "specular_ior": "100*u" })").f0, ggx::max_f0);
}

TEST_F(OpenPbrTest, LeavesTransmitOnlyWhenThinWalled) {
  const std::string leaf = R"("base_color": 0.2, "subsurface_weight": 0.5, "subsurface_color": [0.2, 0.8, 0.1])";
  const Bsdf solid = bsdf("{" + leaf + "}");
  EXPECT_EQ(solid.transmitted, Spectrum{});
  EXPECT_FLOAT_EQ(solid.diffuse.y, 0.5f * 0.2f + 0.5f * 0.8f);
  const Bsdf thin = bsdf("{" + leaf + R"(, "geometry_thin_walled": true })");
  EXPECT_FLOAT_EQ(thin.transmitted.y, 0.25f * 0.8f);
  EXPECT_FLOAT_EQ(thin.diffuse.y, 0.5f * 0.2f + 0.25f * 0.8f);
  const Bsdf forward = bsdf("{" + leaf + R"(, "geometry_thin_walled": true, "subsurface_scatter_anisotropy": 1 })");
  EXPECT_FLOAT_EQ(forward.transmitted.y, 0.5f * 0.8f);
}

// A texture of two halves, black and white, beside the scene; and what expressions make of it.
TEST_F(OpenPbrTest, TexturesAreVariables) {
  const std::string folder = testing::TempDir(), name = "halves.exr";
  write_image(folder + name, Image{2, 1, 1, {0, 1}});
  auto color_at = [&](float u, const std::string& more, const std::string& expression) {
    point.hit.u = u;
    return make<Material>(register_openpbr,
                          R"({ "textures": { "half": { "file": ")" + name + "\"" + more + R"( } }, "base_color": ")" +
                              expression + "\" }",
                          folder + "scene.jsonc")
        ->evaluate(point)
        .diffuse;
  };
  EXPECT_EQ(color_at(0.25f, "", "half"), Spectrum{});
  EXPECT_EQ(color_at(0.75f, "", "half * [1, 0.5, 0.25]"), (Spectrum{1, 0.5f, 0.25f}));
  EXPECT_EQ(color_at(0.25f, R"(, "u": "u + 0.5")", "mix(0.5, half, 0.5)"), Spectrum(0.75f));
  EXPECT_EQ(color_at(0, R"(, "u": "P[0] - 0.25")", "half"), Spectrum(1.f));
  EXPECT_THROW(color_at(0, R"(, "wrap": "tile")", "half"), SceneErrors);
  EXPECT_THROW(color_at(0, "", "halv"), SceneErrors);
  std::remove((folder + name).c_str());
}

TEST_F(OpenPbrTest, TexturesStayBesideTheScene) {
  for (const char* file : {"/etc/hostname", "../a.png", "no/such.png"})
    EXPECT_THROW(
        make<Material>(register_openpbr, R"({ "textures": { "a": { "file": ")" + std::string(file) + "\" } } }"),
        SceneErrors)
        << file;
  EXPECT_THROW(make<Material>(register_openpbr, R"({ "textures": { "key": { "file": "a.png" } } })"), SceneErrors);
}

// A slope of 1 along x turns the normal by 45 degrees, also if the height is a function of u or v.
TEST_F(OpenPbrTest, BumpTiltsTheNormal) {
  point.hit.t = 2;
  point.hit.dpdu = {0.5f, 0, 0};  // u runs twice as fast as x, v as -z
  point.hit.dpdv = {0, 0, -1};
  const Vec3f wo = normalize(Vec3f{0.1f, 1, 0.2f});
  point.wo = wo;
  auto brightness = [&](const std::string& text, Vec3f wi) {
    return bsdf(R"({ "specular_weight": 0, "base_color": 1, "geometry_bump": ")" + text + "\" }").evaluate(wo, wi).x *
           pi_f;
  };
  const Vec3f along_x = normalize(Vec3f{-1, 1, 0}), along_z = normalize(Vec3f{0, 1, -1});
  const float terminator = 1;                                   // the geometric horizon is far
  EXPECT_NEAR(brightness("P[0]", along_x), terminator, 0.05f);  // rising along x, it faces -x
  EXPECT_NEAR(brightness("0.5*u", along_x), terminator, 0.05f);
  EXPECT_NEAR(brightness("-v", along_z), terminator, 0.05f);
  EXPECT_NEAR(brightness("0.001", along_x), std::sqrt(0.5f), 0.01f);
}

TEST_F(OpenPbrTest, GlassTintsByItsRootOrByDepth) {
  const Bsdf tinted = bsdf(R"({ "transmission_weight": 1, "transmission_color": [0.25, 1, 0.04] })");
  EXPECT_EQ(tinted.glass, 1);
  EXPECT_LT(length(tinted.glass_tint - Spectrum{0.5f, 1, 0.2f}), 1e-6f);
  EXPECT_EQ(tinted.absorption, Spectrum{});
  const Bsdf deep =
      bsdf(R"({ "transmission_weight": 1, "transmission_color": [0.5, 1, 0.25], "transmission_depth": 2 })");
  EXPECT_EQ(deep.glass_tint, Spectrum(1.f));
  EXPECT_LT(length(deep.absorption - Spectrum{0.34657f, 0, 0.69315f}), 1e-4f);  // ln 2 / 2, 0, ln 4 / 2
  const Bsdf window = bsdf(R"({ "transmission_weight": 1, "transmission_color": 0.25, "geometry_thin_walled": true })");
  EXPECT_TRUE(window.thin_walled);
  EXPECT_EQ(window.glass_tint, Spectrum(0.25f));
}

// The coat has an index of its own: below one of the same index a dielectric does not reflect.
TEST_F(OpenPbrTest, CoatAndFuzz) {
  const Bsdf same = bsdf(R"({ "coat_weight": 1, "coat_ior": 1.5, "coat_roughness": 0.5, "specular_roughness": 0 })");
  EXPECT_NEAR(same.f0, 0, 1e-6f);
  EXPECT_NEAR(same.coat_f0, 0.04f, 1e-6f);
  EXPECT_NEAR(same.coat_alpha, 0.25f, 1e-6f);
  EXPECT_GT(same.alpha, 0.25f);  // seen through a rough coat
  const Bsdf dusty = bsdf(R"({ "fuzz_weight": "u", "fuzz_color": [1, 0.5, 0] })");
  EXPECT_EQ(dusty.fuzz, 0.25f);
  EXPECT_EQ(dusty.fuzz_color, (Spectrum{1, 0.5f, 0}));
  EXPECT_EQ(dusty.coat, 0);
}

TEST_F(OpenPbrTest, KnowsWhetherItMayBeTransparent) {
  EXPECT_FALSE(make<Material>(register_openpbr)->may_be_transparent());
  EXPECT_TRUE(make<Material>(register_openpbr, R"({ "geometry_opacity": 0.5 })")->may_be_transparent());
  EXPECT_TRUE(make<Material>(register_openpbr, R"({ "geometry_opacity": "u < 0.5 ? 1 : 0" })")->may_be_transparent());
}

TEST_F(OpenPbrTest, EmissionIsARadiance) {
  EXPECT_EQ(bsdf(R"({ "emission_luminance": 3, "emission_color": [1, 0.5, 0] })").emission, (Spectrum{3, 1.5f, 0}));
}

// White bases below a clear coat, in even light from all sides: all of it comes back, at any angle.
struct CoatedBase {
  const char* name;
  const char* parameters;
};
class WhiteFurnace : public OpenPbrTest, public testing::WithParamInterface<CoatedBase> {
 protected:
  // To some 0.0005: each lobe gets a run of the spread pairs.
  static double given_back(const Bsdf& bsdf, Vec3f wo) {
    constexpr int count = 20000;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      const double x = 0.5 + 0.7548776662466927 * i, y = 0.5 + 0.5698402909980532 * i;
      const Vec2f random{float(x - std::floor(x)) * 0.999999f, float(y - std::floor(y)) * 0.999999f};
      const BsdfSample s = bsdf.sample(wo, random, (float(i) + 0.5f) / count);
      if (s.pdf > 0) sum += double(s.weight.y);
    }
    return sum / count;
  }
};
INSTANTIATE_TEST_SUITE_P(
    , WhiteFurnace,
    testing::Values(CoatedBase{"diffuse", R"("specular_weight": 0)"}, CoatedBase{"metal", R"("base_metalness": 1)"},
                    CoatedBase{"glossy", R"("specular_roughness": 0.1)"},
                    CoatedBase{"rough", R"("base_diffuse_roughness": 1, "specular_weight": 0)"},
                    CoatedBase{"rough_glossy", R"("base_diffuse_roughness": 0.5)"},
                    CoatedBase{"rough_fuzzy", R"("base_diffuse_roughness": 1, "fuzz_weight": 0.8)"},
                    CoatedBase{"half_metal", R"("base_metalness": 0.5, "specular_ior": 1.8)"}),
    [](const auto& test) { return test.param.name; });

TEST_P(WhiteFurnace, CoatsLoseNoLight) {
  for (const char* roughness : {"0", "0.1", "0.3", "0.6", "1"})
    for (const char* ior : {"1.05", "1.3", "1.5", "1.8"}) {
      const auto material = make<Material>(
          register_openpbr, std::string(R"({ "base_color": 1, "coat_weight": 1, "coat_roughness": )") + roughness +
                                R"(, "coat_ior": )" + ior + ", " + GetParam().parameters + "}");
      for (float c : {0.02f, 0.1f, 0.3f, 0.6f, 1.f}) {
        point.wo = {std::sqrt(1 - c * c), c, 0};
        const Bsdf bsdf = material->evaluate(point);
        EXPECT_NEAR(given_back(bsdf, point.wo), 1, 0.001) << "roughness " << roughness << ", ior " << ior << ", " << c;
      }
    }
}

}  // namespace
}  // namespace meristem
