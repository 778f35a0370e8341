// The loop of RayStream; see tree_kernel_bodies.h.
#pragma once

#include "geometry/tree/ray_stream.h"
#include "geometry/tree/tree_kernel_bodies.h"

namespace meristem {
namespace {

// The place of one ray. It is in a braid, or in one of its trees, or in a tree alone.
struct Lane {
  alignas(32) float entries[8];    // into the children of the node,
  unsigned met;                    // that it may meet
  std::uint32_t child;             // where it is: a node or an end
  const SurfaceTree::Node* nodes;  // of the braid or the tree
  const TreeRay* ray;
  float t_min;
  bool in_tree, any;
  TreeHit hit;         // of the tree; t is the end of the ray everywhere
  std::size_t count;   // of those that wait,
  std::size_t bottom;  // and of them that belong to the braid around the tree it is in
  Entered stack[2 * SurfaceTree::most_waiting];
  TreeView tree;
  std::uint32_t owner;  // of the tree
  Braid::View braid;
  StreamRay* traveller;

  // The boxes of a node; the ray is in one.
  void test();
  // Each returns false when the ray has arrived.
  bool begin(StreamRay& next);
  bool go_on();

 private:
  bool begin_leg();
  void enter_tree(const Braid::Strand& strand);
  bool leave_tree();
  bool take();
  bool take_next();
  bool meet_block_here();
  bool enter_strand();
  void choose();
  void prefetch() const;
};

[[gnu::noinline]] bool Lane::begin_leg() {
  StreamRay::Leg leg;
  if (!traveller->next(leg)) return false;
  ray = leg.ray;
  t_min = leg.t_min;
  braid = leg.braid;
  hit = {traveller->t_max};
  count = bottom = 0;
  if (braid.nodes) {
    in_tree = false;
    nodes = braid.nodes;
    child = 0;
  } else {
    enter_tree(leg.tree);
  }
  return true;
}

bool Lane::begin(StreamRay& next) {
  traveller = &next;
  any = next.any;
  return begin_leg();
}

MERISTEM_INLINE void Lane::enter_tree(const Braid::Strand& strand) {
  in_tree = true;
  tree = {strand.nodes, strand.triangles, strand.positions};
  nodes = strand.nodes;
  owner = strand.owner;
  child = strand.start;
  bottom = count;
  hit.triangle = TreeHit::none;
}

// False: there is no braid around it.
bool Lane::leave_tree() {
  if (hit.triangle != TreeHit::none) {
    traveller->met(owner, hit);
    hit.t = traveller->t_max;
  }
  in_tree = false;
  nodes = braid.nodes;
  bottom = 0;
  return nodes != nullptr;
}

MERISTEM_INLINE bool Lane::take() {
  while (count > bottom) {
    --count;
    if (stack[count].t > hit.t) continue;
    child = stack[count].child;
    return true;
  }
  return false;
}

MERISTEM_INLINE bool Lane::take_next() {
  if (take()) return true;
  if (!in_tree) return begin_leg();
  return leave_tree() && take() ? true : begin_leg();
}

MERISTEM_INLINE bool Lane::meet_block_here() {
  const std::uint32_t block = child & ~is_end;
  switch (ray->axis) {
    case 0: return meet_block<0, false>(tree, block, RayLanes<0>(*ray, t_min), hit);
    case 1: return meet_block<1, false>(tree, block, RayLanes<1>(*ray, t_min), hit);
    default: return meet_block<2, false>(tree, block, RayLanes<2>(*ray, t_min), hit);
  }
}

// Enters a tree, or whatever else stands at the end of a braid. Strands are few and mostly near.
MERISTEM_INLINE bool Lane::enter_strand() {
  const Braid::Strand& strand = braid.strands[child & ~is_end];
  if (strand.nodes) {
    enter_tree(strand);
    return true;
  }
  traveller->enter(strand.owner);
  hit.t = traveller->t_max;
  return take_next();
}

// On to the nearest of the children that the ray may meet, or any of them; the others wait.
MERISTEM_INLINE void Lane::choose() {
  const SurfaceTree::Node& node = nodes[child];
  const std::uint32_t number = 8 * child, by_number = in_tree ? ~0u : 0;
  const auto entered = [&](unsigned set) {
    const auto place = std::uint32_t(std::countr_zero(set));
    const std::uint32_t first = node.first[place];
    const std::uint32_t end = (by_number & (number + place)) | (~by_number & first) | is_end;
    return Entered{node.shape[place] == 0 ? first : end, entries[place]};
  };
  Entered nearest = entered(met);
  const std::size_t begin = count;
  for (unsigned rest = met & (met - 1); rest; rest &= rest - 1) {
    Entered farther = entered(rest);
    std::size_t at = count++;
    if (!any) {
      if (farther.t < nearest.t) std::swap(farther, nearest);
      for (; at > begin && stack[at - 1].t < farther.t; --at) stack[at] = stack[at - 1];
    }
    stack[at] = farther;
  }
  child = nearest.child;
}

// What it needs next.
MERISTEM_INLINE void Lane::prefetch() const {
  if (!(child & is_end))
    prefetch_node(nodes[child]);
  else
    OfTree{tree}.prefetch(nodes[(child & ~is_end) / 8], child % 8);
}

MERISTEM_INLINE void Lane::test() {
  F8 from;
  met = meet_children(nodes[child], *ray, splat(t_min), hit.t, from);
  store(entries, from);
}

MERISTEM_INLINE bool Lane::go_on() {
  if (!(child & is_end) && met != 0) {
    choose();
  } else {
    if ((child & is_end) && meet_block_here() && any) count = bottom;
    if (!take_next()) return false;
  }
  while ((child & is_end) && !in_tree)
    if (!enter_strand()) return false;
  prefetch();
  return true;
}

// The next ray that has a way at all.
[[gnu::noinline]] bool fill(RayStream& rays, int place, Lane& lane) {
  while (StreamRay* const next = rays.next(place))
    if (lane.begin(*next)) return true;
  return false;
}

void run_stream(RayStream& rays) {
  Lane lanes[RayStream::most_lanes];
  Lane* alive[RayStream::most_lanes];
  int count = 0;
  while (count < RayStream::most_lanes && fill(rays, count, lanes[count])) alive[count] = &lanes[count], ++count;
  while (count > 0) {
    for (int i = 0; i < count; ++i) {
      Lane& lane = *alive[i];
      if (!(lane.child & is_end)) lane.test();
    }
    for (int i = 0; i < count;) {
      Lane& lane = *alive[i];
      if (lane.go_on() || fill(rays, int(&lane - lanes), lane))
        ++i;
      else
        alive[i] = alive[--count];
    }
  }
}

}  // namespace
}  // namespace meristem
