#include "geometry/base/value.h"
#include "values.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

using namespace testing;

TEST(Value, FindsMembersByKey) {
  const Value v = object({{"a", number(1)}, {"b", text("two")}});
  ASSERT_NE(v.find("b"), nullptr);
  EXPECT_EQ(v.find("b")->text, "two");
  EXPECT_EQ(v.find("c"), nullptr);
  EXPECT_EQ(number(1).find("a"), nullptr);
}

TEST(Value, NamesItsKind) {
  EXPECT_STREQ(Value{}.kind_name(), "null");
  EXPECT_STREQ(boolean(true).kind_name(), "true");
  EXPECT_STREQ(number(1).kind_name(), "a number");
  EXPECT_STREQ(text("").kind_name(), "text");
  EXPECT_STREQ(array({}).kind_name(), "an array");
  EXPECT_STREQ(object({}).kind_name(), "an object");
}

// The column, from 1, of byte `offset` of a text that stands as `raw` at the start of a file.
int column_in(const std::string& raw, std::size_t offset) {
  Value v = text("");
  v.location = {std::make_shared<SourceText>(SourceText{"x", raw}), 0};
  return text_location(v, offset).column();
}

TEST(TextLocation, CountsEscapes) {
  EXPECT_EQ(column_in(R"("abc")", 0), 2);
  EXPECT_EQ(column_in(R"("abc")", 2), 4);
  EXPECT_EQ(column_in(R"("\n\"c")", 2), 6);           // two escapes of two bytes
  EXPECT_EQ(column_in(R"("\u0041b")", 1), 8);         // one byte of text
  EXPECT_EQ(column_in(R"("\u00e4b")", 2), 8);         // two
  EXPECT_EQ(column_in(R"("\u20acb")", 3), 8);         // three
  EXPECT_EQ(column_in(R"("\ud83c\udf33b")", 4), 14);  // four, from a surrogate pair
}

TEST(TextLocation, StaysInsideTheFile) {
  EXPECT_EQ(column_in(R"("ab)", 99), 4);
  EXPECT_EQ(column_in("\"\\", 99), 3);
  EXPECT_EQ(text_location(text("made in code"), 3).source, nullptr);
}

}  // namespace
}  // namespace meristem
