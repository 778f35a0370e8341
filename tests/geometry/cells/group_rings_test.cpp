#include "geometry/cells/group_rings.h"

#include "geometry/mesh/refine.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace meristem {
namespace {

constexpr double rounding = 1e-6;

Mesh refined(const Mesh& mesh, std::vector<std::uint32_t>& group_of) {
  const auto plan = make_refine_plan(mesh, mesh.face_count(), 0, {});
  std::vector<std::uint32_t> groups;
  for (const std::uint32_t parent : plan->face_parents) groups.push_back(group_of[parent]);
  group_of = groups;
  return refine(mesh, *plan, Quantum::for_reach(100), 1).mesh;
}

// Of all faces that share a vertex with one of the group.
Bounds3d ring_box(const Mesh& mesh, const std::vector<std::uint32_t>& group_of, std::uint32_t group) {
  std::vector<bool> is_near(mesh.vertex_count(), false);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    for (const std::uint32_t v : mesh.corners(f)) is_near[v] = is_near[v] || group_of[f] == group;
  Bounds3d box;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.corners(f);
    if (std::ranges::none_of(corners, [&](std::uint32_t v) { return is_near[v]; })) continue;
    for (const std::uint32_t v : corners) box.extend(mesh.positions[v]);
  }
  return box;
}

// Every face a group of its own: its box before and after a refinement holds what lies around it there.
void expect_boxes_to_hold(const Mesh& mesh, const char* name) {
  std::vector<std::uint32_t> group_of(mesh.face_count());
  std::iota(group_of.begin(), group_of.end(), 0u);
  const GroupRings rings = rings_of_groups(mesh, group_of, group_of.size());
  std::vector<std::uint32_t> groups_after = group_of;
  const Mesh after = refined(mesh, groups_after);
  for (std::uint32_t g = 0; g < mesh.face_count(); ++g) {
    EXPECT_TRUE(rings.ring1[g].box.inflated(Vec3d(rounding)).contains(ring_box(mesh, group_of, g))) << name << g;
    EXPECT_TRUE(rings.ring1[g].refined_box.inflated(Vec3d(rounding)).contains(ring_box(after, groups_after, g)))
        << name << g;
    EXPECT_TRUE(rings.ring1[g].box.contains(rings.ring1[g].refined_box)) << name << g;
  }
}

TEST(GroupRings, BoxesHoldWhatLiesAroundBeforeAndAfterARefinement) {
  expect_boxes_to_hold(shapes::bumpy_grid(6), "grid ");
  expect_boxes_to_hold(shapes::cube(), "cube ");
  expect_boxes_to_hold(shapes::prism(5), "prism ");
  std::vector<std::uint32_t> groups(6, 0);
  Mesh mesh = refined(shapes::cube(), groups);  // vertices with three faces among others with four
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.positions[i] *= 1 + 0.4 * double(i * 7 % 5);
  expect_boxes_to_hold(mesh, "rough cube ");
  Mesh creased = shapes::bumpy_grid(6);
  creased.vertex_sharpness.assign(creased.vertex_count(), 0);
  creased.vertex_sharpness[24] = 3;
  expect_boxes_to_hold(creased, "crease ");
}

TEST(GroupRings, ARingIsHalfAsWideAfterARefinement) {
  const Mesh grid = shapes::bumpy_grid(6);
  std::vector<std::uint32_t> group_of(grid.face_count());
  std::iota(group_of.begin(), group_of.end(), 0u);
  const Ring1 middle = rings_of_groups(grid, group_of, group_of.size()).ring1[14];
  EXPECT_NEAR(middle.refined_box.size().x / middle.box.size().x, 2.0 / 3, 0.05);
}

}  // namespace
}  // namespace meristem
