// Bounds: sound by sampling, for every operation and for random expressions; sharp where that is promised.
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

using namespace test;

class BoxSampler {
 public:
  explicit BoxSampler(unsigned seed) : random_(seed) {}

  float uniform(float a, float b) {
    return std::clamp(std::uniform_real_distribution<float>(0, 1)(random_) * (b - a) + a, a, b);
  }
  Interval interval() {
    static constexpr float sizes[] = {0, 1e-4f, 0.05f, 1, 3, 20};
    static constexpr float centers[] = {0, 0.1f, 1, 5, 100};
    const float c = uniform(-1, 1) * centers[random_() % std::size(centers)],
                r = uniform(0, 1) * sizes[random_() % std::size(sizes)];
    return {c - r, c + r};
  }
  std::vector<IntervalValue> boxes() {
    std::vector<IntervalValue> list;
    for (int s = 0; s < 3; ++s) {
      const Interval i = interval();
      list.push_back(IntervalValue::scalar(i.lower, i.upper));
    }
    list.push_back({interval(), interval(), interval()});
    list.push_back(IntervalValue::unit_vector());
    return list;
  }
  // Points within the boxes: corners and ends often.
  Points points(const std::vector<IntervalValue>& boxes, std::size_t count) {
    Points p(count, unsigned(random_()));
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t s = 0; s < slot_count; ++s) {
        const std::array<Interval, 3> ranges{boxes[s].x, boxes[s].y, boxes[s].z};
        for (std::size_t c = 0; c < 3; ++c) p.columns[s][c][i] = inside(ranges[c]);
        if (boxes[s].max_length < 10) shorten(p, s, i);
      }
    return p;
  }
  unsigned next() { return unsigned(random_()); }

 private:
  float inside(Interval r) {
    const unsigned choice = unsigned(random_() % 8);
    return choice == 0 ? r.lower : choice == 1 ? r.upper : uniform(r.lower, r.upper);
  }
  void shorten(Points& p, std::size_t slot, std::size_t i) {
    const Vec3d v{p.columns[slot][0][i], p.columns[slot][1][i], p.columns[slot][2][i]};
    const double l = length(v) * (1 + 1e-7);
    if (l > 1)
      for (std::size_t c = 0; c < 3; ++c) p.columns[slot][c][i] = float(v[int(c)] / l);
  }

  std::mt19937 random_;
};

void expect_sound(const std::string& text, BoxSampler& sampler, std::size_t samples) {
  const auto e = Expression::compile(text, variables(), ValueType::Vector);
  const auto boxes = sampler.boxes();
  const IntervalValue bounds = e->evaluate_bounds(boxes);
  const Points points = sampler.points(boxes, samples);
  const Results r = evaluate(*e, points, sampler.next());
  const std::array<Interval, 3> ranges{bounds.x, bounds.y, bounds.z};
  for (std::size_t i = 0; i < samples; ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      ASSERT_TRUE(r[c][i] >= ranges[c].lower && r[c][i] <= ranges[c].upper)
          << text << ": " << r[c][i] << " lies outside of [" << ranges[c].lower << ", " << ranges[c].upper
          << "] at x=" << points.at(i)[0].x << " y=" << points.at(i)[1].x << " z=" << points.at(i)[2].x;
    const Vec3d v{r[0][i], r[1][i], r[2][i]};
    ASSERT_LE(length(v), double(bounds.max_length) * (1 + 1e-7)) << text;
  }
}

TEST(Bounds, HoldEveryValueOfEveryOperation) {
  BoxSampler sampler(11);
  for (const std::string& text : all_operations())
    for (int box = 0; box < 20; ++box) expect_sound(text, sampler, 1000);
}

// Random expression trees.
class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  std::string scalar(int depth) {
    static constexpr const char* leaves[] = {"x", "y", "z", "P[0]", "N[2]", "0.5", "2", "rand()", "PI", "-1.5"};
    static constexpr const char* unary[] = {"sin",  "cos",  "exp",  "abs",  "sqrt",  "floor", "log",
                                            "tanh", "atan", "sign", "cbrt", "noise", "tan",   "asin"};
    static constexpr const char* binary[] = {"+", "-", "*", "/", "%", "<", "==", "&&"};
    if (depth == 0) return leaves[random_() % std::size(leaves)];
    switch (random_() % 8) {
      case 0: return std::string(unary[random_() % std::size(unary)]) + "(" + scalar(depth - 1) + ")";
      case 1: return "dot(" + vector(depth - 1) + "," + vector(depth - 1) + ")";
      case 2: return "length(" + vector(depth - 1) + ")";
      case 3: return "(" + scalar(depth - 1) + " ? " + scalar(depth - 1) + " : " + scalar(depth - 1) + ")";
      case 4: return "mix(" + scalar(depth - 1) + "," + scalar(depth - 1) + "," + scalar(depth - 1) + ")";
      case 5: return "fbm(" + vector(depth - 1) + ", 3)";
      case 6: return "(" + scalar(depth - 1) + ")^" + scalar(0);
      default: return "(" + scalar(depth - 1) + binary[random_() % std::size(binary)] + scalar(depth - 1) + ")";
    }
  }
  std::string vector(int depth) {
    if (depth == 0) return random_() % 2 ? "P" : "N";
    switch (random_() % 8) {
      case 0: return "norm(" + vector(depth - 1) + ")";
      case 1: return "cross(" + vector(depth - 1) + "," + vector(depth - 1) + ")";
      case 2: return "(" + vector(depth - 1) + " - " + vector(depth - 1) + ")";
      case 3: return "rotate(" + vector(depth - 1) + "," + vector(depth - 1) + "," + scalar(depth - 1) + ")";
      case 4: return "vnoise(" + vector(depth - 1) + ")";
      case 5: return "[" + scalar(depth - 1) + "," + scalar(depth - 1) + "," + scalar(depth - 1) + "]";
      case 6: return "clamp(" + vector(depth - 1) + ", " + scalar(depth - 1) + ", 2)";
      default: return "(" + scalar(depth - 1) + " * " + vector(depth - 1) + ")";
    }
  }

 private:
  std::mt19937 random_;
};

TEST(Bounds, HoldEveryValueOfRandomExpressions) {
  Generator generator(5);
  BoxSampler sampler(6);
  for (int i = 0; i < 1000; ++i) expect_sound(generator.vector(1 + i % 5), sampler, 200);
}

IntervalValue bounds(const std::string& text, float lower, float upper, ValueType type = ValueType::Scalar) {
  std::vector<IntervalValue> boxes(slot_count, IntervalValue::scalar(lower, upper));
  boxes[3] = {{lower, upper}, {lower, upper}, {lower, upper}};
  boxes[4] = IntervalValue::unit_vector();
  return Expression::compile(text, variables(), type)->evaluate_bounds(boxes);
}
void expect_near(const IntervalValue& v, float lower, float upper, float tolerance = 1e-5f) {
  EXPECT_NEAR(v.x.lower, lower, tolerance);
  EXPECT_NEAR(v.x.upper, upper, tolerance);
}

TEST(Bounds, AreSharp) {
  expect_near(bounds("x*x", -1, 2), 0, 4);
  expect_near(bounds("x^2", -3, 2), 0, 9);
  expect_near(bounds("x - x", -3, 2), 0, 0, 0);
  expect_near(bounds("sin(x)", 0, 1), 0, std::sin(1.0f));
  expect_near(bounds("sin(x)", 1, 2), std::sin(1.0f), 1);
  expect_near(bounds("cos(x)", -1, 2), std::cos(2.0f), 1);
  expect_near(bounds("abs(sin(8*PI*x))", 0, 1), 0, 1);
  expect_near(bounds("exp(x)", -1, 1), std::exp(-1.0f), std::exp(1.0f));
  expect_near(bounds("smoothstep(x, 0, 4)", 1, 2), 0.15625f, 0.5f);
  expect_near(bounds("mix(2, 5, x)", 0, 1), 2, 5);
  expect_near(bounds("clamp(x, 0, 1)", -4, 0.5f), 0, 0.5f, 0);
  expect_near(bounds("x < 5 ? 1 : 2", 0, 1), 1, 1, 0);
  expect_near(bounds("rand(2, 3)", 0, 1), 2, 3);
  expect_near(bounds("curve(x, 0, 0, 1, 1, 2, 1, 2, 0, 1)", 0.5f, 1.5f), 1, 2);
  expect_near(bounds("1 / x", 2, 4), 0.25f, 0.5f);
  expect_near(bounds("pow(x, 3)", -2, -1), -8, -1);
  expect_near(bounds("dot(P, P)", -1, 1), 0, 3);
}

TEST(Bounds, KnowTheLengthOfVectors) {
  EXPECT_NEAR(bounds("0.6*x*N*(abs(sin(8*PI*y)) + 0.3*fbm(6*P))", 0, 2, ValueType::Vector).max_length,
              0.6 * 2 * (1 + 0.3 * 1.96875), 1e-3);
  EXPECT_NEAR(bounds("N + 2*N", 0, 1, ValueType::Vector).max_length, 3, 1e-4);
  EXPECT_NEAR(bounds("norm(P)", -9, 9, ValueType::Vector).max_length, 1, 1e-4);
  EXPECT_NEAR(bounds("-N", 0, 1, ValueType::Vector).max_length, 1, 1e-4);
}

TEST(Bounds, KnowThatDenormalNumbersActAsZero) {
  for (const char* text : {"x == 0", "floor(x)", "1 / x", "x ? 2 : 3", "x", "sign(x)"})
    for (float v : {1e-40f, -1e-40f}) {
      const IntervalValue b = bounds(text, v, v);
      const float r = value(text, {Vec3f{v, 0, 0}});
      EXPECT_TRUE(r >= b.x.lower && r <= b.x.upper) << text;
    }
}

TEST(Bounds, OfNoisesShrinkWithTheBox) {
  const IntervalValue small = bounds("fbm(P)", 0.5f, 0.5001f), wide = bounds("fbm(P)", 0, 9);
  EXPECT_LT(small.x.upper - small.x.lower, 0.02f);
  EXPECT_NEAR(wide.x.upper, 1.96875, 1e-3);
  for (const char* text : {"fbm4(P, x)", "snoise4(P, x)", "vnoise4(P, x)[2]", "pnoise(P, [3, 4, 5])"}) {
    const IntervalValue b = bounds(text, 0.5f, 0.5001f);
    EXPECT_LT(b.x.upper - b.x.lower, 0.03f) << text;
  }
  // Noises of other periods have nothing in common
  EXPECT_NEAR(bounds("pnoise([0.1, 0.2, 0.3], [x, 4, 4])", 2.5f, 3.5f).x.upper, 1, 1e-4);
  EXPECT_LT(bounds("pnoise([0.1, 0.2, 0.3], [x, 4, 4])", 3, 3.5f).x.upper, 0.9f);
}

}  // namespace
}  // namespace meristem
