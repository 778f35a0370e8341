// Outline: where in its box a cell has something, as a few small boxes. A ray that waits for cells that are not
// resident needs none whose outline it does not enter: rough ground leaves most of a box empty.
#pragma once

#include "geometry/base/bounds.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>

namespace meristem {

// A piece of a ray, for boxes alone.
struct RaySpan {
  Vec3f origin, direction;
  float t_min, t_max;
};

// The least t at which a ray may be in a box; infinity if it is not up to t_max. No rounding loses a box.
float earliest_entry(const Bounds3f& box, const RaySpan& ray);

// Whether that is an entry before the end of a ray, which may have none.
inline bool enters(float entry, float t_max) {
  return entry <= t_max && entry < std::numeric_limits<float>::infinity();
}

class Outline {
 public:
  static constexpr std::size_t most_boxes = 64;

  // So many boxes at most; what they hold lies in `whole`, and each is made larger by `margin` on all sides.
  Outline(const Bounds3f& whole, std::span<const Bounds3f> boxes, float margin);

  // As earliest_entry(), of the boxes.
  float entry(const RaySpan& ray) const;

 private:
  static constexpr std::size_t group = 8;  // of boxes that are near each other, with one box around them
  // A plane lies at origin + step * byte, rounded outwards. By axis.
  template <std::size_t count>
  struct Boxes {
    std::array<std::array<std::uint8_t, count>, 3> lower, upper;

    Boxes();  // all are empty
  };
  class Slabs;

  std::array<float, 3> origin_, step_;
  Boxes<most_boxes / group> groups_;
  Boxes<most_boxes> boxes_;
};

}  // namespace meristem
