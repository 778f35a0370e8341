// Params::scalar_expression and vector_expression: how a scene file may write an expression, and where errors point.
#include "geometry/base/params.h"
#include "geometry/fields/expression.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

Value text(std::string s, Location location = {}) {
  Value v;
  v.kind = Value::Kind::Text;
  v.text = std::move(s);
  v.location = std::move(location);
  return v;
}

Value number(double x) {
  Value v;
  v.kind = Value::Kind::Number;
  v.number = x;
  return v;
}

Value array(std::vector<Value> items) {
  Value v;
  v.kind = Value::Kind::Array;
  v.items = std::move(items);
  return v;
}

class ParamsExpressionTest : public ::testing::Test {
 protected:
  ParamsExpressionTest() { symbols_.add("len", ValueType::Scalar); }

  // Reads { "value": written } and evaluates it with len = 2.
  float scalar(Value written) {
    Value object = object_of(std::move(written));
    Params params(object, "rule", diagnostics_);
    const Vec3f len(2);
    return params.scalar_expression("value", "7", symbols_, "")->evaluate_scalar({&len, 1});
  }
  Vec3f vector(Value written) {
    Value object = object_of(std::move(written));
    Params params(object, "rule", diagnostics_);
    const Vec3f len(2);
    return params.vector_expression("value", "[7, 8, 9]", symbols_, "")->evaluate_vector({&len, 1});
  }
  std::string message() const { return diagnostics_.list().empty() ? "" : diagnostics_.list()[0].message; }

  static Value object_of(Value written) {
    Value object;
    object.kind = Value::Kind::Object;
    object.members.push_back({"value", {}, std::move(written)});
    return object;
  }

  Symbols symbols_;
  Diagnostics diagnostics_;
};

TEST_F(ParamsExpressionTest, ReadsTextAndNumbers) {
  EXPECT_EQ(scalar(text("len*0.5 + 1")), 2);
  EXPECT_EQ(scalar(number(-0.25)), -0.25f);
  EXPECT_EQ(scalar(number(1e-20)), 1e-20f);
  EXPECT_EQ(scalar(number(1e20)), 1e20f);
  EXPECT_EQ(vector(text("[len, 2*len, 1]")), Vec3f(2, 4, 1));
  EXPECT_EQ(vector(number(0.5)), Vec3f(0.5f));
  EXPECT_EQ(message(), "");
}

TEST_F(ParamsExpressionTest, ReadsTriplesOfNumbersAndExpressions) {
  EXPECT_EQ(vector(array({number(-1), text("len + 1"), number(0)})), Vec3f(-1, 3, 0));
  EXPECT_EQ(message(), "");
}

TEST_F(ParamsExpressionTest, GoesOnWithTheDefaultAfterAnError) {
  EXPECT_EQ(scalar(text("lne")), 7);
  EXPECT_EQ(vector(text("lne")), Vec3f(7, 8, 9));
  EXPECT_EQ(vector(array({number(1), text("lne"), number(0)})), Vec3f(7, 8, 9));
  EXPECT_EQ(diagnostics_.errors_found(), 3u);
}

TEST_F(ParamsExpressionTest, ReportsWrongForms) {
  scalar(array({}));
  EXPECT_EQ(message(), "\"value\" of rule: expected a number or an expression as text, found an array of 0");
  vector(array({number(1), number(2)}));
  EXPECT_EQ(diagnostics_.list()[1].message,
            "\"value\" of rule: expected an expression as text, a number, or three of them as [x, y, z], "
            "found an array of 2");
}

TEST_F(ParamsExpressionTest, APartCannotCloseTheTriple) {
  EXPECT_EQ(vector(array({text("1), (2"), number(1), number(1)})), Vec3f(7, 8, 9));
  EXPECT_TRUE(diagnostics_.has_errors());
}

TEST_F(ParamsExpressionTest, ErrorsPointIntoTheUsersText) {
  // An escape of two bytes stands before the unknown name
  const auto source = std::make_shared<SourceText>(SourceText{"s", R"("1 +\n lne")"});
  scalar(text("1 +\n lne", {source, 0}));
  ASSERT_EQ(diagnostics_.list().size(), 1u);
  EXPECT_EQ(diagnostics_.list()[0].location.column(), 8);
}

TEST_F(ParamsExpressionTest, DescribesTheDefault) {
  std::vector<ParamInfo> infos;
  Params params(infos);
  params.scalar_expression("a", "0.5", symbols_, "");
  params.scalar_expression("b", "2*len", symbols_, "");
  params.vector_expression("c", "[1, 2, 3]", symbols_, "");
  EXPECT_EQ(infos[0].default_text, "0.5");
  EXPECT_EQ(infos[1].default_text, "\"2*len\"");
  EXPECT_EQ(infos[2].default_text, "\"[1, 2, 3]\"");
  EXPECT_EQ(infos[1].type, ParamInfo::Type::ScalarExpression);
}

}  // namespace
}  // namespace meristem
