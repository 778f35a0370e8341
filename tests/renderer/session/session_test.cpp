#include "renderer/session/session.h"

#include "renderer/film/film_parts.h"
#include "renderer/film/noise.h"
#include "tests/renderer/image/part_values.h"
#include "tests/renderer/session/fake_scene.h"

#include <gtest/gtest.h>

#include <chrono>
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
      EXPECT_EQ(result.end, RenderEnd::Complete);
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
  EXPECT_EQ(result.end, RenderEnd::Cancelled);
  EXPECT_LE(result.samples, 502u);
  EXPECT_EQ(session.film().pixels_without_samples(), 0u);
  for (float value : session.film().develop().pixels) EXPECT_TRUE(value == 0.75f || value == 1.0f);
}

TEST(RenderSession, CancelledBeforeItBeginsItTakesNothing) {
  const std::atomic<bool> cancel{true};
  const auto scene = fake_scene(4, 4, 4, noisy_light);
  RenderSession session(*scene, {.threads = 2, .cancel = &cancel});
  const SessionResult result = session.render();
  EXPECT_EQ(result.end, RenderEnd::Cancelled);
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

std::unique_ptr<Scene> scene_with_surfaces(int samples) {
  auto scene = fake_scene(23, 17, samples, noisy_light);
  dynamic_cast<FunctionIntegrator&>(*scene->integrator).first_surface = [](const Ray& ray, FirstSurface& first) {
    first.hit.t = 1;
    first.hit.position = {ray.origin.x, ray.origin.y, 5 + ray.origin.x};
    first.hit.shading_normal = {0, 0, -1};
    first.hit.object = int(ray.origin.y) % 3;
    first.albedo = {ray.origin.x / 30, 0.5f, 0};
    first.material = 0;
  };
  scene->names = {{"a", "b", "c"}, {"default"}, {}};
  scene->settings.aovs = parse_aovs("albedo,normal,Z,P,uv,id.object,samples,variance,crypto_object");
  return scene;
}

void expect_same_bits(const Film& a, const Film& b, const SceneNames& names) {
  const auto x = film_parts(a, names, false), y = film_parts(b, names, false);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_TRUE(values_of(x[i]) == values_of(y[i])) << x[i].name;
}

// Interrupts a render after so many samples, and returns its film.
std::pair<Film, AdaptiveState> interrupted_film(const Scene& scene, std::uint64_t after) {
  std::atomic<bool> cancel{false};
  SessionOptions options{.threads = 2, .cancel = &cancel};
  auto& integrator = dynamic_cast<FunctionIntegrator&>(*scene.integrator);
  std::atomic<std::uint64_t> taken{0};
  const auto before = integrator.first_surface;
  integrator.first_surface = [&](const Ray& ray, FirstSurface& first) {
    if (++taken >= after) cancel = true;
    before(ray, first);
  };
  RenderSession session(scene, options);
  EXPECT_EQ(session.render().end, RenderEnd::Cancelled);
  integrator.first_surface = before;
  return {session.film(), session.adaptive()};
}

TEST(RenderSession, GoingOnGivesTheBitsOfAnUnbrokenRender) {
  for (const double noise : {0.0, 0.4}) {
    const auto scene = scene_with_surfaces(70);
    scene->settings.noise = noise;
    RenderSession whole(*scene, {.threads = 2});
    whole.render();
    for (const std::uint64_t after : {3u, 391u, 400u, 5000u}) {
      auto [film, adaptive] = interrupted_film(*scene, after);
      RenderSession rest(*scene, {.threads = 3, .tile_side = 5});
      rest.resume(std::move(film), std::move(adaptive));
      EXPECT_EQ(rest.render().end, RenderEnd::Complete);
      expect_same_bits(rest.film(), whole.film(), scene->names);
      EXPECT_EQ(rest.film().total_samples(), whole.film().total_samples());
    }
  }
}

TEST(RenderSession, MoreSamplesGoOnFromACompleteFilm) {
  for (const double noise : {0.0, 0.4}) {
    const auto few = scene_with_surfaces(32), many = scene_with_surfaces(100);
    few->settings.noise = many->settings.noise = noise;
    RenderSession first(*few, {.threads = 2}), second(*many, {.threads = 2}), whole(*many, {.threads = 2});
    first.render();
    second.resume(first.film(), first.adaptive());
    second.render();
    whole.render();
    expect_same_bits(second.film(), whole.film(), few->names);
  }
}

TEST(RenderSession, RangesOfSamplesAddUpToTheWhole) {
  const auto scene = scene_with_surfaces(50);
  RenderSession whole(*scene, {.threads = 2});
  whole.render();
  Film sum({0, 0, 23, 17}, 1, scene->settings.aovs);
  for (const auto& [first, count] : {std::pair{30u, 20}, {0u, 7}, {7u, 23}}) {
    scene->settings.samples = count;
    RenderSession part(*scene, {.threads = 2, .first_sample = first});
    part.render();
    sum.merge(part.film());
  }
  expect_same_bits(sum, whole.film(), scene->names);
}

TEST(RenderSession, SnapshotsSeeTheFilmAtRestAndChangeNothing) {
  const auto scene = scene_with_surfaces(64);
  RenderSession whole(*scene, {.threads = 2});
  whole.render();
  int snapshots = 0;
  std::uint64_t seen = 0;
  SessionOptions options{.threads = 2};
  RenderSession* session = nullptr;
  options.snapshot_due = [] { return true; };
  options.snapshot = [&] {
    ++snapshots;
    const std::uint64_t samples = session->film().total_samples();
    EXPECT_GE(samples, seen);
    EXPECT_EQ(session->film().total_samples(), samples);
    seen = samples;
  };
  // Slow enough for several reports of progress
  auto& surface = dynamic_cast<FunctionIntegrator&>(*scene->integrator).first_surface;
  surface = [fill = surface](const Ray& ray, FirstSurface& first) {
    std::this_thread::sleep_for(std::chrono::microseconds(20));
    fill(ray, first);
  };
  RenderSession observed(*scene, options);
  session = &observed;
  EXPECT_EQ(observed.render().end, RenderEnd::Complete);
  EXPECT_GT(snapshots, 0);
  expect_same_bits(observed.film(), whole.film(), scene->names);
}

// What has settled is in the way soon after: the pass stops, lets go, and goes on.
TEST(RenderSession, ACrowdedWorldSettlesAnewAndNothingIsLost) {
  class CrowdedWorld final : public EmptyWorld {
   public:
    explicit CrowdedWorld(int& settled) : settled_(settled) {}
    void settle() override { ++settled_; }
    bool is_crowded() const override { return settled_ == 1; }

   private:
    int& settled_;
  };
  const auto slow = [](const Ray& ray, Sampler& sampler, RayCounts& counts) {
    std::this_thread::sleep_for(std::chrono::microseconds(400));
    return noisy_light(ray, sampler, counts);
  };
  const auto scene = fake_scene(40, 30, 1, slow), plain = fake_scene(40, 30, 1, noisy_light);
  int settled = 0;
  scene->intersector = std::make_unique<CrowdedWorld>(settled);
  RenderSession session(*scene, {.threads = 2}), whole(*plain, {.threads = 2});
  EXPECT_EQ(session.render().end, RenderEnd::Complete);
  whole.render();
  EXPECT_EQ(settled, 2) << "in a single pass";
  EXPECT_EQ(session.film().total_samples(), 40u * 30);
  EXPECT_EQ(session.film().develop().pixels, whole.film().develop().pixels);
}

// Few pixels expand most of what there is; that settles before the others are traced. What has settled needs none.
TEST(RenderSession, FewPixelsComeFirstWhereNothingHasSettled) {
  class SettlingWorld final : public EmptyWorld {
   public:
    SettlingWorld(bool is_full, std::function<void()> on_settle)
        : is_full_(is_full), on_settle_(std::move(on_settle)) {}
    void settle() override { on_settle_(); }
    bool is_settled() const override { return is_full_; }

   private:
    bool is_full_;
    std::function<void()> on_settle_;
  };
  for (const bool is_full : {false, true}) {
    std::atomic<int> taken = 0;
    std::vector<int> taken_before;
    const auto scene = fake_scene(40, 30, 4, [&](const Ray& ray, Sampler& sampler, RayCounts& counts) {
      ++taken;
      return noisy_light(ray, sampler, counts);
    });
    scene->intersector = std::make_unique<SettlingWorld>(is_full, [&] { taken_before.push_back(taken); });
    RenderSession(*scene, {.threads = 2}).render();
    const int all = 40 * 30, few = 10 * 8;
    EXPECT_EQ(taken, 4 * all);
    EXPECT_EQ(taken_before, is_full ? (std::vector{0, all}) : (std::vector{0, few, all}));
  }
}

// A path of one ray to the camera's, which its state is.
class OneRay final : public FunctionIntegrator, public PathStepper {
 public:
  OneRay() : FunctionIntegrator(is_not_asked) {}
  const PathStepper* stepper() const override { return this; }
  std::size_t state_bytes() const override { return sizeof(State); }
  void begin(void* state, const Ray& ray, const PathTools&) const override {
    *static_cast<State*>(state) = {ray, true};
  }
  RayRequest request(const void* state, int ray) const override {
    const State& s = *static_cast<const State*>(state);
    return {ray == 1 && s.waits ? RayRequest::Kind::Nearest : RayRequest::Kind::None, s.ray};
  }
  void answer(void* state, int, bool, ShadingPoint&, const PathTools&) const override {
    static_cast<State*>(state)->waits = false;
  }
  Spectrum result(const void*) const override { return Spectrum(1); }

 private:
  static Spectrum is_not_asked(const Ray&, Sampler&, RayCounts&) {
    ADD_FAILURE() << "a path is followed alone";
    return {};
  }
  struct State {
    Ray ray;
    bool waits;
  };
};

// Has settled; each ray through one pixel expands a cell.
class ExpandingWorld final : public EmptyWorld {
 public:
  static constexpr int x = 3, y = 2;
  static constexpr std::uint64_t nanoseconds = 200'000;  // an expansion, at least
  bool intersect(const Ray& ray, SurfaceHit&) const override {
    if (int(ray.origin.x) != x || int(ray.origin.y) != y) return false;
    std::this_thread::sleep_for(std::chrono::nanoseconds(nanoseconds));
    ++mine.expanded, mine.nanoseconds += nanoseconds;
    return false;
  }
  bool is_settled() const override { return true; }
  ThreadExpansions thread_expansions() const override { return mine; }

 private:
  static inline thread_local ThreadExpansions mine;
};

TEST(RenderSession, PathsFollowedTogetherCostWhatEachExpands) {
  constexpr int width = 9, height = 5, samples = 16;
  const auto scene = fake_scene(width, height, samples, {});
  scene->integrator = std::make_unique<OneRay>();
  scene->intersector = std::make_unique<ExpandingWorld>();
  scene->settings.aovs = {Aov::CostTime, Aov::CostExpand};
  RenderSession session(*scene, {.threads = 2});
  session.render();
  const Image time = session.film().develop(Aov::CostTime), expanded = session.film().develop(Aov::CostExpand);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool expands = x == ExpandingWorld::x && y == ExpandingWorld::y;
      const auto pixel = std::size_t(y * width + x);
      EXPECT_EQ(expanded.pixels[pixel], expands ? samples : 0);
      EXPECT_GT(time.pixels[pixel], expands ? 0.999e-9f * samples * float(ExpandingWorld::nanoseconds) : 0);
    }
}

TEST(RenderSession, TheTimeLimitEndsIt) {
  const auto scene = fake_scene(20, 20, 1 << 20, [](const Ray&, Sampler&, RayCounts&) { return Spectrum(1); });
  RenderSession session(*scene, {.threads = 2, .time_limit_s = 0.2});
  const SessionResult result = session.render();
  EXPECT_EQ(result.end, RenderEnd::TimeLimit);
  EXPECT_GT(result.samples, 0u);
  EXPECT_EQ(session.film().pixels_without_samples(), 0u);
}

TEST(RenderSession, QuietPixelsTakeFewerSamples) {
  // Noise to the left, a constant to the right
  const auto scene = fake_scene(40, 20, 256, [](const Ray& ray, Sampler& sampler, RayCounts&) {
    return Spectrum(ray.origin.x < 20 ? 4 * sampler.next_1d() : 1.f);
  });
  scene->settings.noise = 0.06;
  RenderSession session(*scene, {.threads = 2});
  EXPECT_EQ(session.render().end, RenderEnd::Complete);
  EXPECT_EQ(session.film().samples(35, 10), noise::first_decision);
  // Variance 4/3, mean 2: (4/3 / 2) / 0.06^2 = 185
  EXPECT_EQ(session.film().samples(5, 10), 256u);
  EXPECT_EQ(session.film().aovs(), std::vector{Aov::Variance});
}

TEST(RenderSession, AovsAreThoseOfTheFirstSurface) {
  const auto scene = scene_with_surfaces(16);
  RenderSession session(*scene, {.threads = 2});
  session.render();
  const Image z = session.film().develop(Aov::Z), normal = session.film().develop(Aov::Normal);
  for (int x = 0; x < 23; ++x) {
    const float depth = z.pixels[std::size_t(x)];
    EXPECT_GE(depth, 5 + float(x));  // the nearest of 16 samples between 5 + x and 6 + x
    EXPECT_LT(depth, 5.5f + float(x));
    EXPECT_EQ(normal.pixels[std::size_t(3 * x) + 2], -1);
  }
}

}  // namespace
}  // namespace meristem
