#include "renderer/report/recording.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

TEST(PhaseTimes, ShadingIsWhatTheOthersLeave) {
  ExpansionProfile p;
  p.threads.resize(2);
  p.threads[0].expand_s = 2;
  p.threads[0].build_s = p.threads[0].wait_s = 1;
  p.threads[0].trace_s = 3;
  p.threads[1].expand_s = 1;
  p.threads[1].trace_s = 5;
  const PhaseTimes lazy = phase_times(p, 0.5, 10, 2, false);
  EXPECT_EQ(lazy.load, 0.5);
  EXPECT_EQ(lazy.expand, 3);
  EXPECT_EQ(lazy.trace, 8);
  EXPECT_EQ(lazy.shade, 20 - 5 - 8);
  // Expanding beforehand is not part of the rendering
  EXPECT_EQ(phase_times(p, 0.5, 10, 2, true).shade, 20 - 8);
  // An estimate may not take more than there was
  const PhaseTimes brief = phase_times(p, 0.5, 4, 2, false);
  EXPECT_EQ(brief.trace, 3);
  EXPECT_EQ(brief.shade, 0);
}

TEST(MemorySamples, StayWithinBoundsAndEvenlySpread) {
  MemorySamples samples;
  for (int i = 0; i < 100000; ++i) samples.add({double(i), std::uint64_t(i)});
  ASSERT_LE(samples.list().size(), 4096u);
  ASSERT_GT(samples.list().size(), 2000u);
  const double step = samples.list()[1].age_s;
  for (std::size_t i = 0; i < samples.list().size(); ++i) ASSERT_EQ(samples.list()[i].age_s, step * double(i));
}

TEST(ChromeTrace, HasSpansInMicrosecondsSinceTheProgramBegan) {
  Recording recording;
  recording.start_s = 2;
  recording.expansion.duration_s = 3;
  recording.expansion.classes = {{.cells = {"an \"oak\"", 4, "leaf", true}}};
  ThreadProfile thread;
  thread.spans = {
      {.start_s = 0.5, .duration_s = 0.25f, .build_s = 0.125f, .is_reexpansion = true, .faces = 16, .bytes = 99},
      {.start_s = 1, .duration_s = 0.5f, .kind = ActivitySpan::Kind::Wait}};
  recording.expansion.threads = {thread};
  const std::string trace = chrome_trace(recording, 0.75, 3);
  for (const char* part :
       {R"({"ph":"X","pid":1,"tid":1,"name":"expand again","ts":2500000.000,"dur":250000.000,)"
        R"("args":{"model":"an \"oak\"","level":4,"rule":"leaf","faces":16,"bytes":99}})",
        R"("name":"build","ts":2625000.000,"dur":125000.000)", R"("name":"wait","ts":3000000.000,"dur":500000.000)",
        R"("name":"load","ts":1250000.000,"dur":750000.000)", R"("name":"render","ts":2000000.000,"dur":3000000.000)"})
    EXPECT_NE(trace.find(part), std::string::npos) << part << "\nin\n" << trace;
}

}  // namespace
}  // namespace meristem
