#include "geometry/cache/reuse_distance.h"

#include <algorithm>
#include <cmath>

namespace meristem {

double ReuseDistances::weight() const { return std::exp2(64 - shift_); }

bool ReuseDistances::expanded(Key name, std::size_t bytes) {
  position_ += bytes;
  if (!is_sampled(name)) return false;
  const auto [at, is_new] = cells_.try_emplace(name);
  Cell& cell = at->second;
  if (!is_new) {
    // Everything came in before the cell's own return is distinct from it
    count_reuse(double(cell.resident_then) + distinct_bytes_since(cell.evicted_at) * weight());
    add_to_bucket(cell.expanded_at, -double(cell.bytes));
  }
  cell = {position_, 0, 0, bytes};
  add_to_bucket(position_, double(bytes));
  if (cells_.size() > max_cells_) thin_out();
  return !is_new;
}

void ReuseDistances::evicted(Key name, std::size_t resident_bytes) {
  const auto at = cells_.find(name);
  if (at == cells_.end()) return;
  at->second.evicted_at = position_;
  at->second.resident_then = resident_bytes;
}

// Widens the buckets until the position has one.
std::size_t ReuseDistances::bucket_of(std::uint64_t position) {
  while (position / bucket_bytes_ >= bucket_count) {
    for (std::size_t i = 0; i < bucket_count / 2; ++i) buckets_[i] = buckets_[2 * i] + buckets_[2 * i + 1];
    std::fill(buckets_.begin() + bucket_count / 2, buckets_.end(), 0.0);
    bucket_bytes_ *= 2;
  }
  return std::size_t(position / bucket_bytes_);
}

void ReuseDistances::add_to_bucket(std::uint64_t position, double bytes) { buckets_[bucket_of(position)] += bytes; }

// Of the bucket in which the position lies, the part behind it is taken to be proportional.
double ReuseDistances::distinct_bytes_since(std::uint64_t position) {
  const std::size_t first = bucket_of(position), last = bucket_of(position_);
  const double inside = double(position % bucket_bytes_) / double(bucket_bytes_);
  double bytes = buckets_[first] * (1 - inside);
  for (std::size_t i = first + 1; i <= last; ++i) bytes += buckets_[i];
  return bytes;
}

void ReuseDistances::count_reuse(double needed_bytes) {
  const double octaves = std::log2(std::max(needed_bytes, 1.0));
  needs_[std::min(std::size_t(octaves * needs_per_octave), needs_.size() - 1)] += weight();
}

void ReuseDistances::thin_out() {
  --shift_;
  for (auto at = cells_.begin(); at != cells_.end();) {
    if (is_sampled(at->first)) {
      ++at;
      continue;
    }
    add_to_bucket(at->second.expanded_at, -double(at->second.bytes));
    at = cells_.erase(at);
  }
}

ReuseFigures ReuseDistances::figures() const {
  ReuseFigures f;
  f.sampled_share = 1 / weight();
  f.distinct_cells = double(cells_.size()) * weight();
  for (const auto& [name, cell] : cells_) f.distinct_bytes += double(cell.bytes) * weight();
  for (const double count : needs_) f.reexpanded += count;
  double left = f.reexpanded;
  for (std::size_t i = 0; i < needs_.size() && left > 0; ++i) {
    if (needs_[i] == 0) continue;
    left = std::max(0.0, left - needs_[i]);
    // The upper end of the bin; but no budget above all bytes is ever needed
    const double budget = std::min(std::exp2(double(i + 1) / needs_per_octave), f.distinct_bytes);
    if (budget == f.distinct_bytes) left = 0;
    f.by_budget.push_back({std::uint64_t(budget), left});
  }
  return f;
}

}  // namespace meristem
