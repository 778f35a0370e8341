// Text from strangers: whatever the bytes, reading ends, says something and touches nothing outside.
#include "messages.h"

#include "geometry/base/key.h"
#include "renderer/language/json_writer.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

using namespace testing;

const std::string sample = R"jsonc(// A branch
{
  "format": 1,
  "materials": { "bark": { "type": "openpbr", "base_color": "mix([.32,.23,.15], [.18,.12,.08], fbm(8*P))" } },
  "models": { "branch": { "base": { "type": "prism", "sides": 8, }, "steps": [
    { "grow": 5, "rules": {
        "shoot(len)": [ { "weight": 2e0, "if": "len < \u0030.9", "on": true, "off": null } ] } }, /* smooth */
    { "subdivide": -2 } ] } },
}
)jsonc";

// Reads, and asks for everything a caller may ask for.
std::size_t error_count(std::string text) {
  Diagnostics diagnostics;
  const Value value = read_jsonc(source_of(std::move(text)), diagnostics);
  (void)to_json(value);
  for (const Diagnostic& d : diagnostics.list()) EXPECT_FALSE(d.formatted().empty());
  EXPECT_LE(diagnostics.list().size(), 200u);
  return diagnostics.list().size();
}

std::string repeated(const std::string& part, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += part;
  return result;
}

TEST(HostileInput, TheSampleItselfIsGood) { EXPECT_EQ(error_count(sample), 0u); }

TEST(HostileInput, FilesCutShortAnywhere) {
  const std::size_t end = sample.rfind('}');
  for (std::size_t length = 0; length <= end; ++length) EXPECT_GT(error_count(sample.substr(0, length)), 0u) << length;
}

TEST(HostileInput, AnyByteReplacedByAnyOther) {
  for (std::size_t at = 0; at < sample.size(); ++at)
    for (const char c :
         {'\0', '"', '\'', '{', '}', '[', ']', ',', ':', '/', '*', '\\', '\n', '0', '-', '#', '\x7f', '\x80', '\xff'}) {
      std::string text = sample;
      text[at] = c;
      error_count(text);
    }
}

TEST(HostileInput, RandomBytesAndRandomTokens) {
  const std::string tokens[] = {"{",    "}", "[",  "]",  ",",  ":",  "\"a\"", "\"b\"", "1", "tru",
                                "null", "'", "\"", "//", "/*", "*/", "\n",    "\\u",   "=", "-"};
  for (Key k = 0; k < 3000; ++k) {
    std::string bytes, words;
    for (Key i = 0; i < 40; ++i) {
      bytes += char(hash_keys(k, i) & 0xff);
      words += tokens[hash_keys(k, i, 1) % std::size(tokens)];
    }
    error_count(bytes);
    error_count(words);
  }
}

TEST(HostileInput, DeepNesting) {
  EXPECT_EQ(error_count(std::string(100'000, '[')), 1u);
  EXPECT_EQ(error_count(repeated("{\"a\":", 100'000)), 1u);
  EXPECT_EQ(error_count(repeated("[{\"a\":", 100'000)), 1u);
}

TEST(HostileInput, ManyMistakes) {
  error_count("[" + repeated("tru ", 100'000) + "]");
  error_count("{" + repeated("\"a\": 1, ", 100'000) + "}");
  error_count("\"" + repeated("\\x", 30'000) + "\"");
  error_count(repeated("#", 100'000));
}

TEST(HostileInput, ManyValues) {
  EXPECT_EQ(error_count("[" + repeated("0,", int(JsoncLimits::values) + 10) + "]"), 1u);
}

TEST(HostileInput, ManyKeysTakeNoQuadraticTime) {
  std::string text = "{";
  for (int i = 0; i < 200'000; ++i) text += "\"k" + std::to_string(i) + "\":0,";
  EXPECT_EQ(error_count(text + "}"), 0u);
}

TEST(HostileInput, TooLargeAFile) { EXPECT_EQ(error_count(std::string(JsoncLimits::file_bytes + 1, ' ')), 1u); }

TEST(HostileInput, TerminalSequencesAreNotPassedOn) {
  Diagnostics diagnostics;
  read_jsonc(source_of("{\"\\u001b[2J\": 1, \"\\u001b[2J\": 2}"), diagnostics);
  ASSERT_EQ(diagnostics.list().size(), 1u);
  EXPECT_EQ(diagnostics.list()[0].formatted().find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace meristem
