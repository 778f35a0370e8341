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

TEST(OptionValues, BudgetsAsSharesOrAmounts) {
  const std::vector<BudgetChoice> budgets = parse_budgets("25%,64M,0.5%");
  ASSERT_EQ(budgets.size(), 3u);
  EXPECT_EQ(budgets[0].share, 0.25);
  EXPECT_EQ(budgets[1].bytes, 64u << 20);
  EXPECT_EQ(budgets[2].share, 0.005);
  for (const char* text : {"0%", "101%", "-5%", "x%", "%", "5%%", "nan%", "64X", "25%,,10%"})
    EXPECT_THROW(parse_budgets(text), UsageError) << text;
}

TEST(OptionValues, Pixels) {
  EXPECT_EQ(parse_pixel("640,0"), (std::pair{640, 0}));
  for (const char* text : {"", "1", "1,2,3", "-1,2", "1,-2", "1.5,2", "1x2"})
    EXPECT_THROW(parse_pixel(text), UsageError) << text;
}

TEST(OptionValues, Crops) {
  EXPECT_EQ(parse_crop("1,2,30,40"), (PixelWindow{1, 2, 30, 40}));
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "5,0,5,9", "0,5,9,4", "-1,0,5,5", "1;2;3;4", "1,2,3,4,"})
    EXPECT_THROW(parse_crop(text), UsageError) << text;
}

TEST(OptionValues, Durations) {
  EXPECT_EQ(parse_duration("90"), 90);
  EXPECT_EQ(parse_duration("90s"), 90);
  EXPECT_EQ(parse_duration("5m"), 300);
  EXPECT_EQ(parse_duration("1.5h"), 5400);
  EXPECT_EQ(parse_duration("1h30m10s"), 5410);
  EXPECT_EQ(parse_duration("0.25"), 0.25);
  for (const char* text : {"", "m", "0", "-5m", "5 m", "5d", "1e99", "nan", "5m3x"})
    EXPECT_THROW(parse_duration(text), UsageError) << text;
}

TEST(OptionValues, RangesOfSamples) {
  EXPECT_EQ(parse_sample_range("0:64"), (SampleRange{0, 64}));
  EXPECT_EQ(parse_sample_range("64:65"), (SampleRange{64, 65}));
  for (const char* text : {"", "64", "64:64", "64:0", "-1:5", "0:64:128", "0-64", "0:2000000"})
    EXPECT_THROW(parse_sample_range(text), UsageError) << text;
}

TEST(OptionValues, Frames) {
  EXPECT_EQ(parse_frames("7"), (std::vector{7}));
  EXPECT_EQ(parse_frames("3-5"), (std::vector{3, 4, 5}));
  EXPECT_EQ(parse_frames("0-7x3"), (std::vector{0, 3, 6}));
  for (const char* text : {"", "x", "5-3", "1-", "-1", "1-5x0", "1-5x", "1-5-9", "0-2147483647"})
    EXPECT_THROW(parse_frames(text), UsageError) << text;
}

}  // namespace
}  // namespace meristem
