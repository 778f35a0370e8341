// What the user is told, where; and that no text, however hostile, does harm.
#include "tests/geometry/fields/expression_support.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

using namespace test;

struct Mistake {
  const char* text;
  const char* message;
  std::size_t offset, length;
};

void PrintTo(const Mistake& m, std::ostream* out) { *out << m.text; }

class Errors : public testing::TestWithParam<Mistake> {};

TEST_P(Errors, NamePlaceAndRemedy) {
  const Mistake& m = GetParam();
  try {
    Expression::compile(m.text, variables(), ValueType::Scalar);
    FAIL() << "compiled: " << m.text;
  } catch (const ExpressionError& e) {
    EXPECT_STREQ(e.what(), m.message);
    EXPECT_EQ(e.offset, m.offset) << m.text;
    EXPECT_EQ(e.length, m.length) << m.text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Errors,
    testing::Values(
        Mistake{"1 + leng", "unknown variable \"leng\"; known: x, y, z, P, N", 4, 4},
        Mistake{"scale = 2; 3 * scal", "unknown variable \"scal\"; did you mean \"scale\"?", 15, 4},
        Mistake{"fbn(P)", "unknown function \"fbn\"; did you mean \"fbm\"?", 0, 3},
        Mistake{"qwertz(P)", "unknown function \"qwertz\"", 0, 6},
        Mistake{"1 + clamp(x, 2)", "clamp takes 3 arguments, not 2: clamp(x, lo, hi)", 4, 5},
        Mistake{"min(x)", "min takes at least 2 arguments, not 1: min(a, b, ...)", 0, 3},
        Mistake{"fbm()", "fbm takes 1 to 4 arguments, not 0: fbm(v, octaves=6, lacunarity=2, gain=0.5)", 0, 3},
        Mistake{"sqrt()", "sqrt takes 1 argument, not 0: sqrt(x)", 0, 4},
        Mistake{"2 * (x + 1", "expected ')' for the '(' at column 5, not the end of the expression", 10, 1},
        Mistake{"sin(x", "expected ')' for the '(' of sin at column 4, not the end of the expression", 5, 1},
        Mistake{"x + ", "expected a value, not the end of the expression", 4, 1},
        Mistake{"x + * y", "expected a value, not '*'", 4, 1},
        Mistake{"x y", "expected an operator or the end, not 'y'", 2, 1},
        Mistake{"fbm(x)", "argument 1 must be a vector, not a scalar: fbm(v, octaves=6, lacunarity=2, gain=0.5)", 4, 1},
        Mistake{"hypot(1, 2*P)", "argument 2 must be a scalar, not a vector: hypot(x, y)", 9, 3},
        Mistake{"fbm(P, x)", "argument 2 must be a constant: fbm(v, octaves=6, lacunarity=2, gain=0.5)", 7, 1},
        Mistake{"fbm(P, 2.5)", "the number of octaves must be a whole number from 1 to 16, not 2.5", 7, 3},
        Mistake{"x + 2*P", "the result must be a scalar, not a vector; one component is v[0], the length is length(v)",
                0, 7},
        Mistake{"x < P", "an operand of '<' must be a scalar, not a vector", 4, 1},
        Mistake{"P ? 1 : 2", "a condition must be a scalar, not a vector", 0, 1},
        Mistake{"x[0]", "only a vector has components; this is a scalar", 0, 1},
        Mistake{"P[3]", "an index must be 0, 1 or 2", 2, 1},
        Mistake{"[1, 2](3)", "expected ',' between the three components of a vector, not ']'", 5, 1},
        Mistake{"a = 3", "expected ';' after an assignment, not the end of the expression", 5, 1},
        Mistake{"x ? 1", "expected ':' between the two values of '?', not the end of the expression", 5, 1},
        Mistake{"sin + 1", "\"sin\" is a function: sin(x)", 0, 3}, Mistake{"x @ 2", "'@' has no meaning here", 2, 1},
        Mistake{"1e99", "the number is too large; the largest is 3.4e38", 0, 4},
        Mistake{"noise(P, 1, 2)", "a noise at a vector takes one scalar more, a time, and nothing else", 12, 1},
        Mistake{"snoise(x, P)", "a noise takes one vector, a vector and a scalar, or one to four scalars", 10, 1},
        Mistake{"snoise(P, P)", "a noise takes one vector, a vector and a scalar, or one to four scalars", 10, 1},
        Mistake{"cellnoise(P, 1)", "a cell noise at a vector takes no further argument", 13, 1},
        Mistake{"cellnoise(1, P)", "a cell noise takes one vector, or one to three scalars", 13, 1},
        Mistake{"snoise4(P)", "snoise4 takes 2 arguments, not 1: snoise4(v, t)", 0, 7},
        Mistake{"pnoise(P, 2)", "argument 2 must be a vector, not a scalar: pnoise(v, period)", 10, 1},
        Mistake{"fbm4(P, x, 17)", "the number of octaves must be a whole number from 1 to 16, not 17", 11, 2},
        Mistake{"if (x) { a = 1; } else { a = P; } 1", "\"a\" is a scalar in one branch and a vector in the other", 0,
                2},
        Mistake{"if (x) { b = 1; } b", "unknown variable \"b\"; known: x, y, z, P, N", 18, 1},
        Mistake{"", "expected a value, not the end of the expression", 0, 1}));

std::string message_of(const std::string& text) {
  try {
    Expression::compile(text, variables(), ValueType::Scalar);
  } catch (const ExpressionError& e) {
    EXPECT_LE(e.offset, text.size());
    return e.what();
  }
  return "";
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST(Limits, AreNamed) {
  const std::string nested = "nested more than 200 deep";
  EXPECT_EQ(message_of(repeated("(", 30000)), nested);
  EXPECT_EQ(message_of(repeated("[", 30000)), nested);
  EXPECT_EQ(message_of(repeated("-", 30000) + "x"), nested);
  EXPECT_EQ(message_of(repeated("x^", 30000) + "x"), nested);
  EXPECT_EQ(message_of(repeated("sin(", 15000)), nested);
  EXPECT_EQ(message_of(repeated("x?", 30000)), nested);
  EXPECT_EQ(message_of(repeated("P[", 30000)), nested);
  EXPECT_EQ(message_of(repeated("if(x){", 10000)), nested);
  EXPECT_EQ(message_of("if(x){}" + repeated("else if(x){}", 5000)), nested);
  EXPECT_EQ(message_of(repeated("x+", 40000) + "x"), "the expression is longer than 65536 bytes");
  std::string large = "a=x;";
  for (int i = 0; i < 6000; ++i) large += "a=a*x+y;";
  EXPECT_EQ(message_of(large + "a"), "the expression has more than 10000 operations");
}

TEST(Limits, AllowWhatLiesWithin) {
  EXPECT_EQ(message_of(repeated("(", 150) + "x" + repeated(")", 150)), "");
  EXPECT_EQ(message_of(repeated("1+", 9000) + "1"), "");
  EXPECT_EQ(message_of(repeated(" ", 65535) + "1"), "");
  EXPECT_EQ(value("1e-99"), 0);
}

// Pieces of the language thrown together: either an error within the text, or an expression that can be evaluated.
TEST(Limits, HoldForRandomTexts) {
  static constexpr const char* pieces[] = {"x",      "P",  "(",    ")", "[",  "]",  ",",      "+",     "*",    "^",
                                           "-",      "?",  ":",    "=", ";",  "a",  "1",      "1e38",  "sin(", "fbm(",
                                           "noise(", "if", "else", "{", "}",  "->", "curve(", "rand(", "0",    "#",
                                           "\n",     "$",  "\xff", "E", "==", "&&", "mix("};
  std::mt19937 random(17);
  const Points points(9);
  int compiled = 0;
  for (int i = 0; i < 30000; ++i) {
    std::string text;
    for (auto n = 1 + random() % 9; n > 0; --n) text += pieces[random() % std::size(pieces)];
    try {
      evaluate(text, points, ValueType::Vector);
      ++compiled;
    } catch (const ExpressionError& e) {
      ASSERT_LE(e.offset, text.size()) << text;
    }
  }
  EXPECT_GT(compiled, 300);
}

}  // namespace
}  // namespace meristem
