#include "geometry/base/expansion_profile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace meristem {

namespace {

constexpr double first_bound_s = 1e-6;

}  // namespace

double LatencyHistogram::lower_bound_s(int bin) {
  return first_bound_s * std::exp2(double(bin) / double(bins_per_octave));
}

void LatencyHistogram::add(double seconds) {
  const double bin = std::log2(std::max(seconds, first_bound_s) / first_bound_s) * bins_per_octave;
  ++counts[std::size_t(std::min(int(bin), bin_count - 1))];
  max_s = std::max(max_s, seconds);
}

LatencyHistogram& LatencyHistogram::operator+=(const LatencyHistogram& o) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += o.counts[i];
  max_s = std::max(max_s, o.max_s);
  return *this;
}

std::uint64_t LatencyHistogram::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t(0));
}

double LatencyHistogram::quantile_s(double share) const {
  const double wanted = share * double(total());
  double below = 0;
  for (int bin = 0; bin < bin_count && wanted > 0; ++bin)
    if ((below += double(counts[std::size_t(bin)])) >= wanted) return std::min(lower_bound_s(bin + 1), max_s);
  return 0;
}

}  // namespace meristem
