// FewBoxes: boxes that a ray is held against one by one, four at a time. Up to `most` that is cheaper than a hierarchy,
// and most cells have few children.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/tree/surface_tree.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meristem {

class FewBoxes {
 public:
  static constexpr std::size_t most = 32;

  explicit FewBoxes(std::span<const Bounds3f> boxes);  // at most `most`

  struct Entered {
    float t;
    std::uint32_t box;
  };
  using List = std::array<Entered, most>;
  // Those that the ray may be in between t_min and t_max, and from where on, in no order; returns how many. Rounding
  // loses none.
  std::size_t meet(const TreeRay& ray, float t_min, float t_max, List& entered) const;

  std::vector<Bounds3f> boxes() const;  // as given

  std::size_t bytes() const { return sizeof(*this) + fours_.capacity() * sizeof(Four); }

 private:
  struct alignas(16) Four {
    float planes[3][2][4];  // axis, lower or upper, box
    float last_t[4];        // infinity; of a box that nothing is in, and where there is none: -infinity
  };
  std::size_t count_;
  std::vector<Four> fours_;
};

}  // namespace meristem
