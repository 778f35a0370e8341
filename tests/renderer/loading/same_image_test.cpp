// One scene, many ways to render it, one image.
#include "renderer/loading/load_scene.h"
#include "renderer/report/statistics.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"
#include "tests/renderer/loading/branch_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>

namespace meristem {
namespace {

struct Rendered {
  Image image;
  std::string sha256;
  ExpansionStatistics expansion;
  std::optional<QueueStatistics> queues;
};

class SameImage : public testing::Test {
 protected:
  SameImage() { write(branch_scene()); }
  void write(const std::string& text) const { std::ofstream(scene_) << text; }

  Rendered render(ExpandMode mode, int threads, std::uint64_t budget_bytes,
                  RayOrder order = RayOrder::DepthFirst) const {
    LoadOptions options;
    options.ray_order = order;
    options.expand = mode;
    options.threads = threads;
    options.budget_bytes = budget_bytes;
    const LoadedScene loaded = load_scene(scene_, options);
    RenderSession session(*loaded.scene, {.threads = threads});
    const SessionResult result = session.render();
    Image image = session.film().develop();
    const std::string digest = image_sha256(image);
    return {std::move(image), digest, loaded.scene->intersector->statistics(), result.queues};
  }

  static void expect_few_differences(const Rendered& lazy, const Rendered& flat) {
    ASSERT_EQ(lazy.image.pixels.size(), flat.image.pixels.size());
    int different = 0;
    for (std::size_t i = 0; i < lazy.image.pixels.size(); i += std::size_t(lazy.image.channels))
      different +=
          !std::equal(&lazy.image.pixels[i], &lazy.image.pixels[i] + lazy.image.channels, &flat.image.pixels[i]);
    EXPECT_LE(different, 3);
  }

  // As the error says that one gets with less.
  std::uint64_t least_that_works(int threads) const {
    LoadOptions options;
    options.threads = threads;
    options.budget_bytes = 1;
    try {
      load_scene(scene_, options);
    } catch (const SceneErrors& errors) {
      const std::string message = errors.list().front().message;
      std::smatch found;
      EXPECT_TRUE(std::regex_search(message, found, std::regex("at least --budget ([0-9]+)M"))) << message;
      return std::stoull(found[1]) << 20;
    }
    ADD_FAILURE() << "a budget of one byte was accepted";
    return no_limit;
  }

  static constexpr std::uint64_t no_limit = std::uint64_t(1) << 40;
  ScratchFolder folder_;
  const std::string scene_ = folder_ / "branch.jsonc";
};

TEST_F(SameImage, LazyAndEagerForAnyThreadsAndBudget) {
  const Rendered eager = render(ExpandMode::Eager, 2, no_limit);
  EXPECT_TRUE(eager.expansion.defects.empty());
  EXPECT_EQ(eager.expansion.evicted, 0u);
  const std::uint64_t touched_bytes = render(ExpandMode::Lazy, 1, no_limit).expansion.resident_bytes_peak;
  for (int threads : {1, 2, 8}) {
    const std::uint64_t least = least_that_works(threads);
    for (std::uint64_t budget : {least, std::max(least, touched_bytes / 4), no_limit}) {
      const Rendered lazy = render(ExpandMode::Lazy, threads, budget);
      EXPECT_EQ(lazy.sha256, eager.sha256) << threads << " threads, " << budget << " bytes";
      EXPECT_TRUE(lazy.expansion.defects.empty());
      EXPECT_TRUE(lazy.expansion.evicted > 0 || budget >= touched_bytes);
      EXPECT_TRUE(lazy.expansion.evicted == 0 || budget < no_limit);
    }
  }
}

// Growth, instances in instances, light through leaves, glass; queued at budgets at which every cell is expanded again
// and again.
TEST_F(SameImage, DepthFirstAndQueuedForAnyThreadsAndBudget) {
  write(R"json({ "format": 1, "models": {
      "branch": )json" +
        branch_text() + R"json(,
      "veil": { "base": { "type": "plane", "width": 3, "depth": 3 }, "material": "veil",
                "steps": [ { "subdivide": 4, "place": "0.3*scale*N*snoise(9*P)" } ] },
      "pair": { "group": [ { "model": "branch" },
                           { "model": "branch", "seed": 1, "position": [1, 0, -1], "rotate": [0, 40, 0] },
                           { "model": "veil", "position": [0.4, 2.6, 0], "rotate": [20, 0, 0] } ] } },
    "materials": { "veil": { "base_color": [0.2, 0.5, 0.1], "geometry_opacity": 0.6 } },
    "objects": [ { "model": "pair" }, { "model": "pair", "position": [-1, 0.5, -1], "rotate": [0, 130, 10] } ],
    "lights": [ { "type": "sky", "elevation": 32 } ],
    "camera": { "from": [2, 1.5, 4], "to": [0.3, 1.5, 0], "fov": 46 },
    "render": { "size": [32, 18], "samples": 3, "max_depth": 3, "detail": 0.15,
                "ray_class_detail": { "diffuse": 0.4, "shadow": 0.3 } } })json");
  const Rendered eager = render(ExpandMode::Eager, 2, no_limit);
  const std::uint64_t touched_bytes = render(ExpandMode::Lazy, 1, no_limit).expansion.resident_bytes_peak;
  for (const auto& [threads, wanted] : {std::pair(1, touched_bytes / 2), std::pair(2, touched_bytes / 16),
                                        std::pair(8, touched_bytes / 4), std::pair(8, no_limit)}) {
    const std::uint64_t budget = std::max(wanted, least_that_works(threads));
    const Rendered queued = render(ExpandMode::Lazy, threads, budget, RayOrder::Queued);
    EXPECT_EQ(queued.sha256, eager.sha256) << threads << " threads, " << budget << " bytes";
    EXPECT_TRUE(queued.expansion.defects.empty());
    ASSERT_TRUE(queued.queues);
    // Where nothing is forgotten hardly any ray waits.
    EXPECT_TRUE(budget == no_limit || queued.queues->waits > queued.queues->served);
  }
  // Left to itself, the render goes over to queues where it pays.
  const Rendered small = render(ExpandMode::Lazy, 2, std::max(touched_bytes / 4, least_that_works(2)), RayOrder::Auto),
                 large = render(ExpandMode::Lazy, 2, no_limit, RayOrder::Auto);
  EXPECT_EQ(small.sha256, eager.sha256);
  EXPECT_EQ(large.sha256, eager.sha256);
  EXPECT_TRUE(small.queues);
  EXPECT_FALSE(large.queues);
}

// Mist of two densities that overlap, one of which glows, around what grows, a veil and a lamp: flights, their light
// and what dims it draw random numbers between the rays of a path.
TEST_F(SameImage, MediaForAnyThreadsBudgetAndRayOrder) {
  write(R"json({ "format": 1, "models": {
      "branch": )json" +
        branch_text() + R"json(,
      "veil": { "base": { "type": "plane", "width": 3, "depth": 3 }, "material": "veil",
                "steps": [ { "subdivide": 3 } ] } },
    "materials": { "veil": { "base_color": [0.2, 0.5, 0.1], "geometry_opacity": 0.6 } },
    "objects": [ { "model": "branch" },
                 { "model": "branch", "seed": 1, "position": [1, 0, -1], "rotate": [0, 40, 0] },
                 { "model": "veil", "position": [0.4, 2.6, 0], "rotate": [20, 0, 0] } ],
    "media": [ { "density": "0.25 + 0.2*snoise(2*P)", "albedo": [0.9, 0.95, 1], "anisotropy": 0.5 },
               { "density": "2*smoothstep(length(P - [0.5, 1.5, 0.5]), 0.8, 0.2)", "emission": [0.3, 0.1, 0],
                 "from": [-0.5, 0.5, -0.5], "to": [1.5, 2.5, 1.5] } ],
    "lights": [ { "type": "sky", "elevation": 32 },
                { "type": "sphere", "center": [1.5, 3, 2], "radius": 0.2, "intensity": 20 } ],
    "camera": { "from": [2, 1.5, 4], "to": [0.3, 1.5, 0], "fov": 46 },
    "render": { "size": [24, 14], "samples": 2, "max_depth": 5, "detail": 0.1 } })json");
  const Rendered eager = render(ExpandMode::Eager, 2, no_limit);
  EXPECT_EQ(std::ranges::count_if(eager.image.pixels, [](float x) { return !std::isfinite(x); }), 0);
  for (const int threads : {1, 2, 8}) {
    const std::uint64_t least = least_that_works(threads);
    for (const RayOrder order : {RayOrder::DepthFirst, RayOrder::Queued})
      for (const std::uint64_t budget : {least, no_limit}) {
        const Rendered lazy = render(ExpandMode::Lazy, threads, budget, order);
        EXPECT_EQ(lazy.sha256, eager.sha256) << threads << " threads, " << budget << " bytes, order " << int(order);
        EXPECT_TRUE(lazy.expansion.evicted > 0 || budget == no_limit || threads == 8);  // eight may hold all
        EXPECT_TRUE(lazy.expansion.evicted == 0 || budget == least);
        EXPECT_EQ(lazy.queues.has_value(), order == RayOrder::Queued);
      }
  }
}

// Leaves that stand for others, on a ball whose levels fade in, seen from near and far at once.
TEST_F(SameImage, ThinningAndFadingForAnyThreadsBudgetAndRayOrder) {
  write(R"json({ "format": 1, "models": { "ball": {
      "base": { "type": "sphere", "radius": 0.5, "divisions": 4, "face": "skin" },
      "steps": [ { "subdivide": 1, "place": "0.4*scale*N*snoise(5*P)" },
        { "grow": 1, "thinning": { "skin": 9 }, "rules": { "skin": { "if": "rand() < .3", "template": "extrude",
          "inset": 0.7, "height": 0.01, "faces": { "cap": "leaf" } } } },
        { "grow": 1, "rules": { "leaf": { "template": "leaf", "length": 0.1, "width": 0.05 } } },
        { "subdivide": 2, "place": "0.2*scale*N*snoise(30*P)" } ] } },
    "objects": [ { "model": "ball" }, { "model": "ball", "seed": 1, "position": [2, 1, -3] } ],
    "lights": [ { "type": "sky", "elevation": 32 } ],
    "camera": { "from": [0.5, 0.4, 1.1], "to": [0.4, 0.3, 0], "fov": 70 },
    "render": { "size": [24, 14], "samples": 1, "max_depth": 2, "fade": true } })json");
  const Rendered eager = render(ExpandMode::Eager, 2, no_limit);
  EXPECT_TRUE(eager.expansion.defects.empty());
  for (const auto& [threads, order] : {std::pair(1, RayOrder::DepthFirst), std::pair(8, RayOrder::Queued)})
    for (const std::uint64_t budget : {least_that_works(threads), no_limit}) {
      const Rendered lazy = render(ExpandMode::Lazy, threads, budget, order);
      EXPECT_EQ(lazy.sha256, eager.sha256) << threads << " threads, " << budget << " bytes, order " << int(order);
      EXPECT_TRUE(lazy.expansion.defects.empty());
    }
}

// Branches that grow and bend while the shutter is open, one of them on a turning group, before a camera that moves.
TEST_F(SameImage, MotionForAnyThreadsBudgetAndRayOrder) {
  write(R"json({ "format": 1, "models": {
      "branch": )json" +
        branch_text("scale*N*.42*abs(sin(6*PI*u + .8*snoise(3*P) + 2*time))") + R"json(,
      "pair": { "group": [ { "model": "branch" },
                           { "model": "branch", "seed": 1, "position": [1, 0, -1],
                             "rotate": "[0, 40 + 30*time, 0]" } ] } },
    "objects": [ { "model": "pair", "rotate": [0, "25*time", 0] },
                 { "model": "branch", "position": "[-1, 0.5 - time, -1]" } ],
    "lights": [ { "type": "sky", "elevation": 32 } ],
    "camera": { "from": "[2 + 0.5*time, 1.5, 4]", "to": [0.3, 1.5, 0], "fov": 46 },
    "render": { "size": [24, 14], "samples": 2, "max_depth": 1, "detail": 0.3,
                "ray_class_detail": { "diffuse": 0.4, "shadow": 0.6 }, "shutter": 0.8, "shutter_moments": 2 } })json");
  const Rendered eager = render(ExpandMode::Eager, 2, no_limit);
  EXPECT_TRUE(eager.expansion.defects.empty());
  std::uint64_t evicted = 0;
  for (const int threads : {1, 2, 8})
    for (const RayOrder order : {RayOrder::DepthFirst, RayOrder::Queued})
      for (const std::uint64_t budget : {least_that_works(threads), no_limit}) {
        const Rendered lazy = render(ExpandMode::Lazy, threads, budget, order);
        EXPECT_EQ(lazy.sha256, eager.sha256) << threads << " threads, " << budget << " bytes, order " << int(order);
        EXPECT_TRUE(lazy.expansion.defects.empty());
        evicted += lazy.expansion.evicted;
      }
  EXPECT_GT(evicted, 0u);
  expect_few_differences(eager, render(ExpandMode::Flat, 2, no_limit));
}

TEST_F(SameImage, FlatDiffersInAFewPixelsAtMost) {
  expect_few_differences(render(ExpandMode::Lazy, 2, no_limit), render(ExpandMode::Flat, 2, no_limit));
}

}  // namespace
}  // namespace meristem
