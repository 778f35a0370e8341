// Light transport in scenes with known answers, over analytic shapes that need no tracing library.
#include "renderer/materials/bsdf.h"
#include "renderer/materials/ggx.h"
#include "renderer/scene/ray_origin.h"
#include "renderer/scene/scene.h"
#include "renderer/scene/warps.h"
#include "tests/support/component.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <vector>

namespace meristem {
void register_ambient_occlusion(IntegratorRegistry& r);
void register_constant(LightRegistry& r);
void register_distant(LightRegistry& r);
void register_normals(IntegratorRegistry& r);
void register_path(IntegratorRegistry& r);
void register_rectangle(LightRegistry& r);
void register_sobol(SamplerRegistry& r);
void register_sphere(LightRegistry& r);

namespace {

// Spheres and level squares.
struct Analytic : Intersector {
  struct Ball {
    Vec3d center;
    double radius;
    FaceOrigin origin;
  };
  struct Floor {
    double y, half_width;
    FaceOrigin origin;
  };
  std::vector<Ball> balls;
  std::vector<Floor> floors;

  mutable std::vector<std::pair<RayClass, RayClass>> classes;  // of the rays, and of where they begin

  bool intersect(const Ray& ray, SurfaceHit& hit) const override {
    classes.emplace_back(ray.ray_class, ray.origin_class);
    hit = {};
    const Vec3d o(ray.origin), d(ray.direction);
    double nearest = ray.t_max;
    auto meet = [&](double t, Vec3d normal, const FaceOrigin& origin) {
      if (!(t > ray.t_min && t < nearest)) return;
      nearest = t;
      hit.t = float(t);
      hit.position = Vec3f(o + d * t);
      hit.position_error = abs(hit.position) * 0x1p-21f + Vec3f(0x1p-21f);
      hit.geometric_normal = hit.shading_normal = Vec3f(normal);
      hit.origin = origin;
    };
    for (const Ball& b : balls) {
      const Vec3d v = o - b.center;
      const double middle = -dot(v, d), reach2 = b.radius * b.radius - length_squared(v + d * middle);
      if (reach2 < 0) continue;
      for (double t : {middle - std::sqrt(reach2), middle + std::sqrt(reach2)}) meet(t, normalize(v + d * t), b.origin);
    }
    for (const Floor& f : floors) {
      const double t = (f.y - o.y) / d.y;
      const Vec3d p = o + d * t;
      if (std::abs(p.x) < f.half_width && std::abs(p.z) < f.half_width) meet(t, {0, 1, 0}, f.origin);
    }
    return hit.valid();
  }
  bool occluded(const Ray& ray) const override {
    SurfaceHit hit;
    return intersect(ray, hit);
  }
  Bounds3f bounds() const override { return {{-5, -5, -5}, {5, 5, 5}}; }
};

struct Matte : Material {
  Spectrum albedo{0.5f, 0.5f, 0.5f};
  float specular = 0, alpha = 0.09f, opacity = 1, glass = 0;
  Spectrum emission, absorption;
  Bsdf evaluate(const ShadingPoint& point) const override {
    BsdfParameters bsdf;
    bsdf.diffuse = albedo;
    bsdf.f0 = specular;
    bsdf.alpha = alpha;
    bsdf.opacity = opacity;
    bsdf.emission = emission;
    bsdf.glass = glass;
    bsdf.absorption = absorption;
    return {bsdf, point};
  }
  bool may_be_transparent() const override { return opacity < 1; }
  bool may_emit() const override { return emission != Spectrum{}; }
};

struct Transport : testing::Test {
  Transport() {
    scene.intersector.reset(world);
    scene.sampler = make<Sampler>(register_sobol);
    scene.integrator = make<Integrator>(register_path);
    scene.settings.max_depth = 1000;
    add_material();
  }
  Matte& add_material() {
    scene.materials.push_back(std::make_unique<Matte>());
    return static_cast<Matte&>(*scene.materials.back());
  }
  void add_ball(Vec3d center, double radius, int material = 0) {
    world->balls.push_back({center, radius, {1, material}});
  }
  void add_floor(double y, int material = 0, double half_width = 1e3) {
    world->floors.push_back({y, half_width, {2, material}});
  }
  // The mean over `samples` paths of one ray.
  Spectrum radiance(Vec3f origin, Vec3f direction, int samples = 4096) {
    Ray ray;
    ray.origin = origin;
    ray.direction = normalize(direction);
    Vec3d sum;
    scene.prepare();
    for (int i = 0; i < samples; ++i) {
      scene.sampler->start(0, 0, i, 1);
      const Spectrum value = scene.integrator->radiance(ray, scene, *scene.sampler, counts, nullptr);
      EXPECT_TRUE(is_finite(value));
      sum += Vec3d(value);
    }
    return Spectrum(sum / double(samples));
  }

  Analytic* const world = new Analytic;  // owned by the scene
  Scene scene;
  RayCounts counts;
};

// A lamp that the camera does not see: a mirror shows it as any other lamp, of a few paths without fireflies.
TEST_F(Transport, MirrorsShowLampsThatTheCameraDoesNotSee) {
  Matte& mirror = static_cast<Matte&>(*scene.materials[0]);
  mirror.albedo = {};
  mirror.specular = 0.25f;
  mirror.alpha = 0.002f;
  add_floor(0);
  const std::string lamp = R"({ "center": [2, 2, 0], "radius": 0.4, "intensity": 16)";
  scene.lights.push_back(make<Light>(register_sphere, lamp + R"(, "visible": false })"));
  EXPECT_EQ(radiance({2, 2, 5}, {0, 0, -1}, 16).x, 0);
  const float hidden = radiance({-2, 2, 0}, {1, -1, 0}, 16).x;
  scene.lights[0] = make<Light>(register_sphere, lamp + " }");
  EXPECT_EQ(radiance({2, 2, 5}, {0, 0, -1}, 16).x, 16);
  EXPECT_EQ(hidden, radiance({-2, 2, 0}, {1, -1, 0}, 16).x);
  EXPECT_NEAR(hidden, 16 * ggx::fresnel_dielectric(std::sqrt(0.5f), ggx::eta_of(0.25f)), 0.1);
}

// Light without a background: for pictures that are laid over others.
TEST_F(Transport, SurroundingsThatAreHiddenFromTheCameraLightAllTheSame) {
  add_floor(0);
  scene.lights.push_back(make<Light>(register_constant));
  const float lit = radiance({0, 2, 0}, {0, -1, 0}, 256).x;
  EXPECT_EQ(radiance({0, 2, 0}, {0, 1, 0}, 16).x, 1);
  scene.lights[0] = make<Light>(register_constant, R"({ "visible": false })");
  EXPECT_EQ(radiance({0, 2, 0}, {0, 1, 0}, 16).x, 0);
  EXPECT_EQ(radiance({0, 2, 0}, {0, -1, 0}, 256).x, lit);
}

TEST_F(Transport, WhiteBallInWhiteSurroundingsIsInvisible) {
  Matte& white = static_cast<Matte&>(*scene.materials[0]);
  white.albedo = Spectrum(1.f);
  white.specular = 0.04f;
  add_ball({0, 0, 0}, 1);
  scene.lights.push_back(make<Light>(register_constant));
  for (float x : {0.f, 0.5f, 0.95f}) EXPECT_NEAR(radiance({x, 0, 5}, {0, 0, -1}).x, 1, 0.02) << x;
}

// Glass without a tint hides nothing in even surroundings; what it absorbs follows Beer's law: a ray through the middle
// of the ball crosses 2 m, but for what is reflected.
TEST_F(Transport, GlassBallInWhiteSurroundings) {
  Matte& glass = static_cast<Matte&>(*scene.materials[0]);
  glass.glass = 1;
  glass.specular = 0.04f;
  add_ball({0, 0, 0}, 1);
  scene.lights.push_back(make<Light>(register_constant));
  for (float x : {0.f, 0.5f, 0.95f}) EXPECT_NEAR(radiance({x, 0, 5}, {0, 0, -1}, 16384).x, 1, 0.01) << x;
  glass.absorption = {0.5f, 1000, 0};
  scene.settings.max_depth = 2;  // in and out
  const double straight = 0.04 + 0.96 * 0.96 * std::exp(-1);
  EXPECT_NEAR(radiance({0.01f, 0, 5}, {0, 0, -1}, 16384).x, straight, 0.02);
  EXPECT_NEAR(radiance({0.01f, 0, 5}, {0, 0, -1}, 16384).y, 0.04, 0.01);
}

// Inside a closed ball that glows with 1 and reflects 0.5, radiance is 1 / (1 - 0.5) everywhere.
TEST_F(Transport, GlowingBallFromInside) {
  static_cast<Matte&>(*scene.materials[0]).emission = Spectrum(1.f);
  add_ball({0, 0, 0}, 2);
  EXPECT_NEAR(radiance({0.3f, 0.1f, 0.2f}, {1, 2, 3}).x, 2, 0.05);
  scene.settings.max_depth = 1;
  EXPECT_NEAR(radiance({0.3f, 0.1f, 0.2f}, {1, 2, 3}).x, 1.5, 1e-4);
  scene.settings.max_depth = 0;
  EXPECT_EQ(radiance({0.3f, 0.1f, 0.2f}, {1, 2, 3}, 16).x, 1);
}

// Light that is scattered widely and light that is asked for have classes of their own; mirrors show what the camera
// would see.
TEST_F(Transport, RaysTellTheirClass) {
  using enum RayClass;
  add_ball({0, 0, 0}, 2);
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 0, 0], "radius": 0.5, "intensity": 16 })"));
  scene.settings.max_depth = 2;
  radiance({1, 0, 0}, {1, 0.2f, 0.1f}, 1);
  EXPECT_EQ(world->classes, (std::vector{std::pair(Camera, Camera), std::pair(Shadow, Camera),
                                         std::pair(Diffuse, Camera), std::pair(Shadow, Diffuse)}));
  world->classes.clear();
  scene.lights.push_back(make<Light>(register_constant));
  static_cast<Matte&>(*scene.materials[0]).glass = 1;
  scene.settings.max_depth = 1;
  for (int i = 0; i < 16; ++i) radiance({1, 0, 0}, {1, 0.2f, 0.1f}, 1);
  EXPECT_EQ(std::ranges::count(world->classes, std::pair(Camera, Camera)), 32);
}

// A lamp in the middle of a closed white-washed ball of radius R: irradiance is even, E = pi L (r/R)^2, and all bounces
// together give albedo / (1 - albedo) * E / pi.
TEST_F(Transport, LampInsideAnIntegratingSphere) {
  add_ball({0, 0, 0}, 2);
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 0, 0], "radius": 0.5, "intensity": 16 })"));
  EXPECT_NEAR(radiance({1, 0, 0}, {1, 0.2f, 0.1f}, 16384).x, 1, 0.02);
}

// Direct light on a floor below the corner of a lamp; see light_test.cpp for the closed form.
TEST_F(Transport, DirectLightOfARectangle) {
  add_floor(0);
  scene.settings.max_depth = 1;
  scene.lights.push_back(make<Light>(register_rectangle, R"({ "from": [1, 1.5, 0.5], "to": [1, 0, 0.5], "up": [0, 0, 1],
                                                             "width": 2, "height": 1, "intensity": 1 })"));
  const double a = 2, b = 1, d = 1.5, ra = std::hypot(a, d), rb = std::hypot(b, d);
  const double irradiance = 0.5 * (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb));
  EXPECT_NEAR(radiance({0, 1, -2}, {0, -1, 2}).x, 0.5 * irradiance / pi, 3e-4);
}

TEST_F(Transport, CameraSeesLampsAndBothStrategiesAddUp) {
  add_floor(0);
  scene.lights.push_back(make<Light>(register_constant, R"({ "intensity": 0.25 })"));
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 2, 0], "radius": 1, "intensity": 3 })"));
  EXPECT_FLOAT_EQ(radiance({0, 2, 5}, {0, 0, -1}, 16).x, 3.25f);  // lamps hide nothing
  scene.settings.max_depth = 1;
  const double expected = 0.5 * (0.25 + 3 * 0.25);  // sphere: L (r/d)^2 with d = 2
  EXPECT_NEAR(radiance({0, 1, -2}, {0, -1, 2}).x, expected, 0.01);
}

TEST_F(Transport, BlockersCastShadows) {
  add_floor(0);
  add_ball({0, 1, 0}, 0.5);
  scene.settings.max_depth = 1;
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 4, 0], "radius": 0.1 })"));
  EXPECT_EQ(radiance({0, 0.2f, -2}, {0, -0.1f, 1}, 64).x, 0);
  EXPECT_GT(radiance({3, 0.2f, -2}, {0, -0.1f, 1}, 64).x, 0);
}

// Two veils of opacity 0.4 between floor and lamp, and the camera behind them as well: each passes 0.6 of the light.
TEST_F(Transport, OpacityDimsCameraAndShadowRaysAlike) {
  add_floor(0);
  Matte& veil = add_material();
  veil.albedo = {};
  veil.opacity = 0.4f;
  add_floor(1, 1);
  add_floor(1.5, 1);
  scene.settings.max_depth = 1;
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 4, 0], "radius": 1, "intensity": 16 })"));
  const double direct = 0.5 * 16.0 / 16;
  EXPECT_NEAR(radiance({0, 3, -3}, {0, -1, 1}, 16384).x, direct * std::pow(0.6, 4), 0.01);
}

TEST_F(Transport, RouletteChangesNoiseAlone) {
  add_ball({0, 0, 0}, 2);
  static_cast<Matte&>(*scene.materials[0]).emission = Spectrum(1.f);
  scene.integrator = make<Integrator>(register_path, R"({ "roulette_depth": 1 })");
  EXPECT_NEAR(radiance({0, 0, 0}, {1, 2, 3}, 16384).x, 2, 0.05);
}

// Faint light and faint paths: half of the rays, the same mean.
TEST_F(Transport, RouletteOfFaintLightChangesNoiseAlone) {
  add_ball({0, 1, 0}, 1);
  add_floor(0);
  scene.lights.push_back(make<Light>(register_constant));
  const auto rays_and_light = [&](const char* parameters) {
    scene.integrator = make<Integrator>(register_path, parameters);
    counts = {};
    const Spectrum light = radiance({0, 1, 3}, {0.35f, -1, -1.5f}, 16384);
    return std::pair(counts.bounce + counts.shadow, light.x);
  };
  const auto [all, expected] = rays_and_light(R"({ "roulette_throughput": 0, "roulette_light": 0 })");
  const auto [few, light] = rays_and_light(R"({ "roulette_throughput": 1, "roulette_light": 2 })");
  EXPECT_LT(double(few), 0.7 * double(all));
  EXPECT_NEAR(light, expected, 0.01);
}

TEST_F(Transport, CountsRays) {
  add_floor(0);
  scene.settings.max_depth = 1;
  scene.lights.push_back(make<Light>(register_constant));  // which is not asked
  scene.integrator = make<Integrator>(register_path, R"({ "roulette_light": 0 })");
  const auto shadow_rays = [&] {
    counts = {};
    radiance({0, 1, 0}, {0, -1, 0.1f}, 64);
    return counts.shadow;
  };
  EXPECT_EQ(shadow_rays(), 0u);
  EXPECT_EQ(counts.camera, 64u);
  EXPECT_LE(counts.bounce, 64u);
  scene.lights.push_back(make<Light>(register_distant));
  EXPECT_EQ(shadow_rays(), 64u);
}

// The last ray of a path among dark surfaces is only asked whether it gets out; without an environment and away from
// lamps it is not traced at all. Another material that glows, and is seen by nobody, makes it a ray like others: the
// same light.
TEST_F(Transport, LastRaysAskForNothingThatCannotMatter) {
  add_floor(0);
  add_ball({0, 1, 0}, 1);
  scene.settings.max_depth = 2;
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [3, 1, 0], "radius": 0.2, "intensity": 9 })"));
  const auto rays_and_light = [&] {
    counts = {};
    const Spectrum light = radiance({2, 2, 3}, {-1, -1, -1.5f}, 256);
    return std::pair(counts.bounce, light);
  };
  const auto [few, of_lamp] = rays_and_light();
  scene.lights.push_back(make<Light>(register_constant));
  const auto [more, of_both] = rays_and_light();
  add_material().emission = Spectrum(1.f);
  EXPECT_EQ(rays_and_light(), std::pair(more, of_both));
  scene.lights.pop_back();
  const auto [all, of_lamp_again] = rays_and_light();
  EXPECT_EQ(of_lamp_again, of_lamp);
  EXPECT_LT(few, all);
}

// Paths that take turns, each known between its rays by a copied state and a count of random numbers alone, end with
// the bits of paths that are followed at once.
TEST_F(Transport, PathsThatWaitEndWithTheSameBits) {
  add_ball({0, 1, 0}, 1);
  add_floor(0);
  Matte& veil = add_material();
  veil.opacity = 0.4f;
  add_floor(1.5, 1, 2);
  Matte& glass = add_material();
  glass.glass = 1;
  glass.absorption = {0.5f, 1, 0};
  add_ball({2, 1, 0}, 0.8, 2);
  scene.settings.max_depth = 8;
  scene.lights.push_back(make<Light>(register_constant));
  scene.lights.push_back(make<Light>(register_sphere, R"({ "center": [0, 4, 0], "radius": 0.3, "intensity": 50 })"));
  scene.prepare();
  const PathStepper* stepper = scene.integrator->stepper();
  ASSERT_NE(stepper, nullptr);

  struct Waiting {
    std::vector<std::max_align_t> state;
    std::uint32_t dimension = 0;
  };
  constexpr int count = 500;
  std::vector<Ray> rays;
  std::vector<Spectrum> expected;
  std::vector<Waiting> paths(count);
  RayCounts at_once, in_turn;
  for (int i = 0; i < count; ++i) {
    rays.push_back({{0, 2, 6},
                    normalize(Vec3f{uniform_float(hash_keys(Key(i), 1)) - 0.5f,
                                    -0.3f * uniform_float(hash_keys(Key(i), 2)), -1})});
    scene.sampler->start(i, 0, 3, 1);
    expected.push_back(scene.integrator->radiance(rays.back(), scene, *scene.sampler, at_once, nullptr));
    scene.sampler->start(i, 0, 3, 1);
    paths[std::size_t(i)].state.resize(stepper->state_bytes() / sizeof(std::max_align_t) + 1);
    stepper->begin(paths[std::size_t(i)].state.data(), rays.back(), {scene, *scene.sampler, in_turn, nullptr});
  }
  for (int alive = count, turn = 0; alive > 0; ++turn) {
    alive = 0;
    for (int i = 0; i < count; ++i) {
      Waiting& path = paths[std::size_t(i)];
      path.state = std::vector(path.state);  // lies somewhere else
      const int ray = stepper->request(path.state.data(), 0).kind == RayRequest::Kind::None ? 1 : 0;
      const RayRequest request = stepper->request(path.state.data(), ray);
      if (request.kind == RayRequest::Kind::None) continue;
      ++alive;
      ShadingPoint point;
      const bool met = world->intersect(request.ray, point.hit);
      if (request.kind == RayRequest::Kind::Any) point = {};
      scene.sampler->start(i, 0, 3, 1);
      scene.sampler->go_to(path.dimension);
      stepper->answer(path.state.data(), ray, met, point, {scene, *scene.sampler, in_turn, nullptr});
      path.dimension = scene.sampler->dimension();
    }
  }
  for (int i = 0; i < count; ++i)
    EXPECT_EQ(stepper->result(paths[std::size_t(i)].state.data()), expected[std::size_t(i)]);
  EXPECT_EQ(in_turn.bounce, at_once.bounce);
  EXPECT_EQ(in_turn.shadow, at_once.shadow);
  EXPECT_EQ(in_turn.escaped, at_once.escaped);
  EXPECT_GT(at_once.bounce, std::uint64_t(count));
}

TEST_F(Transport, EmptySceneShowsItsEnvironment) {
  scene.lights.push_back(make<Light>(register_constant, R"({ "color": [1, 2, 3] })"));
  EXPECT_EQ(radiance({0, 0, 0}, {1, 1, 1}, 4), (Spectrum{1, 2, 3}));
}

TEST_F(Transport, AmbientOcclusionUnderARoof) {
  add_floor(0);
  scene.integrator = make<Integrator>(register_ambient_occlusion);
  EXPECT_EQ(radiance({0, 1, 0}, {0, -1, 0.1f}, 64).x, 1);
  add_ball({0, 2, 0}, 1);  // fills (r/d)^2 of the cosine-weighted view
  EXPECT_NEAR(radiance({0, 0.5f, 0}, {0, -1, 0}).x, 0.75, 0.01);
  scene.integrator = make<Integrator>(register_ambient_occlusion, R"({ "distance": 0.5 })");
  EXPECT_EQ(radiance({0, 0.5f, 0}, {0, -1, 0}, 64).x, 1);
}

TEST_F(Transport, NormalsAsColours) {
  add_floor(0);
  scene.integrator = make<Integrator>(register_normals);
  EXPECT_EQ(radiance({0, 1, 0}, {0, -1, 0.1f}, 1), (Spectrum{0.5f, 1, 0.5f}));
  EXPECT_EQ(radiance({0, -1, 0}, {0, 1, 0.1f}, 1), (Spectrum{0.25f, 0.5f, 0.25f}));
}

TEST(RayOrigin, NextFloatIsThatOfTheStandardLibrary) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float x : {0.f, 1.f, 1.5f, 0x1p-149f, 0x1p-126f, 0x1.fffffep-127f, 0x1.fffffep5f, 3e38f})
    for (const float sign : {1.f, -1.f}) {
      EXPECT_EQ(next_float(x * sign, 0.1f), std::nextafter(x * sign, infinity)) << x * sign;
      EXPECT_EQ(next_float(x * sign, -0.1f), std::nextafter(x * sign, -infinity)) << x * sign;
    }
}

TEST(RayOrigin, LiesBeyondTheErrorOnTheSideOfTheRay) {
  SurfaceHit hit;
  hit.position = {100, 200, -300};
  hit.position_error = {1e-4f, 2e-4f, 3e-4f};
  hit.geometric_normal = normalize(Vec3f{1, -2, 0.5f});
  for (float side : {1.f, -1.f}) {
    const Vec3f d = hit.geometric_normal * side;
    const Vec3f moved = ray_origin(hit, d) - hit.position;
    EXPECT_GE(dot(moved, d), dot(abs(hit.geometric_normal), hit.position_error) * 0.9f);
    EXPECT_LT(length(moved), 1e-3f);
  }
}

}  // namespace
}  // namespace meristem
