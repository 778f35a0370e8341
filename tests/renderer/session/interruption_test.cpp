#include "renderer/session/interruption.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace meristem {
namespace {

TEST(Interruption, ASignalAsksToStopAndSaysWhich) {
  for (int number : {SIGINT, SIGTERM}) {
    const Interruption interruption;
    EXPECT_FALSE(interruption.requested());
    EXPECT_EQ(interruption.signal(), 0);
    std::raise(number);
    EXPECT_TRUE(interruption.requested());
    EXPECT_EQ(interruption.signal(), number);
  }
}

TEST(Interruption, OthersAskForASnapshotOnce) {
  const Interruption interruption;
  EXPECT_FALSE(interruption.take_snapshot_request());
  for (int number : {SIGHUP, SIGUSR1}) {
    std::raise(number);
    EXPECT_TRUE(interruption.take_snapshot_request());
    EXPECT_FALSE(interruption.take_snapshot_request());
  }
  std::raise(SIGPIPE);
  EXPECT_FALSE(interruption.requested());
}

// Death tests run in a process started anew: other tests of this program leave threads behind.
class InterruptionDeathTest : public testing::Test {
 protected:
  void SetUp() override { testing::FLAGS_gtest_death_test_style = "threadsafe"; }
};

TEST_F(InterruptionDeathTest, ASecondInterruptEndsTheProcessAtOnce) {
  EXPECT_EXIT(
      {
        const Interruption interruption;
        std::raise(SIGINT);
        std::raise(SIGINT);
        std::exit(0);
      },
      testing::ExitedWithCode(130), "");
}

TEST_F(InterruptionDeathTest, AfterwardsASignalEndsTheProcessAsBefore) {
  EXPECT_EXIT(
      {
        { const Interruption interruption; }
        std::raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace meristem
