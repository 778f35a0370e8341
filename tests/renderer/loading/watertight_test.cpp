// No ray passes between the cells of a closed model, in full or where levels of detail meet.
#include "tests/renderer/loading/branch_scene.h"
#include "tests/support/inside_walk.h"
#include "tests/support/point_footprint.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

constexpr CellSettings small_cells{64, 256};
constexpr Vec3f on_the_axis_of_the_trunk{0, 0.25f, 0};

void expect_closed(const std::shared_ptr<const Footprint>& footprint, std::size_t least_borders) {
  constexpr int walks = 100, rays_per_walk = 2500;
  const auto model = model_of(branch_text(), 0, small_cells);
  const Borders borders(*model, footprint.get());
  EXPECT_GT(borders.count(), least_borders);
  const Placement object{std::make_shared<const Part>(model), {}, 0, true};
  const auto world = make_world({object}, {.footprint = footprint}),
             flat = make_world({object}, {.mode = ExpandMode::Flat, .footprint = footprint});
  EscapeCounts counts;
  walk_inside(*world, *flat, borders, on_the_axis_of_the_trunk, walks, rays_per_walk, counts);
  EXPECT_EQ(counts.random_escapes, 0);
  EXPECT_EQ(counts.between_cells, 0);
  EXPECT_EQ(counts.edge_escapes, 0);
  EXPECT_LT(counts.vertex_escapes, counts.at_vertices / 100);
  EXPECT_GT(counts.at_edges, walks * rays_per_walk / 8);
  EXPECT_GT(counts.at_vertices, walks * rays_per_walk / 8);
}

TEST(Watertight, NoRayLeavesAClosedBranch) { expect_closed(nullptr, 5000); }

TEST(Watertight, NorWhereLevelsOfDetailMeet) {
  expect_closed(std::make_shared<PointFootprint>(Vec3d{1, 0.5, 0.5}, 0.02), 1000);
}

TEST(Watertight, NorWhereTheyFadeIn) {
  expect_closed(std::make_shared<PointFootprint>(Vec3d{1, 0.5, 0.5}, 0.02, true), 1000);
}

}  // namespace
}  // namespace meristem
