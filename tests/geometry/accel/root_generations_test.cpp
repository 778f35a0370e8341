#include "geometry/accel/root_generations.h"

#include <gtest/gtest.h>

#include <utility>

namespace meristem {
namespace {

class Holder final : public ModelRoot {
 public:
  explicit Holder(std::vector<const ModelRoot*> placed = {}) : ModelRoot({}), placed_(std::move(placed)) {}
  void intersect(RayContext&, RTCRayHit&) const override {}
  void occluded(RayContext&, RTCRay&) const override {}
  void add_placed(std::vector<const ModelRoot*>& roots) const override {
    roots.insert(roots.end(), placed_.begin(), placed_.end());
  }
  std::size_t bytes() const override { return sizeof(*this); }

 private:
  const std::vector<const ModelRoot*> placed_;
};

TEST(RootGenerations, WhatIsPlacedComesBeforeWhereItIs) {
  const Holder leaf, tree({&leaf, &leaf}), stone, wood({&tree, &stone, &tree}), garden({&wood, &leaf}), other;
  const auto generations = root_generations({&garden, &wood, &other, &garden});
  using Roots = std::vector<const ModelRoot*>;
  ASSERT_EQ(generations.size(), 4u);
  EXPECT_EQ(generations[0], (Roots{&leaf, &stone, &other}));
  EXPECT_EQ(generations[1], Roots{&tree});
  EXPECT_EQ(generations[2], Roots{&wood});
  EXPECT_EQ(generations[3], Roots{&garden});
  EXPECT_TRUE(root_generations({}).empty());
}

}  // namespace
}  // namespace meristem
