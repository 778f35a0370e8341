#include "renderer/session/probe.h"

#include "renderer/loading/load_scene.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"
#include "tests/renderer/loading/branch_scene.h"
#include "tests/renderer/session/fake_scene.h"

#include <gtest/gtest.h>

#include <fstream>

namespace meristem {
namespace {

LoadedScene branch(const ScratchFolder& folder, int samples) {
  std::ofstream(folder / "branch.jsonc") << branch_scene();
  LoadOptions options;
  options.samples = samples;
  options.threads = 1;
  return load_scene(folder / "branch.jsonc", options);
}

constexpr int x = 31, y = 20, samples = 4;

TEST(Probe, HasTheLightOfARender) {
  const ScratchFolder folder;
  const LoadedScene probed = branch(folder, samples), rendered = branch(folder, samples);
  RenderSession session(*rendered.scene, {.threads = 1, .crop = PixelWindow{x, y, x + 1, y + 1}});
  session.render();
  Spectrum sum;
  for (const ProbedSample& sample : probe_pixel(*probed.scene, x, y, samples)) sum += sample.radiance;
  const Image image = session.film().develop();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / samples, image.pixels[std::size_t(c)], 1e-5f);
}

TEST(Probe, TellsWhatEachRayMetAndExpanded) {
  const ScratchFolder folder;
  const LoadedScene loaded = branch(folder, samples);
  const std::vector<ProbedSample> probed = probe_pixel(*loaded.scene, x, y, samples);
  ASSERT_EQ(probed.size(), std::size_t(samples));
  ASSERT_TRUE(probed[0].first.hit.valid());
  const ProbedRay& camera = probed[0].rays[0];
  EXPECT_TRUE(camera.met && !camera.is_light);
  EXPECT_EQ(camera.hit.position, probed[0].first.hit.position);
  EXPECT_NEAR(probed[0].depth, camera.hit.t, 0.1f);
  EXPECT_GT(camera.expansions.expanded, 0u) << "nothing was there before";
  std::uint64_t expanded = 0, lights = 0;
  double seconds = 0;
  for (const ProbedSample& sample : probed)
    for (const ProbedRay& ray : sample.rays) {
      expanded += ray.expansions.expanded;
      lights += ray.is_light;
      seconds += ray.seconds;
      EXPECT_FALSE(ray.any && ray.hit.valid());
    }
  EXPECT_EQ(expanded, loaded.scene->intersector->statistics().cells_expanded);
  EXPECT_GT(lights, 0u);
  EXPECT_GT(seconds, 0);
  // All that this pixel needs is there now
  for (const ProbedSample& sample : probe_pixel(*loaded.scene, x, y, samples))
    for (const ProbedRay& ray : sample.rays) EXPECT_EQ(ray.expansions.expanded, 0u);
}

TEST(Probe, OfPathsThatCannotBeStoppedTheCameraRayIsTold) {
  const auto scene = fake_scene(4, 4, 1, [](const Ray& ray, Sampler&, RayCounts&) { return Spectrum(ray.origin.x); });
  const std::vector<ProbedSample> probed = probe_pixel(*scene, 2, 1, 1);
  ASSERT_EQ(probed[0].rays.size(), 1u);
  EXPECT_FALSE(probed[0].rays[0].met);
  EXPECT_EQ(probed[0].radiance.x, probed[0].rays[0].ray.origin.x);
}

}  // namespace
}  // namespace meristem
