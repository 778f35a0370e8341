#include "geometry/cells/thinning.h"

#include <algorithm>
#include <cmath>

namespace meristem {

// A bud whose number is a share of the fraction up to 1 - `shrinking` is there in full, beyond that it shrinks with its
// number, and at the whole fraction it is gone. The fraction exceeds 1 where the size is almost the wanted one, so that
// at that size even the last are there in full.
Thinned thin(double size, double random) {
  constexpr double shrinking = 0.25;
  constexpr double largest_area = largest_enlargement * largest_enlargement;
  constexpr double smallest_area = smallest_enlargement * smallest_enlargement;
  if (size >= 1) return {};
  const double fraction = std::max(size * size / (1 - shrinking), 1 / (largest_area * (1 - shrinking / 2)));
  // The mean over all numbers of what share of its area a bud has
  const double beyond_all = std::max(1 - 1 / fraction, 0.0);
  const double mean = fraction * (1 - shrinking + (shrinking * shrinking - beyond_all * beyond_all) / (2 * shrinking));
  const double area = std::min((1 - random / fraction) / shrinking, 1.0) / mean;
  if (area < smallest_area) return {false, 1};
  return {true, std::min(std::sqrt(area), largest_enlargement)};
}

}  // namespace meristem
