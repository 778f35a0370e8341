// The loop of RayPacket; see tree_kernel_bodies.h. Here lanes are rays: boxes and triangles come one after the other.
#pragma once

#include "geometry/tree/ray_packet.h"
#include "geometry/tree/tree_kernel_bodies.h"

#include <limits>

namespace meristem {
namespace {

// Fewer go into another braid or tree one by one: a packet costs what a few rays do.
constexpr int least_together = 3;

// A number of each ray.
struct alignas(32) EachRay {
  float of[RayPacket::most];

  MERISTEM_INLINE F8 lanes() const { return load(of); }
};

class Packet {
 public:
  // `nested`: of how many others it is inside.
  Packet(StreamRay* const* rays, const StreamRay::Leg* legs, std::size_t count, std::size_t nested = 0);
  void run();

 private:
  // What is still to be met. No ray enters it before t.
  struct Entry {
    std::uint32_t child;
    float t;
  };

  template <class Of, class MeetEnd>
  void go_through(const Of& of, std::uint32_t start, const MeetEnd& meet_end);
  template <class Of>
  void add_children(const Of& of, std::uint32_t index);
  void enter_tree(const Braid::Strand& strand);
  void enter_other(const SurfaceTree::Node& node, std::uint32_t place);
  void enter_together(std::uint32_t other, unsigned which);
  void meet_block(const TreeView& tree, std::uint32_t block);
  void meet_triangle(const TreeView& tree, const Sheared& a, const Sheared& b, const Sheared& c,
                     std::uint32_t triangle);
  Sheared sheared(__m128 p) const;
  void shorten() { farthest_ = greatest(t_max_.lanes()); }

  StreamRay* const* const rays_;
  const StreamRay::Leg* const legs_;
  const std::size_t count_, nested_;
  const TreeRay& like_;  // in signs and axis all are as this one
  EachRay origin_[3], reciprocal_[3], slack_[3], shear_x_, shear_y_, shear_z_, t_min_;
  EachRay t_max_;  // less than 0: it needs nothing more
  float farthest_;
  TreeHit hits_[RayPacket::most];  // of the tree
  std::size_t waiting_ = 0;
  Entry stack_[2 * SurfaceTree::most_waiting];
};

Packet::Packet(StreamRay* const* rays, const StreamRay::Leg* legs, std::size_t count, std::size_t nested)
    : rays_(rays), legs_(legs), count_(count), nested_(nested), like_(*legs[0].ray) {
  for (std::size_t i = 0; i < RayPacket::most; ++i) {
    const bool exists = i < count;
    const StreamRay::Leg& leg = legs[exists ? i : 0];
    for (std::size_t k = 0; k < 3; ++k) {
      origin_[k].of[i] = leg.ray->origin[k];
      reciprocal_[k].of[i] = leg.ray->reciprocal[k];
      slack_[k].of[i] = leg.ray->slack[k];
    }
    shear_x_.of[i] = leg.ray->shear_x;
    shear_y_.of[i] = leg.ray->shear_y;
    shear_z_.of[i] = leg.ray->shear_z;
    t_min_.of[i] = leg.t_min;
    t_max_.of[i] = exists ? rays[i]->t_max : -std::numeric_limits<float>::infinity();
  }
  shorten();
}

void Packet::run() {
  const OfBraid of{legs_[0].braid};
  if (!of.braid.nodes) return enter_tree(legs_[0].tree);
  go_through(of, 0, [&](std::uint32_t end) {
    if (of.is_strand(end))
      enter_tree(of.strand(end));
    else
      enter_other(of.node(end / 8), end % 8);
  });
}

template <class Of, class MeetEnd>
MERISTEM_INLINE void Packet::go_through(const Of& of, std::uint32_t start, const MeetEnd& meet_end) {
  const std::size_t bottom = waiting_;
  for (std::uint32_t child = start;;) {
    if (child & is_end)
      meet_end(child & ~is_end);
    else
      add_children(of, child);
    do
      if (waiting_ == bottom) return;
    while (stack_[--waiting_].t > farthest_);
    child = stack_[waiting_].child;
  }
}

// As meet_children(), of one child after the other; the nearest comes last.
template <class Of>
MERISTEM_INLINE void Packet::add_children(const Of& of, std::uint32_t index) {
  const SurfaceTree::Node& node = of.node(index);
  F8 enter[3], leave[3], scale[3];
  EachRay near[3], far[3];  // of each child
  for (std::size_t k = 0; k < 3; ++k) {
    const F8 distance = sub(splat(node.origin[k]), origin_[k].lanes());
    const F8 step = splat(std::bit_cast<float>(std::uint32_t(node.exponent[k]) << 23));
    const F8 magnitude = add(max(distance, sub(splat(0), distance)), mul(step, splat(256)));
    const F8 base = mul(distance, reciprocal_[k].lanes()), error = mul(magnitude, slack_[k].lanes());
    enter[k] = sub(base, error);
    leave[k] = add(base, error);
    scale[k] = mul(step, reciprocal_[k].lanes());
    store(near[k].of, from_bytes(node.bounds[k][like_.near_side[k]]));
    store(far[k].of, from_bytes(node.bounds[k][1 - like_.near_side[k]]));
  }
  const F8 t_min = t_min_.lanes(), t_max = t_max_.lanes();
  const std::size_t first = waiting_;
  for (std::uint32_t i = 0; i < node.children; ++i) {
    const auto plane = [&](const EachRay& bounds, const F8(&base)[3], std::size_t k) {
      return mul_add_loose(splat(bounds.of[i]), scale[k], base[k]);
    };
    const F8 entries =
        max(max(plane(near[0], enter, 0), plane(near[1], enter, 1)), max(plane(near[2], enter, 2), t_min));
    const F8 exits = min(min(plane(far[0], leave, 0), plane(far[1], leave, 1)), min(plane(far[2], leave, 2), t_max));
    if (where_le(entries, exits) == 0) continue;
    of.prefetch(node, i);
    const Entry entry{child_at(node, index, i), least(entries)};
    std::size_t at = waiting_++;
    for (; at > first && stack_[at - 1].t < entry.t; --at) stack_[at] = stack_[at - 1];
    stack_[at] = entry;
  }
}

void Packet::enter_tree(const Braid::Strand& strand) {
  const TreeView tree{strand.nodes, strand.triangles, strand.positions};
  for (TreeHit& hit : hits_) hit.triangle = TreeHit::none;
  go_through(OfTree{tree}, strand.start, [&](std::uint32_t block) { meet_block(tree, block); });
  for (std::size_t i = 0; i < count_; ++i) {
    if (hits_[i].triangle == TreeHit::none) continue;
    rays_[i]->met(strand.owner, hits_[i]);
    t_max_.of[i] = rays_[i]->t_max;
  }
  shorten();
}

// Only those rays do that meet its box: what is in it may have to be expanded.
void Packet::enter_other(const SurfaceTree::Node& node, std::uint32_t place) {
  const std::uint32_t other = node.first[place];
  unsigned which = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const Children boxes = meet_children(node, *legs_[i].ray, splat(legs_[i].t_min), t_max_.of[i]);
    which |= (boxes.of(node) >> place & 1) << i;
  }
  if (nested_ < StreamRay::most_nested && std::popcount(which) >= least_together)
    enter_together(other, which);
  else
    for (; which; which &= which - 1) rays_[std::countr_zero(which)]->enter(other);
  for (std::size_t i = 0; i < count_; ++i)
    if (t_max_.of[i] >= 0) t_max_.of[i] = rays_[i]->t_max;
  shorten();
}

// Those that find a leg inside go on as packets.
void Packet::enter_together(std::uint32_t other, unsigned which) {
  StreamRay* inside[RayPacket::most];
  StreamRay::Leg legs[RayPacket::most];
  std::size_t left = 0;
  for (; which; which &= which - 1) {
    StreamRay* const ray = rays_[std::countr_zero(which)];
    if (ray->enter(other, legs[left])) inside[left++] = ray;
  }
  for (std::size_t first = 0; first < left;) {
    const std::size_t alike = gather_alike(inside + first, legs + first, left - first);
    Packet(inside + first, legs + first, alike, nested_ + 1).run();
    for (const std::size_t end = first + alike; first < end; ++first) inside[first]->leave();
  }
}

// As RayLanes has it.
MERISTEM_INLINE Sheared Packet::sheared(__m128 p) const {
  alignas(16) float of_axis[4];
  _mm_store_ps(of_axis, p);
  const auto from_origin = [&](int axis) { return sub(splat(of_axis[axis]), origin_[axis].lanes()); };
  const F8 along = from_origin(like_.axis);
  return {sub(from_origin((like_.axis + 1) % 3), mul(shear_x_.lanes(), along)),
          sub(from_origin((like_.axis + 2) % 3), mul(shear_y_.lanes(), along)), mul(shear_z_.lanes(), along)};
}

// Triangles in the order of load_corners().
void Packet::meet_block(const TreeView& tree, std::uint32_t block) {
  const SurfaceTree::Node& node = tree.nodes[block / 8];
  const std::uint32_t first = node.first[block % 8], stride = node.stride[block % 8], shape = node.shape[block % 8];
  if (stride == 0) {
    for (std::uint32_t i = 0; i < shape; ++i) {
      const auto& corners = tree.triangles[first + i];
      const auto corner = [&](int k) { return sheared(tree.positions.lanes(corners[k])); };
      meet_triangle(tree, corner(0), corner(1), corner(2), 8 * block + i);
    }
    return;
  }
  const std::uint32_t columns = shape % 16, rows = shape / 16;
  Sheared grid[3][3];
  for (std::uint32_t y = 0; y <= rows; ++y)
    for (std::uint32_t x = 0; x <= columns; ++x) grid[y][x] = sheared(tree.positions.lanes(first + y * stride + x));
  for (std::uint32_t half = 0; half < 2; ++half)
    for (std::uint32_t y = 0; y < rows; ++y)
      for (std::uint32_t x = 0; x < columns; ++x) {
        const Sheared &along_x = grid[y][x + 1], &along_y = grid[y + 1][x];
        const std::uint32_t triangle = 8 * block + 4 * half + 2 * y + x;
        if (half == 0)
          meet_triangle(tree, grid[y][x], along_x, along_y, triangle);
        else
          meet_triangle(tree, grid[y + 1][x + 1], along_y, along_x, triangle);
      }
}

// As meet_block() of one ray.
MERISTEM_INLINE void Packet::meet_triangle(const TreeView& tree, const Sheared& a, const Sheared& b, const Sheared& c,
                                           std::uint32_t triangle) {
  const EdgeFunctions e(a, b, c);
  unsigned met = e.met();
  if (met == 0) return;
  const F8 t = e.t(a, b, c);
  met &= where_lt(t_min_.lanes(), t) & where_le(t, t_max_.lanes());
  if (met == 0) return;
  EachRay ts, us, vs;
  store(ts.of, t);
  store(us.of, div(e.v, e.area));
  store(vs.of, div(e.w, e.area));
  for (; met; met &= met - 1) {
    const int i = std::countr_zero(met);
    if (ts.of[i] == t_max_.of[i] && hits_[i].triangle != TreeHit::none && !wins_tie(tree, triangle, hits_[i].triangle))
      continue;
    hits_[i] = {ts.of[i], triangle, us.of[i], vs.of[i]};
    t_max_.of[i] = rays_[i]->any ? -std::numeric_limits<float>::infinity() : ts.of[i];
  }
  shorten();
}

void run_packet(StreamRay* const* rays, const StreamRay::Leg* legs, std::size_t count) {
  Packet(rays, legs, count).run();
}

}  // namespace
}  // namespace meristem
