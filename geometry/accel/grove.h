// Grove: what stands on a cell of ground, in groups by the faces on which it stands. A ray that comes near meets few of
// them, and places no more than these.
#pragma once

#include "geometry/cells/part.h"

#include <memory>
#include <vector>

namespace meristem {

class Grove {
 public:
  Grove(std::unique_ptr<const Furnishing> furnishing, const PlacedReach& reach);

  // Whether it is so much that groups are worth their trouble.
  static bool is_worthwhile(const Furnishing& furnishing);

  // Of each group, whatever stands there; empty: nothing does.
  const std::vector<Bounds3f>& bounds() const { return bounds_; }
  // What stands in a group, and the number that its first has among all in the grove.
  std::vector<Placement> placements(std::size_t group) const;
  std::uint32_t first_number(std::size_t group) const { return first_numbers_[group]; }
  std::uint32_t most_in(std::size_t group) const { return first_numbers_[group + 1] - first_numbers_[group]; }
  std::size_t bytes() const;  // beside itself

 private:
  std::unique_ptr<const Furnishing> furnishing_;
  std::uint32_t faces_of_group_;
  std::vector<std::uint32_t> first_numbers_{0};
  std::vector<Bounds3f> bounds_;
};

}  // namespace meristem
