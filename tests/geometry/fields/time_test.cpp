// What `time` is in expressions, and in numbers of components that may depend on it.
#include "geometry/fields/time.h"

#include "geometry/base/params.h"
#include "geometry/fields/expression.h"
#include "tests/geometry/base/values.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

float value_of(const char* text) {
  return Expression::compile(text, Symbols(), ValueType::Scalar)->evaluate_scalar({});
}

TEST(Time, IsAConstantOfTheInnermostScope) {
  TimeScope outer(2.5);
  EXPECT_FALSE(outer.was_read());
  EXPECT_TRUE(Expression::compile("2*time", Symbols(), ValueType::Scalar)->is_constant());
  EXPECT_EQ(value_of("2*time"), 5);
  EXPECT_TRUE(outer.was_read());
  TimeScope inner(7);
  EXPECT_EQ(value_of("1"), 1);
  EXPECT_FALSE(inner.was_read());
  EXPECT_EQ(value_of("time"), 7);
}

TEST(Time, WhatIsCompiledKeepsIt) {
  std::shared_ptr<const Expression> kept;
  {
    TimeScope scope(3);
    kept = Expression::compile("time", Symbols(), ValueType::Scalar);
  }
  EXPECT_EQ(kept->evaluate_scalar({}), 3);
}

TEST(Time, IsUnknownWithoutAScope) {
  EXPECT_THROW(value_of("time"), ExpressionError);
  TimeScope scope(1);
  try {
    value_of("tiem");
    FAIL();
  } catch (const ExpressionError& error) {
    EXPECT_STREQ(error.what(), "unknown variable \"tiem\"; did you mean \"time\"?");
  }
}

TEST(Time, AVariableOfThatNameGoesBefore) {
  TimeScope scope(1);
  Symbols symbols;
  symbols.add("time", ValueType::Scalar);
  const Vec3f mine(8);
  EXPECT_EQ(Expression::compile("time", symbols, ValueType::Scalar)->evaluate_scalar({&mine, 1}), 8);
  EXPECT_EQ(value_of("time = 4; time"), 4);
  EXPECT_FALSE(scope.was_read());
}

using namespace testing;  // number(), text(), array(), object()

class TimedParams : public ::testing::Test {
 protected:
  std::string message() const { return diagnostics_.list().empty() ? "" : diagnostics_.list()[0].message; }
  Diagnostics diagnostics_;
  TimeScope scope_{10};
};

TEST_F(TimedParams, TakeNumbersAndExpressions) {
  const Value value = object({{"a", text("time/4")},
                              {"b", number(3)},
                              {"c", text("[time, 1, 2]")},
                              {"d", array({number(1), text("time"), number(3)})},
                              {"e", text("0.1*time")}});
  Params params(value, "thing", diagnostics_);
  params.allow_time();
  EXPECT_EQ(params.real("a", 0, any_range, ""), 2.5);
  EXPECT_EQ(params.real("b", 0, any_range, ""), 3);
  EXPECT_EQ(params.vector("c", {}, any_range, ""), (Vec3d{10, 1, 2}));
  EXPECT_EQ(params.required_vector("d", ""), (Vec3d{1, 10, 3}));
  EXPECT_EQ(params.color("e", {}, ""), Vec3d(1));
  EXPECT_EQ(message(), "");
}

TEST_F(TimedParams, RefuseWhatIsWrongAtThisTime) {
  const Value value = object({{"a", text("time")}, {"b", text("tme")}});
  Params params(value, "thing", diagnostics_);
  params.allow_time();
  EXPECT_EQ(params.real("a", 1, {0, 5, ""}, ""), 1);
  EXPECT_EQ(params.real("b", 2, any_range, ""), 2);
  ASSERT_EQ(diagnostics_.list().size(), 2u);
  EXPECT_EQ(diagnostics_.list()[0].message, "\"a\" of thing is 10; expected 0 to 5");
  EXPECT_EQ(diagnostics_.list()[1].message, "unknown variable \"tme\"; did you mean \"time\"?");
}

TEST_F(TimedParams, MustBeAskedFor) {
  const Value value = object({{"a", text("time")}});
  Params params(value, "thing", diagnostics_);
  EXPECT_EQ(params.real("a", 1, any_range, ""), 1);
  EXPECT_EQ(message(), "\"a\" of thing: expected a number, found text");
  EXPECT_FALSE(scope_.was_read());
}

TEST(TimedParamInfos, SayThatTheyTakeTime) {
  std::vector<ParamInfo> infos;
  Params params(infos);
  params.real("before", 0, any_range, "");
  params.allow_time();
  params.real("number", 0, any_range, "");
  params.integer("whole", 0, any_range, "");
  ASSERT_EQ(infos.size(), 3u);
  EXPECT_FALSE(infos[0].takes_time);
  EXPECT_TRUE(infos[1].takes_time);
  EXPECT_FALSE(infos[2].takes_time);
}

}  // namespace
}  // namespace meristem
