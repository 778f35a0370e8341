#include "tests/support/component.h"

#include <gtest/gtest.h>

namespace meristem {
void register_blackman_harris(FilterRegistry& r);
void register_box(FilterRegistry& r);
void register_gaussian(FilterRegistry& r);
void register_mitchell(FilterRegistry& r);

namespace {

using Registration = void (*)(FilterRegistry&);

class AnyFilter : public testing::TestWithParam<Registration> {};
INSTANTIATE_TEST_SUITE_P(, AnyFilter,
                         testing::Values(&register_blackman_harris, &register_box, &register_gaussian,
                                         &register_mitchell));

double integral(const Filter& filter) {
  constexpr int steps = 20000;
  const double width = 2 * double(filter.radius());
  double sum = 0;
  for (int i = 0; i < steps; ++i) sum += double(filter.value(float(width * ((i + 0.5) / steps - 0.5))));
  return sum * width / steps;
}

TEST_P(AnyFilter, IntegratesToOne) {
  EXPECT_NEAR(integral(*make<Filter>(GetParam())), 1, 1e-4);
  EXPECT_NEAR(integral(*make<Filter>(GetParam(), R"({ "radius": 2.7 })")), 1, 1e-4);
}

TEST_P(AnyFilter, IsSymmetricAndEndsAtItsRadius) {
  const auto filter = make<Filter>(GetParam());
  for (float x = 0; x < 3; x += 0.07f) EXPECT_EQ(filter->value(x), filter->value(-x));
  EXPECT_EQ(filter->value(filter->radius() * 1.001f), 0);
  EXPECT_GT(filter->value(0), 0);
}

// The cubic's values from the paper's formula at b = c = 1/3: k(0) = 8/9, k(1) = 1/18, k(1.5) = -0.0347222.
TEST(Mitchell, HasThePublishedValues) {
  const auto filter = make<Filter>(register_mitchell);
  EXPECT_NEAR(filter->value(0), 8.0 / 9, 1e-6);
  EXPECT_NEAR(filter->value(1), 1.0 / 18, 1e-6);
  EXPECT_NEAR(filter->value(1.5f), -5.0 / 144, 1e-6);
}

TEST(BlackmanHarris, IsTheDefaultOfRadiusOneAndAHalf) {
  EXPECT_EQ(make<Filter>(register_blackman_harris)->radius(), 1.5f);
}

}  // namespace
}  // namespace meristem
