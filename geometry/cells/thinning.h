// Thinning: of many small things that grow, such as leaves or spikes, fewer are grown the smaller they are seen, and
// those that are grown are larger, so that what they cover and their mean colour stay (Cook, Halstead, Planck and Ryu
// 2007, "Stochastic Simplification of Aggregate Detail").
//
// A bud is kept if its random number is below a fraction that falls with the square of its size, so that those that
// remain are seen about as large as wanted. What is kept at one size is kept at all larger ones,
// and shrinks to nothing before it is left out. Decided by bud, from its key and its place alone: all cells that hold
// it decide alike, whatever the cache, the thread or the order of rays. Pure functions.
#pragma once

#include "geometry/base/key.h"

namespace meristem {

// What the random number of a bud is for.
constexpr Key thinning_tag = hash_text("thinning");

// Of what grows on a bud. In between it only shrinks or grows as a whole, so it stays as closed as it was.
constexpr double smallest_enlargement = 0.25, largest_enlargement = 8;

struct Thinned {
  bool is_kept = true;
  double enlargement = 1;  // in [smallest_enlargement, largest_enlargement]: how many times larger it is
};

// Of what is that large in units of the wanted size (below 1: small), by a random number in [0, 1). The mean of the
// squared enlargement over the numbers, those left out counting as 0, is 1 to within 0.2 %, for sizes above
// 1/largest_enlargement.
Thinned thin(double size, double random);

}  // namespace meristem
