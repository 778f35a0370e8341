#include "renderer/session/progress.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace meristem {
namespace {

TEST(Progress, DurationsReadWell) {
  EXPECT_EQ(format_duration(0.04), "0.0 s");
  EXPECT_EQ(format_duration(9.94), "9.9 s");
  EXPECT_EQ(format_duration(9.96), "10 s");
  EXPECT_EQ(format_duration(59.6), "1 min 0 s");
  EXPECT_EQ(format_duration(3599), "59 min 59 s");
  EXPECT_EQ(format_duration(7500), "2 h 5 min");
}

TEST(Progress, TimeLeftFollowsFromTheShareDone) {
  EXPECT_EQ(format_line({250, 1000, 2, 4, 12, 0}), "25 %, pass 2/4, 12 s, 36 s left");
  EXPECT_EQ(format_line({1, 1000, 1, 4, 2, 0}), "0 %, pass 1/4, 2.0 s");
  EXPECT_EQ(format_line({1000, 1000, 4, 4, 12, 0}), "100 %, pass 4/4, 12 s");
}

TEST(Progress, TimeLeftOfACarriedOnRenderIsThatOfWhatIsLeft) {
  // 600 of 1000 were there before; 100 more took 10 s
  EXPECT_EQ(format_line({700, 1000, 3, 4, 10, 600}), "70 %, pass 3/4, 10 s, 30 s left");
  EXPECT_EQ(format_json({700, 1000, 3, 4, 10, 600}),
            R"({"event": "progress", "fraction": 0.7000, "samples": 700, "samples_total": 1000, )"
            R"("pass": 3, "passes": 4, "elapsed_s": 10.000, "left_s": 30.000})");
}

TEST(Progress, TheBarFillsTheLine) {
  const std::string bar = format_bar({500, 1000, 2, 4, 12, 0}, 60);
  EXPECT_EQ(bar.size(), 60u);
  EXPECT_EQ(bar.find(" 50 % [="), 0u);
  EXPECT_NE(bar.find("pass 2/4, 12 s, 12 s left"), std::string::npos);
  EXPECT_NE(format_bar({500, 1000, 2, 4, 12, 0}, 5).find("50 %"), std::string::npos);
}

TEST(Progress, LinesComeEveryFewSecondsAndQuietMeansNothing) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* out = ::open_memstream(&text, &size);
  {
    ProgressDisplay lines(out, ProgressDisplay::Style::Lines), none(out, ProgressDisplay::Style::None);
    for (double t : {1.0, 4.9, 5.1, 6.0, 10.2}) {
      lines.update({500, 1000, 2, 4, t, 0});
      none.update({500, 1000, 2, 4, t, 0});
    }
  }
  std::fclose(out);
  EXPECT_EQ(std::string(text), "50 %, pass 2/4, 5.1 s, 5.1 s left\n50 %, pass 2/4, 10 s, 10 s left\n");
  std::free(text);
}

}  // namespace
}  // namespace meristem
