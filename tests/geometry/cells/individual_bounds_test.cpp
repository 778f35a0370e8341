#include "geometry/cells/individual_bounds.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

class IndividualBoundsTest : public testing::Test {
 protected:
  // Made anew with a number of its own.
  Bounds3f get(const IndividualBounds::Name& name) {
    return bounds_.get(name, [&] {
      ++made_;
      return Bounds3f{Vec3f(0), Vec3f(float(made_))};
    });
  }

  IndividualBounds bounds_;
  int made_ = 0;
};

TEST_F(IndividualBoundsTest, AreMadeOnceForEachName) {
  const IndividualBounds::Name names[] = {{1, 0.5, false}, {2, 0.5, false}, {1, 0.25, false}, {1, 0.5, true}};
  for (const auto& name : names) get(name);
  EXPECT_EQ(made_, 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(get(names[i]).upper.x, float(i + 1)) << i;
  EXPECT_EQ(made_, 4);
}

TEST_F(IndividualBoundsTest, AreForgottenWhenTheyAreMany) {
  for (Key i = 0; i < IndividualBounds::most_known; ++i) get({i, 1, false});
  get({0, 1, false});
  EXPECT_EQ(made_, int(IndividualBounds::most_known));
  get({IndividualBounds::most_known, 1, false});
  get({0, 1, false});
  EXPECT_EQ(made_, int(IndividualBounds::most_known) + 2);
}

}  // namespace
}  // namespace meristem
