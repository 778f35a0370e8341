// Packed origins are what was put in.
#include "geometry/mesh/face_origins.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// Of a few kinds, in runs, with keys of their own.
std::vector<FaceOrigin> some_origins(std::size_t count) {
  std::vector<FaceOrigin> origins(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Key kind = hash_keys(1, i / 5) % 30;
    origins[i] = {hash_keys(2, i), std::int32_t(kind % 3), std::int16_t(kind % 4), std::uint16_t(kind % 5), {}};
    origins[i].parameters[kind % max_growth_parameters] = float(kind);
  }
  return origins;
}

void expect_equal(const FaceOrigins& packed, const std::vector<FaceOrigin>& origins, std::size_t first = 0) {
  ASSERT_EQ(packed.size(), first + origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) EXPECT_EQ(packed[first + i], origins[i]);
}

TEST(FaceOrigins, GiveBackWhatWasPutIn) {
  expect_equal(FaceOrigins(), {});
  const auto origins = some_origins(1000);
  FaceOrigins packed(origins);
  expect_equal(packed, origins);
  EXPECT_LT(packed.bytes(), 1000 * sizeof(FaceOrigin) / 2);
  EXPECT_EQ(packed.add(origins[7]), 1000u);
  EXPECT_EQ(packed[1000], origins[7]);
}

TEST(FaceOrigins, AppendOthersBehind) {
  const auto origins = some_origins(100);
  FaceOrigins packed(some_origins(50));
  packed.append(FaceOrigins(origins));
  expect_equal(packed, origins, 50);
}

}  // namespace
}  // namespace meristem
