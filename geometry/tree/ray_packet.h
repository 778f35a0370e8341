// RayPacket: up to eight rays that go nearly the same way, through the same nodes at once.
//
// A ray alone tests the eight boxes of a node together; a packet tests each box against its eight rays (Wald et al.
// 2001, "Interactive Rendering with Coherent Ray Tracing"), so that a node and a triangle are loaded once. Rays of one
// pixel take half of the time; rays that have little in common take more, since each goes where any of them goes.
// What a ray meets does not depend on the rays beside it.
#pragma once

#include "geometry/tree/ray_stream.h"

#include <array>
#include <cstddef>

namespace meristem {

// Of `count` rays and their legs, brings those to the front whose legs lead through the same nodes in the same
// direction as the first one's; returns how many.
std::size_t gather_alike(StreamRay** rays, StreamRay::Leg* legs, std::size_t count);

class RayPacket {
 public:
  static constexpr std::size_t most = 8;

  // A ray before it has asked for its first leg, which lives until run() has returned; at most `most`.
  void add(StreamRay& ray) { rays_[count_++] = &ray; }
  // Until all have arrived. Legs that are alike are gone together.
  void run();

 private:
  std::array<StreamRay*, most> rays_;
  std::size_t count_ = 0;
};

}  // namespace meristem
