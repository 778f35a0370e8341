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

TEST(WaitingQueues, TheOldestGoesFirstIfAskedFor) {
  WaitingQueues queues;
  const auto oldest = [&](std::size_t most) {
    std::vector<std::uint32_t> ids;
    queues.take_from_oldest(most, ids);
    return ids;
  };
  EXPECT_TRUE(oldest(10).empty());
  queues.add(7, 0);
  for (std::uint32_t id = 1; id < 5; ++id) queues.add(8, id);
  for (std::uint32_t id = 5; id < 7; ++id) queues.add(9, id);
  EXPECT_EQ(oldest(10), (std::vector<std::uint32_t>{0})) << "the shortest";
  queues.add(7, 0);  // begins anew, as the last
  EXPECT_EQ(oldest(3), (std::vector<std::uint32_t>{4, 3, 2}));
  EXPECT_EQ(oldest(3), (std::vector<std::uint32_t>{1})) << "until it ends";
  EXPECT_EQ(taken(queues, 10), (std::vector<std::uint32_t>{6, 5}));
  EXPECT_EQ(oldest(10), (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(queues.empty());
}

// Many queues come and go while one lasts.
TEST(WaitingQueues, EndedQueuesTakeNoMemory) {
  WaitingQueues queues;
  queues.add(1, 0);
  for (Key name = 2; name < 100000; ++name) {
    queues.add(name, 1), queues.add(name, 2);
    EXPECT_EQ(taken(queues, 2).size(), 2u);
  }
  EXPECT_LT(queues.bytes(), 100000u);
  std::vector<std::uint32_t> ids;
  queues.take_from_oldest(1, ids);
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{0}));
}

// Against sets: every id comes back once, from a queue than which none is longer; some are taken from the oldest.
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
    if (step % 5 == 0) {
      std::vector<std::uint32_t> ids;
      queues.take_from_oldest(2, ids);
      for (const std::uint32_t id : ids) {
        EXPECT_EQ(std::ranges::count_if(expected, [&](auto& queue) { return queue.second.erase(id) == 1; }), 1);
        idle.push_back(id);
      }
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
