#include "renderer/session/waiting_queues.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>

namespace meristem {
namespace {

void add(WaitingQueues& queues, std::initializer_list<Key> names, std::uint32_t id) {
  queues.add(std::span(names.begin(), names.size()), id);
}

std::vector<std::uint32_t> taken(WaitingQueues& queues, std::size_t most) {
  std::vector<std::uint32_t> ids;
  queues.take_from_longest(most, ids);
  return ids;
}

TEST(WaitingQueues, TheLongestGoesFirst) {
  WaitingQueues queues;
  EXPECT_TRUE(taken(queues, 10).empty());
  add(queues, {7}, 0);
  add(queues, {9}, 1);
  add(queues, {9}, 2);
  add(queues, {8}, 5);
  EXPECT_EQ(taken(queues, 10), (std::vector<std::uint32_t>{2, 1}));
  add(queues, {8}, 1);
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
  add(queues, {7}, 0);
  for (std::uint32_t id = 1; id < 5; ++id) add(queues, {8}, id);
  for (std::uint32_t id = 5; id < 7; ++id) add(queues, {9}, id);
  EXPECT_EQ(oldest(10), (std::vector<std::uint32_t>{0})) << "the shortest";
  add(queues, {7}, 0);  // begins anew, as the last
  EXPECT_EQ(oldest(3), (std::vector<std::uint32_t>{4, 3, 2}));
  EXPECT_EQ(oldest(3), (std::vector<std::uint32_t>{1})) << "until it ends";
  EXPECT_EQ(taken(queues, 10), (std::vector<std::uint32_t>{6, 5}));
  EXPECT_EQ(oldest(10), (std::vector<std::uint32_t>{0}));
  EXPECT_TRUE(queues.empty());
}

TEST(WaitingQueues, AQueueGoesByNameWhileItLasts) {
  WaitingQueues queues;
  for (std::uint32_t id = 0; id < 5; ++id) add(queues, {8}, id);
  add(queues, {7}, 5);
  std::vector<std::uint32_t> ids;
  EXPECT_TRUE(queues.take_from_named(7, 10, ids));
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{5})) << "not the longest";
  EXPECT_FALSE(queues.take_from_named(7, 10, ids));
  EXPECT_TRUE(queues.take_from_named(8, 3, ids));
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{5, 4, 3, 2}));
}

TEST(WaitingQueues, WhoIsServedWaitsNowhereElse) {
  WaitingQueues queues;
  add(queues, {7, 8}, 0);
  add(queues, {8, 9}, 1);
  add(queues, {9, 8}, 2);
  std::vector<std::uint32_t> ids;
  EXPECT_EQ(queues.take_from_longest(2, ids), Key(8));
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{2, 1}));
  add(queues, {9}, 1);
  ids.clear();
  EXPECT_EQ(queues.take_from_oldest(10, ids), Key(7));
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{0}));
  ids.clear();
  EXPECT_EQ(queues.take_from_longest(10, ids), Key(9));
  EXPECT_EQ(ids, (std::vector<std::uint32_t>{1}));
  EXPECT_TRUE(queues.empty());
  EXPECT_EQ(queues.take_from_longest(10, ids), std::nullopt);
}

// Ids in several queues each: all come back, once for each time that they were added, from a queue that they waited in.
TEST(WaitingQueues, NobodyInSeveralQueuesIsLost) {
  WaitingQueues queues;
  constexpr std::uint32_t count = 300;
  std::vector<std::set<Key>> names(count);
  std::size_t waiting = 0;
  for (Key step = 0; step < 30000; ++step) {
    const auto id = std::uint32_t(count * uniform_float(hash_keys(step, 1)));
    if (names[id].empty() && step < 25000) {
      for (Key i = 0; i < 1 + step % 2; ++i) names[id].insert(scramble(Key(40 * uniform_float(hash_keys(step, 2, i)))));
      const std::vector<Key> list(names[id].begin(), names[id].end());
      queues.add(list, id);
      ++waiting;
      continue;
    }
    std::vector<std::uint32_t> ids;
    const auto name = step % 3 == 0 ? queues.take_from_oldest(3, ids) : queues.take_from_longest(3, ids);
    ASSERT_EQ(name.has_value(), waiting > 0);
    for (const std::uint32_t taken : ids) {
      EXPECT_TRUE(names[taken].contains(*name));
      names[taken].clear();
      --waiting;
    }
    if (name) {
      EXPECT_EQ(ids.empty(), false);
    }
  }
  EXPECT_EQ(waiting, 0u);
  EXPECT_TRUE(queues.empty());
}

// Many queues come and go while one lasts.
TEST(WaitingQueues, EndedQueuesTakeNoMemory) {
  WaitingQueues queues;
  add(queues, {1}, 0);
  for (Key name = 2; name < 100000; ++name) {
    add(queues, {name}, 1), add(queues, {name}, 2);
    EXPECT_EQ(taken(queues, 2).size(), 2u);
  }
  EXPECT_LT(queues.bytes(), 200000u);  // memory comes in blocks
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
      add(queues, {name}, idle.back());
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

// Whatever comes and goes, memory is that of the most who waited at once.
TEST(WaitingQueues, MemoryIsUsedAgain) {
  WaitingQueues queues;
  constexpr std::uint32_t count = 20000;
  std::size_t most = 0;
  for (Key round = 0; round < 20; ++round) {
    for (std::uint32_t id = 0; id < count; ++id) add(queues, {round * 1000 + id % 50, round * 1000 + 100 + id % 7}, id);
    if (round == 0) most = queues.bytes();
    EXPECT_LE(queues.bytes(), most + (1 << 15));  // beginnings of ended queues leave later
    std::set<std::uint32_t> seen;
    while (!queues.empty())
      for (const std::uint32_t id : taken(queues, 512)) EXPECT_TRUE(seen.insert(id).second);
    EXPECT_EQ(seen.size(), count);
  }
  EXPECT_LT(most, 60u * count);
}

}  // namespace
}  // namespace meristem
