// Against a cache that forgets what was used longest ago, run again with every larger budget.
#include "geometry/cache/reuse_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <list>
#include <map>
#include <set>

namespace meristem {
namespace {

constexpr std::size_t cell_bytes = 1000;

// Equal cells in a cache with room for `capacity` of them; least recently used first. Returns the repeated expansions.
int run_lru(const std::vector<Key>& accesses, std::size_t capacity, ReuseDistances* recorder = nullptr) {
  std::list<Key> resident;
  std::map<Key, std::list<Key>::iterator> places;
  std::set<Key> seen;
  int repeated = 0;
  for (const Key cell : accesses) {
    if (const auto at = places.find(cell); at != places.end()) {
      resident.splice(resident.end(), resident, at->second);
      continue;
    }
    repeated += !seen.insert(cell).second;
    if (recorder) recorder->expanded(cell, cell_bytes);
    places[cell] = resident.insert(resident.end(), cell);
    if (resident.size() <= capacity) continue;
    if (recorder) recorder->evicted(resident.front(), resident.size() * cell_bytes);
    places.erase(resident.front());
    resident.pop_front();
  }
  return repeated;
}

double predicted(const ReuseFigures& figures, double budget) {
  double left = figures.reexpanded;
  for (const ReuseFigures::Step& step : figures.by_budget)
    if (double(step.budget_bytes) <= budget) left = step.reexpanded;
  return left;
}

// Cells 0 to count - 1, the lower ones more often.
std::vector<Key> skewed_accesses(int accesses, int count) {
  std::vector<Key> result;
  for (int i = 0; i < accesses; ++i) {
    const double x = uniform_double(scramble(Key(i) + 99));
    result.push_back(hash_keys(5, Key(std::pow(x, 3) * count)));
  }
  return result;
}

TEST(ReuseDistances, WithoutEvictionsThereIsNoReuse) {
  ReuseDistances reuse;
  run_lru(skewed_accesses(2000, 100), 100, &reuse);
  EXPECT_EQ(reuse.figures().reexpanded, 0);
  EXPECT_TRUE(reuse.figures().by_budget.empty());
  EXPECT_EQ(reuse.figures().distinct_cells, 100);
  EXPECT_EQ(reuse.figures().distinct_bytes, 100 * cell_bytes);
}

TEST(ReuseDistances, ACycleThatDoesNotFitNeedsRoomForAllOfIt) {
  ReuseDistances reuse;
  std::vector<Key> accesses;
  for (int round = 0; round < 10; ++round)
    for (Key cell = 1; cell <= 100; ++cell) accesses.push_back(cell);
  EXPECT_EQ(run_lru(accesses, 50, &reuse), 900);
  const ReuseFigures f = reuse.figures();
  EXPECT_EQ(f.reexpanded, 900);
  ASSERT_FALSE(f.by_budget.empty());
  EXPECT_EQ(f.by_budget.back().budget_bytes, 100 * cell_bytes);
  EXPECT_EQ(f.by_budget.back().reexpanded, 0);
  EXPECT_EQ(predicted(f, 90 * cell_bytes), 900);
}

TEST(ReuseDistances, PredictWhatALargerCacheDoes) {
  const std::vector<Key> accesses = skewed_accesses(20000, 1000);
  ReuseDistances reuse;
  const int repeated = run_lru(accesses, 200, &reuse);
  const ReuseFigures f = reuse.figures();
  EXPECT_EQ(f.reexpanded, repeated);
  for (const std::size_t capacity : {300u, 400u, 600u, 800u}) {
    const double truth = run_lru(accesses, capacity), guess = predicted(f, double(capacity * cell_bytes));
    EXPECT_GT(guess, truth - 0.02 * repeated) << capacity;  // never far too few
    EXPECT_LT(guess, truth + 0.2 * repeated) << capacity;
  }
}

TEST(ReuseDistances, ASampleTellsNearlyTheSame) {
  const std::vector<Key> accesses = skewed_accesses(100000, 8000);
  ReuseDistances all, sample(500);
  const int repeated = run_lru(accesses, 2000, &all);
  run_lru(accesses, 2000, &sample);
  const ReuseFigures f = sample.figures();
  EXPECT_EQ(f.sampled_share, 1.0 / 16);
  EXPECT_NEAR(f.reexpanded / repeated, 1, 0.15);
  EXPECT_NEAR(f.distinct_bytes / all.figures().distinct_bytes, 1, 0.15);
  for (const double budget : {3e6, 4e6, 6e6})
    EXPECT_NEAR(predicted(f, budget) / repeated, predicted(all.figures(), budget) / repeated, 0.1) << budget;
}

}  // namespace
}  // namespace meristem
