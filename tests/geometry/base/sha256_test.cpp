#include "geometry/base/sha256.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// The examples that NIST publishes with FIPS 180-4, and the million of "a" of the same page.
TEST(Sha256, StandardVectors) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, PiecesGiveTheSameDigestAsTheWhole) {
  for (std::size_t length : {55u, 56u, 57u, 63u, 64u, 65u, 119u, 120u, 128u, 200u}) {
    const std::string text(length, 'x');
    for (std::size_t cut : {std::size_t(0), std::size_t(1), length / 2, length}) {
      Sha256 pieces;
      pieces.update(text.data(), cut);
      pieces.update(text.data() + cut, length - cut);
      EXPECT_EQ(pieces.finish(), sha256(text)) << length << " bytes cut at " << cut;
    }
  }
}

}  // namespace
}  // namespace meristem
