#include "geometry/base/process_memory.h"

#include <gtest/gtest.h>

#include <vector>

namespace meristem {
namespace {

TEST(ProcessMemory, TheResidentSetGrowsWithWhatIsTouched) {
  constexpr std::size_t bytes = std::size_t(64) << 20;
  const std::size_t before = resident_set_bytes();
  EXPECT_GT(before, 0u);
  const std::vector<char> touched(bytes, 1);
  EXPECT_GT(resident_set_bytes(), before + bytes / 2);
}

}  // namespace
}  // namespace meristem
