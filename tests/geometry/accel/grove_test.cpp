#include "geometry/accel/grove.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// On face f of a row of squares stand f % 3 parts.
class Row final : public Furnishing {
 public:
  explicit Row(std::uint32_t faces) : faces_(faces) {}
  std::uint32_t face_count() const override { return faces_; }
  std::uint32_t most_on(std::uint32_t face) const override { return face % 3; }
  Bounds3f ground_bounds() const override { return {{0, 0, 0}, {float(faces_), 0, 1}}; }
  Bounds3f bounds(std::uint32_t begin, std::uint32_t end, const PlacedReach& reach) const override {
    return bounds_with_reach({{float(begin), 0, 0}, {float(end), 0, 1}}, reach.all);
  }
  void place(std::uint32_t begin, std::uint32_t end, std::vector<Placement>& placements) const override {
    for (std::uint32_t f = begin; f < end; ++f)
      for (std::uint32_t i = 0; i < most_on(f); ++i)
        placements.push_back({nullptr, Affine3d::translation({double(f), 0, 0}), hash_keys(f, i)});
  }
  std::size_t bytes() const override { return sizeof(*this); }

 private:
  const std::uint32_t faces_;
};

TEST(Grove, GroupsHoldWhatStandsOnAllFacesInTheirOrder) {
  for (const std::uint32_t faces : {5u, 64u, 67u, 1000u}) {
    std::vector<Placement> all;
    Row(faces).place(0, faces, all);
    const Grove grove(std::make_unique<const Row>(faces), {{Vec3f(-1), Vec3f(1)}});
    EXPECT_LE(grove.bounds().size(), 32u);
    std::size_t next = 0;
    for (std::size_t group = 0; group < grove.bounds().size(); ++group) {
      EXPECT_EQ(grove.first_number(group), next);
      const std::vector<Placement> placements = grove.placements(group);
      EXPECT_EQ(placements.size(), grove.most_in(group));
      for (const Placement& p : placements) {
        EXPECT_EQ(p.individual, all[next++].individual);
        EXPECT_TRUE(grove.bounds()[group].contains(Vec3f(p.to_parent.origin)));
      }
    }
    EXPECT_EQ(next, all.size());
  }
}

TEST(Grove, IsNotWorthwhileForFew) {
  EXPECT_FALSE(Grove::is_worthwhile(Row(24)));
  EXPECT_TRUE(Grove::is_worthwhile(Row(64)));
}

}  // namespace
}  // namespace meristem
