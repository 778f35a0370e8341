// Ground on which parts are placed.
#include "geometry/accel/lazy_root.h"
#include "geometry/accel/world.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace meristem {
namespace {

std::shared_ptr<const Part> small_cube() {
  return std::make_shared<const Part>(bumpy_model(shapes::cube(0.05), 1, 0.1));
}

// Puts a part on the first corner of each face; none on those from `fails_from` on: there it throws.
class OnCorners final : public Placer {
 public:
  OnCorners(std::shared_ptr<const Part> part, std::uint32_t fails_from = ~0u)
      : part_(std::move(part)), fails_from_(fails_from) {}
  std::unique_ptr<const Furnishing> furnish(const CellMesh& ground, Key) const override {
    return std::make_unique<const OnCell>(*this, ground);
  }
  bool leaves_bare(const Bounds3f&) const override { return false; }
  Bounds3f reach() const override { return part_->bounds.inflated(Vec3f(1e-4f)); }  // sums are rounded
  std::shared_ptr<const PlacedReach> reach_on(const Bounds3f&, const Footprint*, Key) const override {
    return std::make_shared<const PlacedReach>(PlacedReach{reach()});
  }

 private:
  class OnCell final : public Furnishing {
   public:
    OnCell(const OnCorners& placer, const CellMesh& ground) : placer_(placer) {
      for (std::uint32_t f = 0; f < ground.owned_faces; ++f)
        places_.push_back(ground.mesh.positions[ground.mesh.corners(f)[0]]);
    }
    std::uint32_t face_count() const override { return std::uint32_t(places_.size()); }
    std::uint32_t most_on(std::uint32_t) const override { return 1; }
    Bounds3f ground_bounds() const override { return of(0, face_count()); }
    Bounds3f bounds(std::uint32_t begin, std::uint32_t end, const PlacedReach& reach) const override {
      return bounds_with_reach(of(begin, end), reach.all);
    }
    void place(std::uint32_t begin, std::uint32_t end, std::vector<Placement>& placements) const override {
      if (end > placer_.fails_from_) throw std::runtime_error("nothing stands here");
      for (std::uint32_t f = begin; f < end; ++f)
        placements.push_back({placer_.part_, Affine3d::translation(places_[f]), 1, true});
    }
    std::size_t bytes() const override { return sizeof(*this) + places_.capacity() * sizeof(Vec3d); }

   private:
    Bounds3f of(std::uint32_t begin, std::uint32_t end) const {
      Bounds3d bounds;
      for (std::uint32_t f = begin; f < end; ++f) bounds.extend(places_[f]);
      return round_outwards(bounds);
    }
    const OnCorners& placer_;
    std::vector<Vec3d> places_;
  };

  const std::shared_ptr<const Part> part_;
  const std::uint32_t fails_from_;
};

std::shared_ptr<const Model> wide_ground() {
  return bumpy_model(shapes::bumpy_grid(8), 2, 0.1, {.leaf_faces = 64, .keeps_leaf_meshes = true});
}

Placement furnished(const std::shared_ptr<const Model>& ground, const std::shared_ptr<const Placer>& placer) {
  return {std::make_shared<const Part>(ground, placer), {}, 0, true};
}

ExpansionStatistics eager(const std::vector<Placement>& objects) {
  return make_world(objects, {.mode = ExpandMode::Eager})->statistics();
}

TEST(Ground, IsExpandedOnceForAllThatStandsOnIt) {
  const auto cube = small_cube();
  const auto one = wide_ground(), other = wide_ground();
  const auto placer = std::make_shared<const OnCorners>(cube), second = std::make_shared<const OnCorners>(cube);
  const std::uint64_t alone = eager({furnished(one, placer)}).faces;
  EXPECT_EQ(eager({furnished(one, placer), furnished(one, second)}).faces, alone);
  EXPECT_GT(eager({furnished(one, placer), furnished(other, second)}).faces, alone + 16 * 64);
}

// Each with boxes of what it puts there.
TEST(Ground, IsHeldOnceByAllThatStandsOnIt) {
  GeometryCache cache(std::numeric_limits<std::size_t>::max());
  ExpansionCounts counts;
  Roots roots(WorldOptions{}, cache, counts);
  const auto ground = wide_ground();
  const auto root_on = [&](std::shared_ptr<const Part> stands_there) {
    const auto part = std::make_shared<const Part>(ground, std::make_shared<const OnCorners>(std::move(stands_there)));
    return std::make_unique<LazyRoot>(RootSource{part, nullptr, 0, nullptr, part->bounds}, roots, cache, counts,
                                      nullptr);
  };
  const auto low = root_on(small_cube()),
             high = root_on(std::make_shared<const Part>(bumpy_model(shapes::cube(2), 1, 0)));
  CellEntry *const under_low = low->root(), *const under_high = high->root();
  ASSERT_TRUE(under_low && under_low->inner());
  EXPECT_EQ(under_low->inner(), under_high->inner());
  ASSERT_EQ(under_low->child_bounds().size(), under_low->child_count());
  for (std::size_t i = 0; i < under_low->child_count(); ++i) {
    const Bounds3f &a = under_low->child_bounds()[i], &b = under_high->child_bounds()[i];
    EXPECT_GT(a.size().y, under_low->inner()->child_bounds[i].size().y);
    EXPECT_GT(b.size().y, a.size().y + 2);
  }
}

TEST(Ground, AGroupThatCannotBePlacedIsDrawnAsItsBox) {
  const auto cube = small_cube();
  const auto world = [&](std::uint32_t fails_from) {
    return make_world({furnished(wide_ground(), std::make_shared<const OnCorners>(cube, fails_from))}, {});
  };
  const auto whole = world(~0u), part = world(32);
  const Bounds3f bounds = whole->bounds();
  int hits = 0, more = 0;
  for (Key i = 0; i < 4000; ++i) {
    const auto between = [&](float lower, float upper, Key what) {
      return lower + (upper - lower) * uniform_float(hash_keys(i, what));
    };
    const Ray down{
        {between(bounds.lower.x, bounds.upper.x, 1), bounds.upper.y + 1, between(bounds.lower.z, bounds.upper.z, 2)},
        {0, -1, 0}};
    SurfaceHit hit;
    const bool meets = whole->intersect(down, hit), meets_part = part->intersect(down, hit);
    EXPECT_TRUE(meets_part || !meets) << i;
    hits += meets;
    more += meets_part && !meets;
  }
  EXPECT_GT(hits, 50);
  EXPECT_GT(more, 50);
  EXPECT_EQ(whole->statistics().failed, 0u);
  const ExpansionStatistics statistics = part->statistics();
  EXPECT_GT(statistics.failed, 0u);
  ASSERT_EQ(statistics.defects.size(), 1u);
  EXPECT_NE(statistics.defects[0].find("nothing stands here"), std::string::npos);
}

}  // namespace
}  // namespace meristem
