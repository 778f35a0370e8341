#include "geometry/cells/model.h"

#include "geometry/cells/expansion.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// A table knows those of a quad.
TEST(Model, EstimatesTheFacesThatComeOfAFace) {
  const auto model = bumpy_model(shapes::prism(5), 3, 0.1);
  for (int level = 0; level <= 3; ++level) {
    const double of_quad = std::exp2(2 * (3 - level));
    EXPECT_EQ(model->estimated_faces(4, -1, level), of_quad) << level;
    EXPECT_EQ(model->estimated_faces(5, -1, level), level == 3 ? 1 : 1.25 * of_quad) << level;
  }
  EXPECT_EQ(model->estimated_faces(), 5 * 64 + 2 * 80.0);
}

TEST(Model, KnowsItsBoundsAsThoseOfItsWholeBase) {
  const auto model = bumpy_model(shapes::bumpy_grid(5), 3, 0.4);
  const Bounds3f whole = model_bounds(*model, nullptr, 0, 0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(model->bounds().lower, whole.lower);
    EXPECT_EQ(model->bounds().upper, whole.upper);
  }
  EXPECT_GT(whole.size().x, 1);
}

}  // namespace
}  // namespace meristem
