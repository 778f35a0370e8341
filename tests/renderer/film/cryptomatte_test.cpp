#include "renderer/film/cryptomatte.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace meristem::cryptomatte {
namespace {

// Published test vectors of MurmurHash3_x86_32 with the seed 0.
TEST(Cryptomatte, HashesAreMurmur3) {
  EXPECT_EQ(murmur_hash_3(""), 0u);
  EXPECT_EQ(murmur_hash_3("test"), 0xba6bd213u);
  EXPECT_EQ(murmur_hash_3("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(murmur_hash_3("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
}

TEST(Cryptomatte, NoHashIsAnInvalidFloat) {
  int flipped = 0;
  for (int i = 0; i < 5000; ++i) {
    const std::string name = "object " + std::to_string(i);
    const float value = std::bit_cast<float>(name_hash(name));
    EXPECT_TRUE(std::isnormal(value)) << name;
    flipped += name_hash(name) != murmur_hash_3(name);
  }
  EXPECT_GT(flipped, 10);  // 2 of 256 exponents
}

TEST(Cryptomatte, RanksAreSortedByCoverageAndCutOff) {
  const std::vector<std::string> names{"a", "b", "c"};
  const std::vector<std::uint32_t> hashes = name_hashes(names);
  float out[4] = {9, 9, 9, 9};
  write_ranks({{0, 2}, {1, 5}, {2, 1}}, hashes, 8, 1, out);
  EXPECT_EQ(out[0], std::bit_cast<float>(hashes[1]));
  EXPECT_EQ(out[1], 5.0f / 8);
  EXPECT_EQ(out[2], std::bit_cast<float>(hashes[0]));
  EXPECT_EQ(out[3], 2.0f / 8);
  write_ranks({{2, 8}}, hashes, 8, 1, out);
  EXPECT_EQ(out[1], 1);
  EXPECT_EQ(out[2], 0);
  EXPECT_EQ(out[3], 0);
}

TEST(Cryptomatte, MetadataIsWhatReadersLookFor) {
  const Metadata m = metadata("crypto_object", {"oak", "a \"b\"", "oak"});
  ASSERT_EQ(m.size(), 4u);
  const std::string key = "cryptomatte/f834d0a/";  // as in files of other renderers
  EXPECT_EQ(metadata("crypto_material", {})[0].first, "cryptomatte/bda530a/name");
  EXPECT_EQ(m[0], (std::pair<std::string, std::string>{key + "name", "crypto_object"}));
  EXPECT_EQ(m[1], (std::pair<std::string, std::string>{key + "hash", "MurmurHash3_32"}));
  EXPECT_EQ(m[2], (std::pair<std::string, std::string>{key + "conversion", "uint32_to_float32"}));
  char oak[9];
  std::snprintf(oak, sizeof oak, "%08x", name_hash("oak"));
  EXPECT_NE(m[3].second.find(std::string("\"oak\":\"") + oak + "\""), std::string::npos) << m[3].second;
  EXPECT_NE(m[3].second.find("\"a \\\"b\\\"\":"), std::string::npos) << m[3].second;
  EXPECT_EQ(channel_names("crypto_object", 2)[5], "crypto_object01.G");
}

}  // namespace
}  // namespace meristem::cryptomatte
