#include "geometry/tree/ray_packet.h"

#include "geometry/tree/tree_kernels.h"

#include <utility>

namespace meristem {

namespace {

bool go_together(const StreamRay::Leg& a, const StreamRay::Leg& b) {
  return a.braid.nodes == b.braid.nodes && a.tree.nodes == b.tree.nodes && a.ray->axis == b.ray->axis &&
         a.ray->near_side == b.ray->near_side;
}

}  // namespace

std::size_t gather_alike(StreamRay** rays, StreamRay::Leg* legs, std::size_t count) {
  for (std::size_t i = 1; i < count;)
    if (go_together(legs[0], legs[i]))
      ++i;
    else
      --count, std::swap(legs[i], legs[count]), std::swap(rays[i], rays[count]);
  return count;
}

void RayPacket::run() {
  std::array<StreamRay::Leg, most> legs;
  for (std::size_t done = count_;;) {  // so many of the first have no leg
    std::size_t left = 0;
    for (std::size_t i = 0; i < count_; ++i)
      if (i >= done || rays_[i]->next(legs[i])) rays_[left] = rays_[i], legs[left++] = legs[i];
    count_ = left;
    if (count_ == 0) return;
    done = gather_alike(rays_.data(), legs.data(), count_);
    best_tree_kernels().run_packet(rays_.data(), legs.data(), done);
  }
}

}  // namespace meristem
