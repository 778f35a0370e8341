// Values of the language against the same formulas in plain double precision, and its definitions at the edges.
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

#include <bit>
#include <functional>

namespace meristem {
namespace {

using namespace test;

double ulp(float v) { return double(std::nextafter(std::abs(v), INFINITY)) - double(std::abs(v)); }

struct Function {
  const char* text;
  std::function<double(double)> truth;
  float lower, upper;
};

class Accuracy : public testing::TestWithParam<Function> {};

// The header of math_lanes.h promises half an ulp and a little; glibc's double functions are the truth.
TEST_P(Accuracy, IsCorrectToTheLastPlace) {
  const auto& [text, truth, lower, upper] = GetParam();
  Points points(20000, 7);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(lower, upper);
  for (float& v : points.columns[0][0]) v = uniform(random);
  const Results r = evaluate(text, points, ValueType::Scalar);
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = truth(points.columns[0][0][i]);
    if (std::abs(expected) < 1e-37) continue;
    worst = std::max(worst, std::abs(double(r[0][i]) - expected) / ulp(float(expected)));
  }
  EXPECT_LT(worst, 0.51) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Functions, Accuracy,
    testing::Values(Function{"sin(x)", [](double x) { return std::sin(x); }, -1e6f, 1e6f},
                    Function{"sin(x)", [](double x) { return std::sin(x); }, -4, 4},
                    Function{"cos(x)", [](double x) { return std::cos(x); }, -1e6f, 1e6f},
                    Function{"tan(x)", [](double x) { return std::tan(x); }, -100, 100},
                    Function{"asin(x)", [](double x) { return std::asin(x); }, -1, 1},
                    Function{"acos(x)", [](double x) { return std::acos(x); }, -1, 1},
                    Function{"atan(x)", [](double x) { return std::atan(x); }, -20, 20},
                    Function{"atan2(x, 0.3)", [](double x) { return std::atan2(x, double(0.3f)); }, -2, 2},
                    Function{"atan2(x, -2)", [](double x) { return std::atan2(x, -2); }, -5, 5},
                    Function{"sinh(x)", [](double x) { return std::sinh(x); }, -3, 3},
                    Function{"sinh(x)", [](double x) { return std::sinh(x); }, -0.02f, 0.02f},
                    Function{"cosh(x)", [](double x) { return std::cosh(x); }, -80, 80},
                    Function{"tanh(x)", [](double x) { return std::tanh(x); }, -3, 3},
                    Function{"tanh(x)", [](double x) { return std::tanh(x); }, -0.02f, 0.02f},
                    Function{"asinh(x)", [](double x) { return std::asinh(x); }, -1e6f, 1e6f},
                    Function{"asinh(x)", [](double x) { return std::asinh(x); }, -0.02f, 0.02f},
                    Function{"acosh(x)", [](double x) { return std::acosh(x); }, 1, 1.001f},
                    Function{"acosh(x)", [](double x) { return std::acosh(x); }, 1, 1e6f},
                    Function{"atanh(x)", [](double x) { return std::atanh(x); }, -0.999f, 0.999f},
                    Function{"atanh(x)", [](double x) { return std::atanh(x); }, -0.02f, 0.02f},
                    Function{"exp(x)", [](double x) { return std::exp(x); }, -87, 88},
                    Function{"log(x)", [](double x) { return std::log(x); }, 1e-6f, 1e6f},
                    Function{"log(x)", [](double x) { return std::log(x); }, 0.9f, 1.1f},
                    Function{"log10(x)", [](double x) { return std::log10(x); }, 1e-6f, 1e6f},
                    Function{"sqrt(x)", [](double x) { return std::sqrt(x); }, 0, 1e6f},
                    Function{"cbrt(x)", [](double x) { return std::cbrt(x); }, -1e6f, 1e6f},
                    Function{"pow(x, 5.5)", [](double x) { return std::pow(x, 5.5); }, 0.001f, 1e5f},
                    Function{"x^-7", [](double x) { return std::pow(x, -7); }, -10, 10}));

TEST(Values, FollowOperatorPrecedence) {
  EXPECT_EQ(value("1 + 2 * 3"), 7);
  EXPECT_EQ(value("-2^2"), -4);
  EXPECT_EQ(value("2^-1"), 0.5f);
  EXPECT_EQ(value("2^3^2"), 512);
  EXPECT_EQ(value("10 - 3 - 2"), 5);
  EXPECT_EQ(value("7 % 4 * 2"), 6);
  EXPECT_EQ(value("-7 % 4"), 1);
  EXPECT_EQ(value("1 < 2 == 1"), 1);
  EXPECT_EQ(value("0 && 1 || 1"), 1);
  EXPECT_EQ(value("1 ? 2 : 0 ? 3 : 4"), 2);
  EXPECT_EQ(value("0 ? 2 : 0 ? 3 : 4"), 4);
  EXPECT_EQ(value("!0 + 1"), 2);
  EXPECT_EQ(value("~0.25"), 0.75f);
  EXPECT_EQ(value("2 + 3 -> pow(2)"), 25);
}

TEST(Values, KnowAssignmentsCommentsAndBranches) {
  EXPECT_EQ(value("a = 2; # two\nb = a * 3; a += b; a"), 8);
  EXPECT_EQ(value("$x + ($PI - PI)", {Vec3f{3, 0, 0}}), 3);
  EXPECT_EQ(value("a = 1; if (x > 0) { a = 2; b = 5; } else { a = 3; b = 6; } a + b", {Vec3f{1, 0, 0}}), 7);
  EXPECT_EQ(value("a = 1; if (x > 0) { a = 2; } else if (x < -5) { a = 3; } a", {Vec3f{-9, 0, 0}}), 3);
  EXPECT_EQ(value("a = 1; if (x > 0) { a = 2; } else if (x < -5) { a = 3; } a", {Vec3f{-2, 0, 0}}), 1);
  EXPECT_EQ(value("a = 1; if (x > 0) { a = 2; a *= 4; } a;", {Vec3f{1, 0, 0}}), 8);
}

TEST(Values, BroadcastScalarsOverVectors) {
  EXPECT_EQ(vector_value("2 * [1, 2, 3] + 1"), Vec3f(3, 5, 7));
  EXPECT_EQ(vector_value("clamp([-1, 0.5, 2], 0, 1)"), Vec3f(0, 0.5f, 1));
  EXPECT_EQ(vector_value("mix([0, 0, 0], [2, 4, 6], 0.5)"), Vec3f(1, 2, 3));
  EXPECT_EQ(vector_value("5"), Vec3f(5, 5, 5));
  EXPECT_EQ(value("[1, 2, 3][2]"), 3);
}

TEST(Values, OfVectorFunctions) {
  EXPECT_EQ(vector_value("cross([1,0,0], [0,1,0])"), Vec3f(0, 0, 1));
  EXPECT_EQ(value("dot([1,2,3], [4,5,6])"), 32);
  EXPECT_EQ(value("length([2,3,6])"), 7);
  EXPECT_FLOAT_EQ(value("length([2e30,3e30,6e30])"), 7e30f);
  EXPECT_EQ(vector_value("norm([0,0,0])"), Vec3f(0, 0, 0));
  EXPECT_NEAR(value("angle([1,0,0], [0,2,0])"), pi / 2, 1e-7);
  const Vec3f turned = vector_value("rotate([1,0,0], [0,0,5], PI/2)");
  EXPECT_NEAR(turned.y, 1, 1e-7);
  EXPECT_NEAR(turned.x, 0, 1e-7);
  EXPECT_EQ(vector_value("rotate([1,2,3], [0,0,0], 1)"), Vec3f(1, 2, 3));
  EXPECT_NEAR(vector_value("up([0,1,0], [0,-1,0])").y, -1, 1e-7);
  EXPECT_NEAR(vector_value("up([0,2,0], [3,0,0])").x, 2, 1e-6);
}

TEST(Values, OfRamps) {
  EXPECT_EQ(value("smoothstep(0.5, 0, 1)"), 0.5f);
  EXPECT_EQ(value("smoothstep(0.25, 1, 0)"), 0.84375f);
  EXPECT_EQ(value("linearstep(3, 2, 6)"), 0.25f);
  EXPECT_EQ(value("linearstep(2, 2, 2)"), 1);
  EXPECT_EQ(value("boxstep(1, 2)"), 0);
  EXPECT_EQ(value("gaussstep(0.5, 0, 1)"), 0.25f);
  EXPECT_EQ(value("gaussstep(-1, 0, 1)"), 0);
  EXPECT_EQ(value("remap(0.5, 0, 1, 1, 0)"), 1);
  EXPECT_EQ(value("remap(1.5, 0, 1, 1, 0)"), 0.5f);
  EXPECT_EQ(value("remap(-3, 0, 1, 1, 2)"), 0);
  EXPECT_EQ(value("compress(0.5, 2, 4)"), 3);
  EXPECT_EQ(value("expand(3, 2, 4)"), 0.5f);
  EXPECT_EQ(value("fit(3, 2, 4, 10, 20)"), 15);
  EXPECT_NEAR(value("bias(0.5, 0.3)"), 0.3, 1e-7);
  EXPECT_NEAR(value("gamma(0.25, 2)"), 0.5, 1e-7);
  EXPECT_NEAR(value("contrast(0.5, 0.9)"), 0.5, 1e-7);
}

void expect_near(Vec3f a, Vec3f b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-6) << c;
}

TEST(Values, OfColours) {
  expect_near(vector_value("rgbtohsl([1, 0.5, 0])"), {1 / 12.0f, 1, 0.5f});
  expect_near(vector_value("rgbtohsl([0.2, 0.2, 0.4])"), {2 / 3.0f, 1 / 3.0f, 0.3f});
  EXPECT_EQ(vector_value("rgbtohsl([0.3, 0.3, 0.3])"), Vec3f(0, 0, 0.3f));
  EXPECT_EQ(vector_value("rgbtohsl([1, 1, 1])"), Vec3f(0, 0, 1));
  for (const char* color : {"[0.9, 0.1, 0.3]", "[0.1, 0.8, 0.7]", "[0.25, 0.125, 0.75]", "[0, 0, 0]", "[1, 1, 1]"})
    expect_near(vector_value("hsltorgb(rgbtohsl(" + std::string(color) + "))"), vector_value(color));
  expect_near(vector_value("hsi([1, 0, 0], 120, 1, 0.5)"), {0, 0.5f, 0});
  expect_near(vector_value("hsi([1, 0, 0], -120, 1, 1)"), {0, 0, 1});
  expect_near(vector_value("hsi([0.8, 0.4, 0.2], 77, 0, 9, 0)"), {0.8f, 0.4f, 0.2f});
  expect_near(vector_value("saturate([1, 0.5, 0], 0)"), Vec3f(0.2126f + 0.3576f));
  expect_near(vector_value("saturate([1, 0.5, 0], 1)"), {1, 0.5f, 0});
  EXPECT_EQ(vector_value("saturate([1, 0, 0], 3)").y, 0);
}

// The colour, hue, factors of saturation and intensity, and the map.
TEST(Values, OfMidhsiGoBothWays) {
  const std::string args = "midhsi([0.5, 0.25, 0.25], 120, 0.5, 2, ";
  expect_near(vector_value(args + "0.5)"), {0.5f, 0.25f, 0.25f});
  expect_near(vector_value(args + "1)"), vector_value("hsi([0.5, 0.25, 0.25], 120, 0.5, 2)"));
  expect_near(vector_value(args + "0)"), vector_value("hsi([0.5, 0.25, 0.25], -120, 2, 0.5)"));
  expect_near(vector_value(args + "0.75)"), vector_value("hsi([0.5, 0.25, 0.25], 60, 0.75, 1.5)"));
  expect_near(vector_value(args + "0.25)"), vector_value("hsi([0.5, 0.25, 0.25], -60, 1/0.75, 1/1.5)"));
  expect_near(vector_value(args + "0.75, 0.5)"), {0.5f, 0.25f, 0.25f});  // a falloff of 0.5 starts at a map of 0.75
  expect_near(vector_value(args + "0.8125, 1, 1)"), vector_value(args + "0.5 + smoothstep(0.625, 0, 1)/2)"));
}

TEST(Values, OfCurves) {
  EXPECT_EQ(value("curve(0.5, 0, 1, 1, 1, 3, 1)"), 2);
  EXPECT_EQ(value("curve(-4, 0, 1, 1, 1, 3, 1)"), 1);
  EXPECT_EQ(value("curve(9, 0, 1, 1, 1, 3, 1)"), 3);
  EXPECT_EQ(value("curve(0.9, 0, 1, 0, 1, 3, 0)"), 1);
  EXPECT_EQ(value("curve(0.25, 0, 0, 2, 1, 1, 2)"), 0.15625f);
  EXPECT_EQ(value("curve(0.5, 1, 3, 1, 0, 1, 1)"), 2) << "points in any order";
  EXPECT_EQ(vector_value("ccurve(0.5, 0, [0,1,2], 1, 1, [2,3,4], 1)"), Vec3f(1, 2, 3));
  EXPECT_EQ(value("spline(0, 9, 1, 2, 8)"), 1);
  EXPECT_EQ(value("spline(1, 9, 1, 2, 8)"), 2);
  EXPECT_EQ(value("spline(0.5, 0, 1, 2, 3, 4)"), 2);
}

TEST(Values, OfMonotoneCurvesNeverOvershoot) {
  Points points(2000, 5, 4);
  const Results r = evaluate("curve(x, 0, 0, 4, 1, 0, 4, 1.2, 1, 4, 3, 1, 4)", points, ValueType::Scalar);
  for (float v : r[0]) EXPECT_TRUE(v >= -1e-6f && v <= 1 + 1e-6f) << v;
}

TEST(Values, OfChoices) {
  EXPECT_EQ(value("choose(0.4, 1, 2, 3)"), 2);
  EXPECT_EQ(value("choose(5, 1, 2, 3)"), 3);
  EXPECT_EQ(value("choose(-5, 1, 2, 3)"), 1);
  EXPECT_EQ(value("swatch(1.9, 4, 5, 6)"), 5);
  EXPECT_EQ(value("swatch(-3, 4, 5, 6)"), 4);
  EXPECT_EQ(value("swatch(9, 4, 5, 6)"), 6);
  EXPECT_EQ(value("wchoose(0.7, 1, 6, 2, 2, 3, 2)"), 2);
  EXPECT_EQ(vector_value("choose(0.9, [1,2,3], [4,5,6])"), Vec3f(4, 5, 6));
  EXPECT_EQ(value("pick(0.99, 1, 6)"), 6);
  EXPECT_EQ(value("cycle(7, 2, 4)"), 3);
}

TEST(Values, AreDefinedWhereMathematicsIsNot) {
  EXPECT_EQ(value("x / 0", {Vec3f{3, 0, 0}}), 0);
  EXPECT_EQ(value("5 % x"), 0);
  EXPECT_EQ(value("fmod(5, x)"), 0);
  EXPECT_EQ(value("sqrt(-4)"), 0);
  EXPECT_NEAR(value("log(-1)"), std::log(0x1p-126), 1e-5);
  EXPECT_NEAR(value("acos(2)"), 0, 1e-7);
  EXPECT_EQ(value("acosh(-7)"), 0);
  EXPECT_NEAR(value("atanh(1)"), std::atanh(1 - 0x1p-24), 1e-6);
  EXPECT_EQ(value("(-2)^0.5"), 0);
  EXPECT_EQ(value("(-2)^1.5"), 0);
  EXPECT_EQ(value("(-2)^5"), -32);
  EXPECT_EQ(value("x^-1"), 0);
  EXPECT_EQ(value("x^x"), 1);
  EXPECT_EQ(value("atan2(0, 0)"), 0);
  EXPECT_EQ(value("3e38 + 3e38"), std::numeric_limits<float>::max());
  EXPECT_EQ(value("exp(1000)"), std::numeric_limits<float>::max());
}

// Whatever finite numbers go in, finite numbers come out.
TEST(Values, AreAlwaysFinite) {
  const float special[] = {0,      -0.0f, 1,      -1,       0.5f,         2,     1e-40f, 1e-38f, 3e38f,
                           -3e38f, 1e30f, -1e20f, 16777216, 2147483648.f, -5e9f, 1e-20f};
  Points points(4000, 9);
  std::mt19937 random(4);
  for (auto& column : points.columns)
    for (auto& component : column)
      for (float& v : component) v = special[random() % std::size(special)];
  for (const std::string& text : all_operations()) {
    const Results r = evaluate(text, points);
    for (const auto& c : r)
      for (float v : c) ASSERT_TRUE(std::isfinite(v)) << text;
  }
}

TEST(Rand, IsUniformAndDiffersByOccurrenceKeySaltAndSeed) {
  const Points points(40000, 3);
  const auto e = Expression::compile("[rand(), rand(), rand(0, 1, 5)]", variables(), ValueType::Vector);
  const Results r = evaluate(*e, points, 1), other = evaluate(*e, points, 2);
  std::array<double, 3> mean{}, square{};
  double correlation = 0, between_salts = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_TRUE(r[c][i] >= 0 && r[c][i] < 1);
      mean[c] += r[c][i] / double(points.size());
      square[c] += r[c][i] * r[c][i] / double(points.size());
    }
    correlation += (r[0][i] - 0.5) * (r[1][i] - 0.5) * 12 / double(points.size());
    between_salts += (r[0][i] - 0.5) * (other[0][i] - 0.5) * 12 / double(points.size());
  }
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 0.5, 5 * 0.2887 / 200);
    EXPECT_NEAR(square[c], 1.0 / 3, 5 * 0.298 / 200);
  }
  EXPECT_NEAR(correlation, 0, 0.025);
  EXPECT_NEAR(between_salts, 0, 0.025);
  EXPECT_TRUE(e->uses_random());
  EXPECT_FALSE(e->is_constant());
}

TEST(Rand, StandsInItsRangeAndIsOneValueInAVariable) {
  const Points points(1000);
  const Results r = evaluate("rand(3, 4)", points, ValueType::Scalar);
  for (float v : r[0]) EXPECT_TRUE(v >= 3 && v <= 4);
  const Results zero = evaluate("a = rand(); a - a", points, ValueType::Scalar);
  for (float v : zero[0]) EXPECT_EQ(v, 0);
}

}  // namespace
}  // namespace meristem
