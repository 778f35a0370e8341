#include "geometry/base/source.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

Location at(const std::string& text, std::size_t offset) {
  return {std::make_shared<SourceText>(SourceText{"scene.jsonc", text}), offset};
}

std::string error_at(const std::string& text, std::size_t offset) {
  return Diagnostic{Diagnostic::Severity::Error, at(text, offset), "wrong"}.formatted();
}

TEST(Location, CountsLinesAndColumnsFromOne) {
  const Location begin = at("ab\ncd\n", 0), newline = begin.advanced(2), second = begin.advanced(4),
                 end = begin.advanced(6);
  EXPECT_EQ(begin.line(), 1);
  EXPECT_EQ(begin.column(), 1);
  EXPECT_EQ(newline.line(), 1);
  EXPECT_EQ(newline.column(), 3);
  EXPECT_EQ(second.line(), 2);
  EXPECT_EQ(second.column(), 2);
  EXPECT_EQ(end.line(), 3);
  EXPECT_EQ(end.column(), 1);
}

TEST(Location, BeyondTheTextIsItsEnd) {
  EXPECT_EQ(at("ab\ncd", 99).line(), 2);
  EXPECT_EQ(at("ab\ncd", 99).column(), 3);
}

TEST(Location, NowhereIsLineZero) {
  EXPECT_EQ(Location{}.line(), 0);
  EXPECT_EQ(Location{}.column(), 0);
}

TEST(Diagnostic, ShowsPlaceLineAndCaret) {
  EXPECT_EQ(error_at("{\n  \"sprad\": 4,\n}", 4), "scene.jsonc:2:3: error: wrong\n    \"sprad\": 4,\n    ^");
  EXPECT_EQ(error_at("", 0), "scene.jsonc:1:1: error: wrong\n  \n  ^");
}

TEST(Diagnostic, WithoutPlaceIsOneLine) {
  EXPECT_EQ((Diagnostic{Diagnostic::Severity::Warning, {}, "odd"}.formatted()), "warning: odd");
}

TEST(Diagnostic, CaretFollowsTabsAndCharactersOfSeveralBytes) {
  EXPECT_EQ(error_at("\t\"grün\": x", 10), "scene.jsonc:1:11: error: wrong\n  \t\"grün\": x\n  \t        ^");
}

TEST(Diagnostic, LeavesOutTheCarriageReturn) {
  EXPECT_EQ(error_at("ab\r\ncd", 1), "scene.jsonc:1:2: error: wrong\n  ab\n   ^");
}

TEST(Diagnostic, ShowsAWindowOfALongLine) {
  const std::string text = error_at(std::string(5000, 'a') + "!" + std::string(5000, 'b'), 5000);
  EXPECT_LT(text.size(), 400u);
  const std::size_t mark = text.find('!'), line = text.find("  ..."), caret_line = text.rfind('\n') + 1;
  ASSERT_NE(mark, std::string::npos);
  EXPECT_EQ(text.find('^') - caret_line, mark - line);
}

TEST(Diagnostic, DoesNotPassControlCharactersOn) {
  EXPECT_EQ(error_at("\x1b[2J", 0), "scene.jsonc:1:1: error: wrong\n  \\u001b[2J\n  ^");
}

TEST(Diagnostics, ThrowsAllErrorsSortedByPlace) {
  Diagnostics diagnostics;
  const Location begin = at("abc", 0);
  diagnostics.error(begin.advanced(2), "third");
  diagnostics.error(begin, "first");
  diagnostics.warning(begin.advanced(1), "second");
  try {
    diagnostics.throw_if_errors();
    FAIL() << "nothing was thrown";
  } catch (const SceneErrors& errors) {
    ASSERT_EQ(errors.list().size(), 3u);
    EXPECT_EQ(errors.list()[0].message, "first");
    EXPECT_EQ(errors.list()[1].message, "second");
    EXPECT_EQ(errors.list()[2].message, "third");
    EXPECT_NE(std::string(errors.what()).find("scene.jsonc:1:3: error: third"), std::string::npos);
  }
}

TEST(Diagnostics, WarningsAloneAreNoErrors) {
  Diagnostics diagnostics;
  diagnostics.warning({}, "odd");
  EXPECT_FALSE(diagnostics.has_errors());
  EXPECT_NO_THROW(diagnostics.throw_if_errors());
  EXPECT_EQ(diagnostics.list().size(), 1u);
}

TEST(Diagnostics, WhatIsFoundAgainIsSaidOnce) {
  Diagnostics diagnostics;
  const Location begin = at("abc", 0);
  for (int i = 0; i < 3; ++i) diagnostics.warning(begin, "odd");
  diagnostics.warning(begin.advanced(1), "odd");
  diagnostics.warning(begin, "strange");
  EXPECT_EQ(diagnostics.list().size(), 3u);
  for (int i = 0; i < 3; ++i) diagnostics.error(begin, "odd");
  EXPECT_EQ(diagnostics.list().size(), 4u) << "as an error once more";
  EXPECT_EQ(diagnostics.errors_found(), 3u);
  EXPECT_EQ(diagnostics.found(), 8u);
}

TEST(Diagnostics, StopsListingAfterTooManyAndSaysSo) {
  Diagnostics diagnostics;
  for (int i = 0; i < 100000; ++i) diagnostics.warning({}, "odd" + std::to_string(i));
  EXPECT_FALSE(diagnostics.has_errors());
  for (int i = 0; i < 100000; ++i) diagnostics.error({}, "wrong" + std::to_string(i));
  EXPECT_EQ(diagnostics.errors_found(), 100000u);
  EXPECT_TRUE(diagnostics.has_errors());
  EXPECT_LE(diagnostics.list().size(), 200u);
  EXPECT_EQ(diagnostics.list().back().message, "too many errors; the others are not listed");
}

TEST(NearestName, FindsSlipsOfTheFinger) {
  const std::vector<std::string> names{"fern", "grass", "oak", "leaf_length", "scatter"};
  EXPECT_EQ(nearest_name("fren", names), "fern");  // two letters swapped
  EXPECT_EQ(nearest_name("gras", names), "grass");
  EXPECT_EQ(nearest_name("leaf_lenght", names), "leaf_length");
  EXPECT_EQ(nearest_name("Scatter", names), "scatter");
  EXPECT_EQ(nearest_name("oak", names), "oak");
}

TEST(NearestName, FindsNothingWhenMoreThanAThirdDiffers) {
  const std::vector<std::string> plants{"fern", "oak"}, none;
  EXPECT_EQ(nearest_name("pine", plants), "");
  EXPECT_EQ(nearest_name("", plants), "");
  EXPECT_EQ(nearest_name("fern", none), "");
  EXPECT_EQ(nearest_name(std::string(1000, 'f'), plants), "");
}

}  // namespace
}  // namespace meristem
