// One scene, many ways to render it, one image.
#include "renderer/loading/load_scene.h"
#include "renderer/report/statistics.h"
#include "renderer/session/session.h"
#include "tests/renderer/image/scratch_folder.h"
#include "tests/renderer/loading/branch_scene.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>

namespace meristem {
namespace {

struct Rendered {
  Image image;
  std::string sha256;
  ExpansionStatistics expansion;
};

class SameImage : public testing::Test {
 protected:
  SameImage() { std::ofstream(scene_) << branch_scene(); }

  Rendered render(ExpandMode mode, int threads, std::uint64_t budget_bytes) const {
    LoadOptions options;
    options.expand = mode;
    options.threads = threads;
    options.budget_bytes = budget_bytes;
    const LoadedScene loaded = load_scene(scene_, options);
    RenderSession session(*loaded.scene, {.threads = threads});
    session.render();
    Image image = session.film().develop();
    const std::string digest = image_sha256(image);
    return {std::move(image), digest, loaded.scene->intersector->statistics()};
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

TEST_F(SameImage, FlatDiffersInAFewPixelsAtMost) {
  const Rendered lazy = render(ExpandMode::Lazy, 2, no_limit), flat = render(ExpandMode::Flat, 2, no_limit);
  ASSERT_EQ(lazy.image.pixels.size(), flat.image.pixels.size());
  int different = 0;
  for (std::size_t i = 0; i < lazy.image.pixels.size(); i += std::size_t(lazy.image.channels))
    different += !std::equal(&lazy.image.pixels[i], &lazy.image.pixels[i] + lazy.image.channels, &flat.image.pixels[i]);
  EXPECT_LE(different, 3);
}

}  // namespace
}  // namespace meristem
