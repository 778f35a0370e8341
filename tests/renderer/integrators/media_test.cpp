// Light in media with known answers: a furnace, a glowing slab, one scattering.
#include "renderer/language/jsonc_reader.h"
#include "renderer/materials/bsdf.h"
#include "renderer/media/expression_medium.h"
#include "renderer/media/phase.h"
#include "renderer/scene/scene.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

#include <cmath>

namespace meristem {
void register_constant(LightRegistry& r);
void register_distant(LightRegistry& r);
void register_path(IntegratorRegistry& r);
void register_sobol(SamplerRegistry& r);

namespace {

struct Nothing : Intersector {
  bool intersect(const Ray&, SurfaceHit& hit) const override {
    hit = {};
    return false;
  }
  bool occluded(const Ray&) const override { return false; }
  Bounds3f bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
};

// A wall at x = 2, behind the medium.
struct Wall : Nothing {
  bool intersect(const Ray& ray, SurfaceHit& hit) const override {
    hit = {};
    const float t = (2 - ray.origin.x) / ray.direction.x;
    if (!(t > ray.t_min && t < ray.t_max)) return false;
    hit.t = t;
    hit.position = ray.origin + ray.direction * t;
    hit.geometric_normal = hit.shading_normal = {-1, 0, 0};
    hit.origin.material = 0;
    return true;
  }
};

struct Matte : Material {
  Bsdf evaluate(const ShadingPoint& point) const override {
    BsdfParameters bsdf;
    bsdf.diffuse = Spectrum(0.25f);
    bsdf.f0 = 0;
    return {bsdf, point};
  }
};

// A medium that fills [-1, 1]^3, and a ray through its middle.
struct Media : testing::Test {
  Media() {
    scene.intersector = std::make_unique<Nothing>();
    scene.sampler = make<Sampler>(register_sobol);
    scene.integrator = make<Integrator>(register_path);
    scene.settings.max_depth = 1000;
  }
  void add_medium(const std::string& text) {
    Diagnostics diagnostics;
    const Value value = read_jsonc(std::make_shared<SourceText>(SourceText{"test", text}), diagnostics);
    Params params(value, "medium", diagnostics);
    auto made = std::make_unique<ExpressionMedium>(params);
    params.finish();
    diagnostics.throw_if_errors();
    made->fill(scene.intersector->bounds());
    scene.media.push_back(std::move(made));
  }
  Spectrum one(int sample, FirstSurface* first = nullptr) {
    Ray ray;
    ray.origin = {-3, 0, 0};
    ray.direction = {1, 0, 0};
    scene.sampler->start(0, 0, sample, 1);
    return scene.integrator->radiance(ray, scene, *scene.sampler, counts, first);
  }
  Spectrum mean(int samples = 16384) {
    scene.prepare();
    Vec3d sum;
    for (int i = 0; i < samples; ++i) sum += Vec3d(one(i));
    return Spectrum(sum / double(samples));
  }

  Scene scene;
  RayCounts counts;
};

TEST_F(Media, WhiteMatterInAWhiteFurnaceCannotBeSeen) {
  scene.lights.push_back(make<Light>(register_constant, R"({ "color": [1, 1, 1] })"));
  add_medium(R"x({ "density": "2 + 1.5*snoise(3*P)", "anisotropy": 0.6 })x");
  add_medium(R"({ "density": 0.5, "anisotropy": -0.3, "from": [0, -1, -1], "to": [0.7, 2, 2] })");
  const Spectrum s = mean();
  EXPECT_NEAR(s.x, 1, 0.015);
  EXPECT_EQ(s.x, s.y);
}

TEST_F(Media, AGlowingSlabShowsAsMuchAsItHidesOfWhatIsBehind) {
  scene.lights.push_back(make<Light>(register_constant, R"({ "color": [1, 1, 1] })"));
  add_medium(R"({ "density": 0.8, "albedo": 0, "emission": [3, 0, 1] })");
  const double passed = std::exp(-0.8 * 2);
  const Spectrum s = mean();
  EXPECT_NEAR(s.x, passed + 3 * (1 - passed), 0.03);
  EXPECT_NEAR(s.y, passed, 0.01);
  EXPECT_NEAR(s.z, 1, 1e-4);
}

TEST_F(Media, OneScatteringOfTheSunIsTheIntegralAlongTheRay) {
  scene.settings.max_depth = 1;
  scene.lights.push_back(
      make<Light>(register_distant, R"({ "direction": [0, -1, 0], "irradiance": [5, 5, 5], "angle": 0 })"));
  add_medium(R"({ "density": 0.9, "albedo": [0.5, 1, 0], "anisotropy": 0.4 })");
  // From above every place on the ray lies 1 m deep
  const double expected = double(phase(0.4f, 0)) * 5 * std::exp(-0.9) * (1 - std::exp(-0.9 * 2));
  const Spectrum s = mean();
  EXPECT_NEAR(s.x, expected / 2, 0.01 * expected);
  EXPECT_NEAR(s.y, expected, 0.02 * expected);
  EXPECT_EQ(s.z, 0);
}

TEST_F(Media, TheSameSampleHasTheSameBits) {
  scene.lights.push_back(make<Light>(register_constant));
  add_medium(R"x({ "density": "3*turbulence(2*P)", "albedo": "cnoise(P)" })x");
  scene.prepare();
  std::vector<Spectrum> first;
  for (int i = 0; i < 200; ++i) first.push_back(one(i));
  for (int i = 199; i >= 0; --i) EXPECT_EQ(one(i), first[std::size_t(i)]);
}

// What guides a denoiser does not depend on where flights end; and the path not on whether anybody asks.
TEST_F(Media, TheFirstSurfaceIsSeenThroughTheMatter) {
  scene.intersector = std::make_unique<Wall>();
  scene.materials.push_back(std::make_unique<Matte>());
  scene.lights.push_back(make<Light>(register_constant));
  add_medium(R"({ "density": 0.6 })");
  scene.prepare();
  for (int i = 0; i < 200; ++i) {
    FirstSurface first;
    const Spectrum asked = one(i, &first);
    EXPECT_EQ(asked, one(i));
    EXPECT_EQ(first.hit.t, 5);
    EXPECT_EQ(first.albedo, Spectrum(0.25f));
  }
}

}  // namespace
}  // namespace meristem
