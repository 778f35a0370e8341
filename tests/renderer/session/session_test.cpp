#include "renderer/session/session.h"

#include "tests/renderer/session/fake_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <thread>

namespace meristem {
namespace {

Spectrum noisy_light(const Ray& ray, Sampler& sampler, RayCounts& counts) {
  const float u = sampler.next_1d();
  ++counts.shadow;
  counts.bounce += u < 0.5f ? 1 : 0;
  return {ray.origin.x * u, 1 / (ray.origin.y + u), u * 1e-3f};
}

TEST(RenderSession, TheImageHasTheSameBitsForAnyThreadsAndTiles) {
  const auto scene = fake_scene(67, 41, 21, noisy_light);
  std::vector<float> expected;
  RayCounts rays;
  for (int threads : {1, 2, 3, 8})
    for (int tile : {1, 8, 16, 100}) {
      RenderSession session(*scene, {.threads = threads, .tile_side = tile});
      const SessionResult result = session.render();
      const std::vector<float> pixels = session.film().develop().pixels;
      if (expected.empty()) expected = pixels, rays = result.rays;
      EXPECT_EQ(pixels, expected) << threads << " threads, tiles of " << tile;
      EXPECT_EQ(result.rays.bounce, rays.bounce);
      EXPECT_EQ(result.rays.camera, 67u * 41 * 21);
      EXPECT_EQ(result.rays.shadow, 67u * 41 * 21);
      EXPECT_EQ(result.samples, 67u * 41 * 21);
      EXPECT_FALSE(result.cancelled);
    }
}

TEST(RenderSession, EverySampleOfEveryPixelIsTakenOnceInItsOrder) {
  for (int samples : {1, 2, 3, 4, 5, 16, 37}) {
    auto scene = fake_scene(5, 3, samples, [](const Ray&, Sampler&, RayCounts&) { return Spectrum(1); });
    RenderSession session(*scene, {.threads = 2, .tile_side = 2});
    session.render();
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 5; ++x) EXPECT_EQ(session.film().samples(x, y), std::uint32_t(samples));
  }
}

TEST(RenderSession, PixelsAreMeansOverTheirOwnArea) {
  const auto scene = fake_scene(
      6, 4, 256, [](const Ray& ray, Sampler&, RayCounts&) { return Spectrum(ray.origin.x, ray.origin.y, 0.25f); });
  RenderSession session(*scene, {.threads = 2});
  session.render();
  const Image image = session.film().develop();
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x) {
      const float* p = &image.pixels[std::size_t(y * 6 + x) * 4];
      const float four_sigma = 4 * std::sqrt(1.0f / 12 / 256);
      EXPECT_NEAR(p[0], float(x) + 0.5f, four_sigma);
      EXPECT_NEAR(p[1], float(y) + 0.5f, four_sigma);
      EXPECT_EQ(p[2], 0.25f);
      EXPECT_EQ(p[3], 1.0f);
    }
}

TEST(RenderSession, CoverageIsTheShareOfCameraRaysThatMeetASurface) {
  const auto scene = fake_scene(2, 1, 4, [](const Ray& ray, Sampler&, RayCounts& counts) {
    counts.escaped += ray.origin.x < 1 ? 1 : 0;
    return Spectrum(0.5f);
  });
  RenderSession session(*scene, {.threads = 1});
  session.render();
  EXPECT_EQ(session.film().develop().pixels, (std::vector<float>{0.5f, 0.5f, 0.5f, 0, 0.5f, 0.5f, 0.5f, 1}));
}

TEST(RenderSession, ACropHasThePixelsOfTheWholeImage) {
  const auto scene = fake_scene(32, 24, 5, noisy_light);
  RenderSession whole(*scene, {.threads = 2}), crop(*scene, {.threads = 2, .crop = PixelWindow{7, 5, 19, 500}});
  whole.render();
  crop.render();
  const Image all = whole.film().develop(), part = crop.film().develop();
  ASSERT_EQ(part.width, 12);
  ASSERT_EQ(part.height, 19);
  for (int y = 0; y < part.height; ++y)
    for (int i = 0; i < part.width * 4; ++i)
      ASSERT_EQ(part.pixels[std::size_t(y * part.width * 4 + i)], all.pixels[std::size_t(((y + 5) * 32 + 7) * 4 + i)]);
}

TEST(RenderSession, CancellingAfterTheFirstPassKeepsAWholeImage) {
  std::atomic<bool> cancel{false};
  std::atomic<int> taken{0};
  const auto scene = fake_scene(20, 20, 64, [&](const Ray&, Sampler&, RayCounts&) {
    if (++taken == 500) cancel = true;
    return Spectrum(0.75f);
  });
  RenderSession session(*scene, {.threads = 2, .cancel = &cancel});
  const SessionResult result = session.render();
  EXPECT_TRUE(result.cancelled);
  EXPECT_LE(result.samples, 502u);
  EXPECT_EQ(session.film().pixels_without_samples(), 0u);
  for (float value : session.film().develop().pixels) EXPECT_TRUE(value == 0.75f || value == 1.0f);
}

TEST(RenderSession, CancelledBeforeItBeginsItTakesNothing) {
  const std::atomic<bool> cancel{true};
  const auto scene = fake_scene(4, 4, 4, noisy_light);
  RenderSession session(*scene, {.threads = 2, .cancel = &cancel});
  const SessionResult result = session.render();
  EXPECT_TRUE(result.cancelled);
  EXPECT_EQ(result.samples, 0u);
  EXPECT_FALSE(result.first_pixel_s);
}

TEST(RenderSession, NonFiniteSamplesAreCountedAndTheImageIsFinite) {
  const auto scene = fake_scene(8, 8, 16, [](const Ray& ray, Sampler& sampler, RayCounts&) {
    return Spectrum(sampler.next_1d() < 0.25f && ray.origin.x < 4 ? std::numeric_limits<float>::quiet_NaN() : 1.0f);
  });
  RenderSession session(*scene, {.threads = 2});
  session.render();
  EXPECT_GT(session.film().nonfinite_samples(), 0u);
  for (float value : session.film().develop().pixels) EXPECT_TRUE(std::isfinite(value));
}

TEST(RenderSession, WhatAnIntegratorThrowsStopsAllThreadsAndArrives) {
  std::atomic<int> taken{0};
  const auto scene = fake_scene(100, 100, 64, [&](const Ray&, Sampler&, RayCounts&) -> Spectrum {
    if (++taken == 50) throw std::runtime_error("broken");
    return Spectrum(1);
  });
  RenderSession session(*scene, {.threads = 4});
  EXPECT_THROW(session.render(), std::runtime_error);
  EXPECT_LT(taken, 100 * 100 * 64);
}

TEST(RenderSession, ProgressEndsAtAllSamplesAndComesFromTheCaller) {
  const auto scene = fake_scene(16, 16, 9, noisy_light);
  RenderProgress last;
  std::set<std::thread::id> callers;
  RenderSession session(*scene, {.threads = 2, .progress = [&](const RenderProgress& p) {
                                   EXPECT_GE(p.samples_done, last.samples_done);
                                   callers.insert(std::this_thread::get_id());
                                   last = p;
                                 }});
  const SessionResult result = session.render();
  EXPECT_EQ(last.samples_done, 16u * 16 * 9);
  EXPECT_EQ(last.samples_total, 16u * 16 * 9);
  EXPECT_EQ(last.pass, last.passes);
  EXPECT_EQ(callers, std::set<std::thread::id>{std::this_thread::get_id()});
  ASSERT_TRUE(result.first_pixel_s);
  EXPECT_GT(*result.first_pixel_s, 0);
}

}  // namespace
}  // namespace meristem
