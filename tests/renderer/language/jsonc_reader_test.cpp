#include "renderer/language/jsonc_reader.h"

#include "messages.h"
#include "renderer/language/json_writer.h"

#include <gtest/gtest.h>

#include <limits>

namespace meristem {
namespace {

using namespace testing;

struct Outcome {
  Value value;
  std::string messages;
};

Outcome read(std::string text) {
  Diagnostics diagnostics;
  Value value = read_jsonc(source_of(std::move(text)), diagnostics);
  return {std::move(value), messages_of(diagnostics)};
}

Value read_well(std::string text) {
  Outcome o = read(std::move(text));
  EXPECT_EQ(o.messages, "");
  return std::move(o.value);
}

std::string errors_of(std::string text) { return read(std::move(text)).messages; }

TEST(JsoncReader, ReadsEveryKindOfValue) {
  EXPECT_EQ(to_json(read_well(R"({"a": null, "b": [true, false], "c": "text", "d": {}, "e": [], "f": -1.5e2})")),
            R"({ "a": null, "b": [true, false], "c": "text", "d": {}, "e": [], "f": -150 })");
  EXPECT_EQ(read_well("7").number, 7);
}

TEST(JsoncReader, AllowsCommentsAndTrailingCommas) {
  const Value v = read_well("// head\n{ /* one */ \"a\": [1, 2, /**/ ], // two\n \"b\": 1, } // end");
  EXPECT_EQ(to_json(v), R"({ "a": [1, 2], "b": 1 })");
}

TEST(JsoncReader, KeepsThePlaceOfEveryKeyAndValue) {
  const Value v = read_well("{\n  \"spread\": 40,\n  \"up\": [0,\n    \"x\"]\n}");
  EXPECT_EQ(v.location.offset, 0u);
  EXPECT_EQ(v.members[0].key_location.line(), 2);
  EXPECT_EQ(v.members[0].key_location.column(), 3);
  EXPECT_EQ(v.members[0].value.location.column(), 13);
  EXPECT_EQ(v.find("up")->items[1].location.line(), 4);
  EXPECT_EQ(v.find("up")->items[1].location.column(), 5);
}

TEST(JsoncReader, ReadsNumbersToTheNearestDouble) {
  EXPECT_EQ(read_well("0.1").number, 0.1);
  EXPECT_EQ(read_well("-0").number, 0.0);
  EXPECT_EQ(read_well("9007199254740993").number, 9007199254740992.0);
  EXPECT_EQ(read_well("1.7976931348623157e308").number, std::numeric_limits<double>::max());
  EXPECT_EQ(read_well("2.2250738585072014E-308").number, std::numeric_limits<double>::min());
  EXPECT_EQ(read_well("1" + std::string(300, '0')).number, 1e300);
}

TEST(JsoncReader, RefusesWhatIsNoNumber) {
  for (const char* text : {"01", "+1", ".5", "5.", "1e", "1e+", "0x10", "--1", "1.2.3", "-", "1_000", "-NaN"})
    EXPECT_EQ(errors_of(text),
              "1:1: \"" + std::string(text) + "\" is not a number; expected one as 12, -0.5 or 1e-3\n");
}

TEST(JsoncReader, RefusesNumbersThatDoNotFit) {
  EXPECT_EQ(errors_of("[1e999, -1e999]"),
            "1:2: 1e999 is too large or too small for a number\n1:9: -1e999 is too large or too small for a number\n");
  EXPECT_EQ(errors_of(std::string(100000, '9')),
            "1:1: " + std::string(40, '9') + "... is too large or too small for a number\n");
}

TEST(JsoncReader, DecodesEscapes) {
  EXPECT_EQ(read_well(R"("\"\\\/\b\f\n\r\t")").text, "\"\\/\b\f\n\r\t");
  EXPECT_EQ(read_well(R"("\u0041\u00e4\u20ac\ud83c\udf33")").text, "A\u00e4\u20ac\U0001f333");
  EXPECT_EQ(read_well("\"gr\u00fcn\"").text, "gr\u00fcn");
}

TEST(JsoncReader, RefusesBadEscapesAndGoesOn) {
  const Outcome o = read(R"(["\x41", "\u12g4", "\ud83c", "\udf33\ud83c", "\ud83c\u0041", "\u0000", "good"])");
  EXPECT_EQ(
      o.messages,
      "1:3: unknown escape; expected \\\", \\\\, \\/, \\b, \\f, \\n, \\r, \\t or \\u and four hexadecimal digits\n"
      "1:11: expected four hexadecimal digits after \\u\n"
      "1:21: half of a surrogate pair; write both halves, as in \\ud83c\\udf33, or the character itself\n"
      "1:31: half of a surrogate pair; write both halves, as in \\ud83c\\udf33, or the character itself\n"
      "1:37: half of a surrogate pair; write both halves, as in \\ud83c\\udf33, or the character itself\n"
      "1:47: half of a surrogate pair; write both halves, as in \\ud83c\\udf33, or the character itself\n"
      "1:63: text cannot hold the character U+0000\n");
  EXPECT_EQ(o.value.items.back().text, "good");
}

TEST(JsoncReader, RefusesControlCharactersInText) {
  EXPECT_EQ(errors_of("\"a\tb\""), "1:3: a control character in text; write it as \\u0009\n");
  EXPECT_EQ(errors_of(std::string("\"a\0b\"", 5)), "1:3: a control character in text; write it as \\u0000\n");
  EXPECT_EQ(errors_of("\"a\nb\""), "1:1: this text has no closing quote on its line\n");
  EXPECT_EQ(errors_of("[\"a"), "1:2: this text has no closing quote on its line\n");
}

TEST(JsoncReader, RefusesWhatIsNotUtf8) {
  EXPECT_EQ(errors_of("{\n\"a\xff\": 1}"), "2:3: byte 0xff is not UTF-8; save the file in UTF-8\n");
  for (const char* bad :
       {"\xc0\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
        "\xf5\x80\x80\x80", "\xe2\x82", "\xf0\x9f\x8c", "\x80", "\xfe", "\xe2\x28\xa1"})
    EXPECT_NE(errors_of("// " + std::string(bad) + "\n1"), "") << int(std::uint8_t(bad[0]));
  for (const char* good :
       {"\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
    EXPECT_EQ(errors_of("// " + std::string(good) + "\n1"), "") << int(std::uint8_t(good[0]));
}

TEST(JsoncReader, SkipsAByteOrderMark) { EXPECT_EQ(read_well("\xef\xbb\xbf{}").location.offset, 3u); }

TEST(JsoncReader, ReportsRepeatedKeysAndKeepsTheFirst) {
  const Outcome o = read("{ \"a\": 1,\n  \"b\": 2,\n  \"a\": 3, \"a\": 4 }");
  EXPECT_EQ(o.messages,
            "3:3: the key \"a\" stands twice; first at line 1, column 3\n"
            "3:11: the key \"a\" stands twice; first at line 1, column 3\n");
  EXPECT_EQ(to_json(o.value), R"({ "a": 1, "b": 2 })");
}

TEST(JsoncReader, SeesThatEscapedKeysAreTheSame) {
  EXPECT_EQ(errors_of(R"({"a": 1, "\u0061": 2})"), "1:10: the key \"a\" stands twice; first at line 1, column 2\n");
}

TEST(JsoncReader, GoesOnAfterSlipsThatLeaveTheStructureClear) {
  const Outcome o = read(
      "{\n  \"a\": 1\n  \"b\": True,\n  c: 'x',\n  \"d\" 2,\n  \"e\" = 3,\n  \"f\": ,\n  \"g\": [1 2],\n  \"h\"\n}");
  EXPECT_EQ(o.messages,
            "2:9: expected ',' or '}' after this\n"
            "3:8: expected a value, found \"True\"; did you mean true?\n"
            "4:3: expected a key in double quotes: \"c\"\n"
            "4:6: expected double quotes, found '\n"
            "5:6: expected ':' and a value after the key \"d\"\n"
            "6:7: expected ':', found '='\n"
            "7:8: expected a value, found ','\n"
            "8:10: expected ',' or ']' after this\n"
            "9:6: expected ':' and a value after the key \"h\"\n");
  EXPECT_EQ(to_json(o.value), R"({ "a": 1, "b": null, "c": "x", "d": 2, "e": 3, "f": null, "g": [1, 2], "h": null })");
}

TEST(JsoncReader, SaysWhatWasExpectedWhereItStops) {
  EXPECT_EQ(errors_of(""), "1:1: nothing here; expected a scene: { \"format\": 1, ... }\n");
  EXPECT_EQ(errors_of("// nothing\n"), "2:1: nothing here; expected a scene: { \"format\": 1, ... }\n");
  EXPECT_EQ(errors_of("{} {}"), "1:4: expected the end of the file, found '{'\n");
  EXPECT_EQ(errors_of("[1}"), "1:3: expected ',' or ']', found '}'; the array begins at line 1, column 1\n");
  EXPECT_EQ(errors_of("{\"a\": 1]"), "1:8: expected ',' or '}', found ']'; the object begins at line 1, column 1\n");
  EXPECT_EQ(errors_of("{\n \"a\": [1,"),
            "2:10: the file ends inside the array that begins at line 2, column 7; expected ']'\n");
  EXPECT_EQ(errors_of("{5: 1}"), "1:2: expected a key in double quotes or '}', found \"5\"\n");
  EXPECT_EQ(errors_of("[@]"), "1:2: expected a value, found '@'\n");
  EXPECT_EQ(errors_of("[\u00fc]"), "1:2: expected a value, found '\u00fc'\n");
  EXPECT_EQ(errors_of("[1, /* x"), "1:5: this comment has no end; expected */\n");
  EXPECT_EQ(errors_of("# head\n[infinity]"),
            "1:1: a comment begins with //\n2:2: expected a value, found \"infinity\"; text takes double quotes\n");
}

TEST(JsoncReader, ShowsLineAndCaret) {
  Diagnostics diagnostics;
  read_jsonc(source_of("{\n  \"fov\": 35,\n  \"fov\": 40,\n}"), diagnostics);
  ASSERT_EQ(diagnostics.list().size(), 1u);
  EXPECT_EQ(diagnostics.list()[0].formatted(),
            "scene.jsonc:3:3: error: the key \"fov\" stands twice; first at line 2, column 3\n"
            "    \"fov\": 40,\n"
            "    ^");
}

TEST(JsoncReader, NestsSixtyFourDeepAndNoDeeper) {
  EXPECT_EQ(errors_of(std::string(64, '[') + std::string(64, ']')), "");
  EXPECT_EQ(errors_of(std::string(65, '[') + std::string(65, ']')),
            "1:65: more than 64 arrays and objects inside each other\n");
}

TEST(JsoncReader, BoundsTextsAndKeys) {
  const std::size_t most = JsoncLimits::text_bytes, key_most = JsoncLimits::key_bytes;
  EXPECT_EQ(errors_of('"' + std::string(most, 'a') + '"'), "");
  EXPECT_EQ(errors_of('"' + std::string(most + 1, 'a') + '"'), "1:1: this text is longer than 65536 bytes\n");
  EXPECT_EQ(errors_of("{\"" + std::string(key_most, 'a') + "\": 1}"), "");
  EXPECT_EQ(errors_of("{\"" + std::string(key_most + 1, 'a') + "\": 1}"), "1:2: this text is longer than 1024 bytes\n");
}

}  // namespace
}  // namespace meristem
