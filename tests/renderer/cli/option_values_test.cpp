#include "renderer/cli/option_values.h"

#include "renderer/cli/exit_code.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(OptionValues, Sizes) {
  EXPECT_EQ(parse_size("640x360"), std::pair(640, 360));
  EXPECT_EQ(parse_size("1x65536"), std::pair(1, 65536));
  for (const char* text :
       {"", "640", "640x", "x360", "640x360x3", "640X360", "0x10", "-5x10", "640x65537", "640x 360", "99999999999x1"})
    EXPECT_THROW(parse_size(text), UsageError) << text;
}

TEST(OptionValues, AmountsOfMemory) {
  EXPECT_EQ(parse_memory("1"), 1u);
  EXPECT_EQ(parse_memory("512M"), 512u << 20);
  EXPECT_EQ(parse_memory("512m"), 512u << 20);
  EXPECT_EQ(parse_memory("1.5GiB"), 1536ull << 20);
  EXPECT_EQ(parse_memory("2TB"), 2ull << 40);
  EXPECT_EQ(parse_memory("64k"), 65536u);
  for (const char* text : {"", "M", "0", "-1G", "1X", "1Gigabyte", "1e30G", "nan", "inf", "1 G", "0.1"})
    EXPECT_THROW(parse_memory(text), UsageError) << text;
}

TEST(OptionValues, Crops) {
  EXPECT_EQ(parse_crop("1,2,30,40"), (PixelWindow{1, 2, 30, 40}));
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "5,0,5,9", "0,5,9,4", "-1,0,5,5", "1;2;3;4", "1,2,3,4,"})
    EXPECT_THROW(parse_crop(text), UsageError) << text;
}

}  // namespace
}  // namespace meristem
