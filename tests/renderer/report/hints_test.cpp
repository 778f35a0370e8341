#include "renderer/report/hints.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

// A render that recorded something, without anything to say about it.
RenderStatistics recorded() {
  RenderStatistics s;
  s.expand = "lazy";
  s.threads = 2;
  s.render_s = 10;
  s.peak_rss_bytes = 500 << 20;
  s.expansion.cells_expanded = 1000;
  s.expansion.resident_bytes_peak = 100 << 20;
  s.expansion.time_s = 4;
  s.expansion.by_step = {{"oak", "grow 1", 10, 100, 1}, {"oak", "subdivide 1", 10, 100, 3}};
  Recording recording;
  recording.expansion.budget_bytes = 200 << 20;
  recording.expansion.threads.resize(2);
  for (ThreadProfile& thread : recording.expansion.threads) {
    thread.expand_s = 3;
    thread.build_s = 1;
    thread.trace_s = 5;
  }
  s.recording = recording;
  return s;
}

std::string text_about(const RenderStatistics& s, const std::string& about, bool is_advice) {
  std::string text;
  for (const Hint& hint : hints_of(s))
    if (hint.about == about && hint.is_advice == is_advice) text += hint.text;
  return text;
}

TEST(Hints, AreNoneWithoutARecording) { EXPECT_TRUE(hints_of(RenderStatistics{}).empty()); }

TEST(Hints, SayWhenTheBudgetWasNeverReached) {
  EXPECT_EQ(text_about(recorded(), "budget", false),
            "Nothing was evicted: all expanded geometry took 100.0 MiB of the budget of 200.0 MiB.");
}

TEST(Hints, NameTheBudgetThatWouldEndReexpansion) {
  RenderStatistics s = recorded();
  s.expansion.evicted = 700;
  ReuseFigures& reuse = s.recording->expansion.reuse;
  reuse.reexpanded = 380;
  reuse.by_budget = {{300u << 20, 200}, {512u << 20, 150}, {900u << 20, 0}};
  EXPECT_EQ(
      text_about(s, "budget", true),
      "With 200.0 MiB, 380 of 1,000 expansions (38 %) repeated earlier ones. About 900.0 MiB would end re-expansion; "
      "512.0 MiB would halve it.");
  reuse.reexpanded = 10;
  EXPECT_EQ(text_about(s, "budget", false),
            "The budget of 200.0 MiB suffices: 1.0 % of the expansions repeated earlier ones.");
}

TEST(Hints, NameTheRuleWhoseBoundsAreLoose) {
  RenderStatistics s = recorded();
  CellClassFigures leaf{.cells = {"oak", 4, "leaf", true}, .visits = 1000, .boxes = 50, .box_ratio_sum = 350};
  CellClassFigures stem{.cells = {"oak", 4, "stem", true}, .visits = 1000, .boxes = 50, .box_ratio_sum = 60};
  CellClassFigures rare{.cells = {"oak", 4, "rare", true}, .visits = 1, .boxes = 50, .box_ratio_sum = 5000};
  s.recording->expansion.classes = {leaf, stem, rare};
  EXPECT_EQ(
      text_about(s, "bounds", true),
      "Bounds of rule \"leaf\" of model \"oak\" are 7 times too large by area before expansion: 86 % of the rays that "
      "enter one do so in vain, and may expand it in vain. Tighter expressions in placements and rules help.");
}

TEST(Hints, TellWhereTheTimeWent) {
  // 20 s of two threads: 8 s of expansion and building, 10 s of tracing, 2 s are left for shading
  EXPECT_EQ(
      text_about(recorded(), "time", false),
      "Of 20 s of thread time, 40 % went into expansion, 50 % into tracing and 10 % into shading. The dearest step is "
      "\"subdivide 1\" of model \"oak\", with 75 % of the time of expansion.");
  RenderStatistics s = recorded();
  EXPECT_EQ(text_about(s, "waiting", true), "");
  s.recording->expansion.threads[1].wait_s = 2;
  EXPECT_NE(text_about(s, "waiting", true).find("slept 10 % of their time"), std::string::npos);
}

TEST(Hints, GiveAdviceFirst) {
  RenderStatistics s = recorded();
  s.recording->expansion.threads[0].wait_s = 2;
  const std::vector<Hint> hints = hints_of(s);
  ASSERT_GT(hints.size(), 2u);
  EXPECT_TRUE(hints.front().is_advice);
  EXPECT_FALSE(hints.back().is_advice);
}

}  // namespace
}  // namespace meristem
