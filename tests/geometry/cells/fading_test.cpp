// Levels that fade in: what is shown moves no faster than the camera, and is as closed, as bounded and as independent
// of how it is cut as without.
#include "geometry/cells/fading.h"

#include "geometry/cells/expansion.h"
#include "geometry/cells/position_lattice.h"
#include "tests/support/point_footprint.h"
#include "tests/support/shown_triangles.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

const CellSettings small_cells{64, 64};

// Heights of a surface over a few places of the plane below: where vertical lines meet it.
class Profile {
 public:
  Profile(const Model& model, const Footprint& footprint) : heights_(side * side, 0) {
    for_each_shown_triangle(model, root_cell(model, &footprint), 0, [&](Vec3f a, Vec3f b, Vec3f c) { add(a, b, c); });
  }
  // The largest difference, and the root of the mean square.
  std::pair<double, double> difference(const Profile& other) const {
    double most = 0, sum = 0;
    for (std::size_t i = 0; i < heights_.size(); ++i) {
      const double d = std::abs(heights_[i] - other.heights_[i]);
      most = std::max(most, d);
      sum += d * d;
    }
    return {most, std::sqrt(sum / double(heights_.size()))};
  }

 private:
  static constexpr int side = 40;
  static double place(int i) { return -0.31 + 0.62 * (i + 0.37) / side; }
  static int first_from(double x) { return std::max(0, int(std::floor((x + 0.31) / 0.62 * side - 0.37))); }

  void add(Vec3f a, Vec3f b, Vec3f c) {
    const auto area = [](double px, double pz, double qx, double qz) { return px * qz - pz * qx; };
    const double whole = area(b.x - a.x, b.z - a.z, c.x - a.x, c.z - a.z);
    if (std::abs(whole) < 1e-14) return;
    const auto [x0, x1] = std::minmax({a.x, b.x, c.x});
    const auto [z0, z1] = std::minmax({a.z, b.z, c.z});
    for (int i = first_from(x0); i < side && place(i) <= x1; ++i)
      for (int j = first_from(z0); j < side && place(j) <= z1; ++j) {
        const double x = place(i), z = place(j);
        const double s = area(x - a.x, z - a.z, c.x - a.x, c.z - a.z) / whole;
        const double t = area(b.x - a.x, b.z - a.z, x - a.x, z - a.z) / whole;
        if (s < 0 || t < 0 || s + t > 1) continue;
        double& height = heights_[std::size_t(i * side + j)];
        height = std::max(height, a.y + s * (b.y - a.y) + t * (c.y - a.y));
      }
  }

  std::vector<double> heights_;
};

struct Jumps {
  double largest = 0, rms = 0;
};

// Of the upper side of a cube on the way towards it.
Jumps jumps(const Model& model, bool fades) {
  Jumps result;
  std::optional<Profile> last;
  double sum = 0;
  int steps = 0;
  for (double height = 4; height > 1.4; height *= 0.99, ++steps) {
    Profile now(model, PointFootprint({0.1, height, 0.05}, 0.03, fades));
    if (last) {
      const auto [most, rms] = now.difference(*last);
      result.largest = std::max(result.largest, most);
      sum += rms * rms;
    }
    last = std::move(now);
  }
  result.rms = std::sqrt(sum / steps);
  return result;
}

TEST(Fading, NothingJumpsAsTheFootprintShrinks) {
  const auto model = bumpy_model(shapes::cube(), 5, 0.3, small_cells);
  const Jumps without = jumps(*model, false), with = jumps(*model, true);
  EXPECT_LT(with.largest, 0.25 * without.largest);
  EXPECT_LT(with.rms, 0.6 * without.rms);
  RecordProperty("largest_without", std::to_string(without.largest));
  RecordProperty("largest_with", std::to_string(with.largest));
  RecordProperty("rms_without", std::to_string(without.rms));
  RecordProperty("rms_with", std::to_string(with.rms));
}

TEST(Fading, SurfaceStaysClosedWhereLevelsMeet) {
  for (double pixel : {0.2, 0.05, 0.02})
    for (double amplitude : {0.0, 0.2}) {
      const auto model = bumpy_model(shapes::prism(7), 7, amplitude, small_cells);
      const PointFootprint near({1.2, 0.5, 0}, pixel, true);
      const ShownTriangles surface(*model, &near);
      EXPECT_TRUE(surface.is_closed()) << pixel;
      EXPECT_GT(surface.largest / surface.smallest, 64) << "one level would not show";
    }
}

TEST(Fading, CutIntoCellsOrNotGivesTheSameVertices) {
  const PointFootprint near({1.2, 0.5, 0}, 0.05, true);
  const ShownTriangles small(*bumpy_model(shapes::prism(7), 6, 0.2, small_cells), &near),
      whole(*bumpy_model(shapes::prism(7), 6, 0.2, {1u << 20, 1u << 20}), &near);
  EXPECT_TRUE(whole.is_closed());
  EXPECT_TRUE(are_alike(small, whole));
}

TEST(Fading, EverythingInFullWhereTheFootprintIsTiny) {
  const PointFootprint tiny({9, 9, 9}, 1e-12, true);
  const auto model = bumpy_model(shapes::cube(), 4, 0.2, small_cells);
  const ShownTriangles all(*model, nullptr), fine(*model, &tiny);
  EXPECT_TRUE(fine.is_near(all, float(PositionLattice::margin(*model))));
}

void check_bounds(const Model& model, CellMesh cell, int level, const Bounds3f& bounds, int& cells, int& outside) {
  ++cells;
  const Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) outside += !bounds.contains(e.leaf->bounds());
  for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
    check_bounds(model, child_cell(model, *e.inner, i), e.inner->level, e.inner->child_bounds[i], cells, outside);
}

TEST(Fading, CellsStayInTheirBounds) {
  int cells = 0, outside = 0;
  for (double pixel : {0.1, 0.05, 0.02, 0.012})
    for (double amplitude : {0.0, 0.3}) {
      const auto model = bumpy_model(shapes::prism(7), 6, amplitude, small_cells);
      const PointFootprint near({1.2, 0.5, 0}, pixel, true);
      check_bounds(*model, root_cell(*model, &near), 0, model_bounds(*model), cells, outside);
    }
  EXPECT_GT(cells, 500);
  EXPECT_EQ(outside, 0);
}

}  // namespace
}  // namespace meristem
