#include "renderer/session/waiting_queues.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace meristem {
namespace {

std::vector<std::uint32_t> taken(WaitingQueues& queues, std::size_t most) {
  std::vector<std::uint32_t> ids;
  queues.take_from_longest(most, ids);
  return ids;
}

TEST(WaitingQueues, TheLongestGoesFirst) {
  WaitingQueues queues;
  EXPECT_TRUE(taken(queues, 10).empty());
  queues.add(7, 0);
  queues.add(9, 1);
  queues.add(9, 2);
  queues.add(8, 5);
  EXPECT_EQ(taken(queues, 10), (std::vector<std::uint32_t>{2, 1}));
  queues.add(8, 1);
  EXPECT_EQ(taken(queues, 10), (std::vector<std::uint32_t>{1, 5}));
  EXPECT_EQ(taken(queues, 10), (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(queues.empty());
}

// Against sets: every id comes back once, from a queue than which none is longer.
TEST(WaitingQueues, NobodyIsLostOrServedTwice) {
  WaitingQueues queues;
  std::map<Key, std::set<std::uint32_t>> expected;
  std::vector<std::uint32_t> idle;
  for (std::uint32_t i = 0; i < 500; ++i) idle.push_back(i);
  for (Key step = 0; step < 20000; ++step) {
    if (!idle.empty() && uniform_float(hash_keys(step, 1)) < 0.8f) {
      const Key name = scramble(Key(40 * uniform_float(hash_keys(step, 2))));
      queues.add(name, idle.back());
      expected[name].insert(idle.back());
      idle.pop_back();
      continue;
    }
    const auto ids = taken(queues, 1 + step % 7);
    const auto longest = std::ranges::max_element(expected, {}, [](const auto& queue) { return queue.second.size(); });
    if (longest == expected.end() || longest->second.empty()) {
      EXPECT_TRUE(ids.empty());
      continue;
    }
    const std::size_t length = longest->second.size();
    ASSERT_EQ(ids.size(), std::min<std::size_t>(length, 1 + step % 7));
    const auto from = std::ranges::find_if(expected, [&](const auto& q) { return q.second.contains(ids[0]); });
    ASSERT_NE(from, expected.end());
    EXPECT_EQ(from->second.size(), length);
    for (const std::uint32_t id : ids) {
      EXPECT_EQ(from->second.erase(id), 1u);
      idle.push_back(id);
    }
  }
  for (const auto& [name, ids] : expected) EXPECT_EQ(queues.empty() && !ids.empty(), false);
}

}  // namespace
}  // namespace meristem
