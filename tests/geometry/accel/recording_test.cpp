// What a world records of itself against what it counts anyway.
#include "geometry/accel/world.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

struct Traced {
  std::vector<float> distances;
  ExpansionStatistics statistics;
  std::optional<ExpansionProfile> profile;
};

// Rays from all sides; small cells and a small budget, so that many are expanded again.
Traced trace(bool record) {
  Placement object;
  object.part = std::make_shared<const Part>(bumpy_model(shapes::prism(8), 5, 0.1, {64, 64}));
  const auto world = make_world({object}, {.budget_bytes = std::size_t(400) << 10, .record = record});
  Traced result;
  for (int i = 0; i < 130; ++i) {
    const double a = i * 2.4, z = (i % 50) / 25.0 - 1;
    const Vec3f from{float(6 * std::cos(a)), float(1 + 3 * z), float(6 * std::sin(a))};
    SurfaceHit hit;
    result.distances.push_back(world->intersect({from, normalize(Vec3f{0, 1, 0} - from)}, hit) ? hit.t : -1);
  }
  result.statistics = world->statistics();
  result.profile = world->profile();
  return result;
}

TEST(Recording, IsOnlyDoneWhenAskedForAndChangesNothing) {
  const Traced plain = trace(false), recorded = trace(true);
  EXPECT_FALSE(plain.profile);
  ASSERT_TRUE(recorded.profile);
  EXPECT_EQ(recorded.distances, plain.distances);
  EXPECT_EQ(recorded.statistics.cells_expanded, plain.statistics.cells_expanded);
}

TEST(Recording, AgreesWithTheStatistics) {
  const Traced traced = trace(true);
  const ExpansionProfile& p = *traced.profile;
  CellClassFigures all;
  for (const CellClassFigures& c : p.classes) {
    if (c.expanded == 0) continue;
    all.expanded += c.expanded;
    all.evicted += c.evicted;
    all.faces += c.faces;
    EXPECT_EQ(c.cells.model, "bumpy");
    if (!c.cells.final) continue;
    EXPECT_GE(c.mean_box_ratio(), 1);  // a box holds what comes of it
    EXPECT_GE(c.box_ratio_max, c.mean_box_ratio());
  }
  EXPECT_EQ(all.expanded, traced.statistics.cells_expanded);
  EXPECT_EQ(all.evicted, traced.statistics.evicted);
  EXPECT_EQ(all.faces, traced.statistics.faces);
  EXPECT_GE(p.reuse.reexpanded, double(traced.statistics.reexpanded));  // it also knows cells whose parents went
  ASSERT_FALSE(p.reuse.by_budget.empty());
  EXPECT_EQ(p.reuse.by_budget.back().reexpanded, 0);
  std::uint64_t peak = 0;
  for (const TimelineBin& bin : p.timeline) peak = std::max(peak, bin.memory.resident());
  EXPECT_GE(peak, traced.statistics.resident_bytes_peak);
  EXPECT_GT(p.timeline.back().memory.plans, 0u);
}

TEST(Recording, CountsVisitsOfSampledRays) {
  const Traced traced = trace(true);
  std::uint64_t visits = 0;
  for (const CellClassFigures& c : traced.profile->classes) visits += c.visits;
  EXPECT_GT(visits, 130u);
  EXPECT_LT(visits, 130u * 1000);
}

}  // namespace
}  // namespace meristem
