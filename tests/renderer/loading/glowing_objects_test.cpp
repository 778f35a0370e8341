// Objects that glow light their surroundings as a lamp of the same shape does, whether they are asked or met by chance.
#include "renderer/loading/load_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

namespace meristem {
namespace {

// A glowing square of 1 m, 2 m above a floor with albedo 0.5, cut into cells x cells faces.
LoadedScene lamp_over_floor(int cells, const std::string& luminance) {
  const std::string path = testing::TempDir() + fmt::format("glow_{}.jsonc", ::getpid());
  std::ofstream(path) << fmt::format(R"({{
    "materials": {{ "floor": {{ "base_color": 0.5, "specular_weight": 0 }},
                    "lamp": {{ "base_color": 0, "specular_weight": 0, "emission_luminance": {} }} }},
    "models": {{
      "floor": {{ "base": {{ "type": "plane", "width": 40, "depth": 40 }}, "material": "floor" }},
      "lamp": {{ "base": {{ "type": "plane", "width": 1, "depth": 1, "columns": {}, "rows": {} }},
                 "material": "lamp" }} }},
    "objects": [ {{ "model": "floor" }}, {{ "model": "lamp", "position": [0, 2, 0], "rotate": [180, 30, 0] }} ],
    "camera": {{ "from": [0, 1, 3], "to": [0, 0, 0] }}, "render": {{ "max_depth": 1 }} }})",
                                     luminance, cells, cells);
  LoadedScene loaded = load_scene(path, {});
  std::remove(path.c_str());
  return loaded;
}

struct Mean {
  double value = 0, variance = 0;
};

Mean radiance_of_floor(const Scene& scene, int samples) {
  Ray ray;
  ray.origin = {3, 1, 0};
  ray.direction = normalize(Vec3f{-3, -1, 0});
  Mean mean;
  RayCounts counts;
  for (int i = 0; i < samples; ++i) {
    scene.sampler->start(0, 0, i, 7);
    const double value = double(scene.integrator->radiance(ray, scene, *scene.sampler, counts, nullptr).x);
    mean.value += value / samples;
    mean.variance += value * value / samples;
  }
  mean.variance -= mean.value * mean.value;
  return mean;
}

// What a floor gets from a parallel square of side 1 right above, at distance 2: four times the form factor of a corner
// (Howell, configuration B-4).
double square_over_floor(double luminance) {
  const double a = 0.5, d = 2, r = std::hypot(a, d);
  return 0.5 * luminance * 4 / (2 * pi) * 2 * (a / r * std::atan(a / r));
}

TEST(GlowingObjects, FewFacesAreAskedAndGiveTheLightOfTheirShape) {
  for (const int cells : {1, 6}) {
    const LoadedScene loaded = lamp_over_floor(cells, "10");
    EXPECT_EQ(loaded.scene->lights.size(), std::size_t(2 * cells * cells));
    const Mean mean = radiance_of_floor(*loaded.scene, 4096);
    EXPECT_NEAR(mean.value, square_over_floor(10), 0.004 * square_over_floor(10)) << cells;
    EXPECT_LT(std::sqrt(mean.variance), 0.5 * mean.value);  // met by chance it would be 8 times the mean
  }
}

TEST(GlowingObjects, ManyFacesAreMetByChance) {
  const LoadedScene loaded = lamp_over_floor(70, "10");
  EXPECT_TRUE(loaded.scene->lights.empty());
  const Mean mean = radiance_of_floor(*loaded.scene, 60000);
  EXPECT_NEAR(mean.value, square_over_floor(10), 0.1 * square_over_floor(10));
}

// Half of the square, by an expression over u, gives half of the light to a point on its plane of symmetry.
TEST(GlowingObjects, EmissionMayVaryOverTheFace) {
  const LoadedScene loaded = lamp_over_floor(1, "\"u < 0.5 ? 10 : 0\"");
  EXPECT_NEAR(radiance_of_floor(*loaded.scene, 8192).value, square_over_floor(10) / 2, 0.02 * square_over_floor(10));
}

TEST(GlowingObjects, AreSeenAsTheyGlow) {
  const LoadedScene loaded = lamp_over_floor(2, "10");
  Ray ray;
  ray.origin = {0.2f, 1, 0.1f};
  ray.direction = {0, 1, 0};
  RayCounts counts;
  loaded.scene->sampler->start(0, 0, 0, 0);
  EXPECT_EQ(loaded.scene->integrator->radiance(ray, *loaded.scene, *loaded.scene->sampler, counts, nullptr).x, 10);
}

}  // namespace
}  // namespace meristem
