// The loop of RayStream; see tree_kernel_bodies.h.
#pragma once

#include "geometry/tree/ray_stream.h"
#include "geometry/tree/tree_kernel_bodies.h"

#include <limits>

namespace meristem {
namespace {

// An end that stands below all that waits in a tree or a braid.
constexpr std::uint32_t is_over = ~std::uint32_t(0);

// What a ray has yet to meet, the nearest last.
struct Stack {
  // Of a tree and the braids around it; eight are written where one is added.
  static constexpr std::size_t capacity = (2 + StreamRay::most_nested) * (SurfaceTree::most_waiting + 1) + 8;
  std::size_t count = 0;
  float t[capacity];
  std::uint32_t child[capacity];

  void add(std::uint32_t c, float entry) {
    t[count] = entry;
    child[count++] = c;
  }
  void add_bottom() { add(is_over, -std::numeric_limits<float>::infinity()); }
  // There is a bottom.
  MERISTEM_INLINE std::uint32_t take(float t_max) {
    do --count;
    while (t[count] > t_max);
    return child[count];
  }
  // Those of a node that are met; ends by 8 * node + child.
  void add_children(const SurfaceTree::Node& node, std::uint32_t index, const Children& met);
};

// Without branches, since what is met is as good as random: all eight are sorted by where they are entered, those that
// are not met behind all others.
#if MERISTEM_TREE_AVX2
// The key of the child at each place with that of its partner; the lesser goes to the places in the mask Later.
template <int Later>
MERISTEM_INLINE __m256i exchange(__m256i keys, __m256i partners) {
  return _mm256_blend_epi32(_mm256_max_epi32(keys, partners), _mm256_min_epi32(keys, partners), Later);
}
template <int Partners>
MERISTEM_INLINE __m256i in_fours(__m256i keys) {
  return _mm256_shuffle_epi32(keys, Partners);
}

MERISTEM_INLINE __m256i sorted_downwards(__m256i k) {
  constexpr int flip_2 = _MM_SHUFFLE(2, 3, 0, 1), flip_4 = _MM_SHUFFLE(0, 1, 2, 3), by_2 = _MM_SHUFFLE(1, 0, 3, 2);
  k = exchange<0xaa>(k, in_fours<flip_2>(k));
  k = exchange<0xcc>(k, in_fours<flip_4>(k));
  k = exchange<0xaa>(k, in_fours<flip_2>(k));
  k = exchange<0xf0>(k, _mm256_permute4x64_epi64(in_fours<flip_4>(k), _MM_SHUFFLE(1, 0, 3, 2)));
  k = exchange<0xcc>(k, in_fours<by_2>(k));
  return exchange<0xaa>(k, in_fours<flip_2>(k));
}

MERISTEM_INLINE void Stack::add_children(const SurfaceTree::Node& node, std::uint32_t index, const Children& met) {
  const __m256i places = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i ends = _mm256_or_si256(_mm256_set1_epi32(int(8 * index | is_end)), places);
  const __m256i first = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(node.first));
  const __m256i shapes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(node.shape)));
  const __m256i children = _mm256_blendv_epi8(ends, first, _mm256_cmpeq_epi32(shapes, _mm256_setzero_si256()));
  // Positive floats are ordered as their bits are; the last three say which child it is.
  const __m256i of_t = _mm256_set1_epi32(0x7ffffff8);
  const __m256i is_met = _mm256_and_si256(_mm256_castps_si256(_mm256_cmp_ps(met.entries, met.exits, _CMP_LE_OQ)),
                                          _mm256_cmpgt_epi32(_mm256_set1_epi32(node.children), places));
  __m256i keys = _mm256_or_si256(_mm256_and_si256(_mm256_castps_si256(met.entries), of_t), places);
  keys = sorted_downwards(_mm256_blendv_epi8(_mm256_set1_epi32(-1), keys, is_met));
  _mm256_storeu_ps(t + count, _mm256_castsi256_ps(_mm256_and_si256(keys, of_t)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(child + count), _mm256_permutevar8x32_epi32(children, keys));
  count += std::size_t(std::popcount(unsigned(_mm256_movemask_ps(_mm256_castsi256_ps(is_met)))));
}
#else
inline void Stack::add_children(const SurfaceTree::Node& node, std::uint32_t index, const Children& met) {
  alignas(16) float entry[8];
  store(entry, met.entries);
  const std::size_t begin = count;
  for (unsigned rest = met.of(node); rest; rest &= rest - 1) {
    const auto place = std::uint32_t(std::countr_zero(rest));
    std::size_t at = count++;
    for (; at > begin && t[at - 1] < entry[place]; --at) t[at] = t[at - 1], child[at] = child[at - 1];
    t[at] = entry[place];
    child[at] = child_at(node, index, place);
  }
}
#endif

// The place of one ray. It is in a braid, or in one of its trees, or in a tree alone.
struct Lane {
  std::uint32_t child;             // where it is: a node or an end
  const SurfaceTree::Node* nodes;  // of the braid or the tree
  const TreeRay* ray;
  float t_min;
  bool in_tree, any;
  TreeHit hit;         // of the tree; t is the end of the ray everywhere
  std::size_t bottom;  // of what waits in the tree
  TreeView tree;
  std::uint32_t owner;  // of the tree
  Braid::View braid;
  struct Outside {
    const TreeRay* ray;
    float t_min;
    Braid::View braid;
  };
  Outside outside[StreamRay::most_nested];  // of the leg
  std::size_t nested;
  StreamRay* traveller;
  Stack waiting;

  bool is_at_node() const { return !(child & is_end); }

  // False: the ray has no way.
  bool begin(StreamRay& next);
  // From a node to the nearest of its children that the ray may meet, or to what waits.
  void descend();
  // From an end; false: the ray has arrived.
  bool pass_end();
  void prefetch_end() const;

 private:
  bool begin_leg();
  void enter_leg(const StreamRay::Leg& leg);
  void leave_leg();
  bool go_to_place();
  void enter_tree(const Braid::Strand& strand);
  bool leave_tree();
  void enter_end();
};

[[gnu::noinline]] bool Lane::begin_leg() {
  StreamRay::Leg leg;
  if (!traveller->next(leg)) return false;
  hit = {traveller->t_max};
  waiting.count = 0;
  nested = 0;
  enter_leg(leg);
  return true;
}

MERISTEM_INLINE void Lane::enter_leg(const StreamRay::Leg& leg) {
  ray = leg.ray;
  t_min = leg.t_min;
  braid = leg.braid;
  if (braid.nodes) {
    in_tree = false;
    nodes = braid.nodes;
    child = 0;
    waiting.add_bottom();
  } else {
    enter_tree(leg.tree);
  }
}

// Back to the braid around it.
void Lane::leave_leg() {
  traveller->leave();
  const Outside& back = outside[--nested];
  ray = back.ray;
  t_min = back.t_min;
  braid = back.braid;
  nodes = braid.nodes;
  hit.t = traveller->t_max;
  child = waiting.take(hit.t);
}

bool Lane::begin(StreamRay& next) {
  traveller = &next;
  any = next.any;
  return begin_leg() && go_to_place();
}

MERISTEM_INLINE void Lane::enter_tree(const Braid::Strand& strand) {
  in_tree = true;
  tree = {strand.nodes, strand.triangles, strand.positions};
  nodes = strand.nodes;
  owner = strand.owner;
  child = strand.start;
  bottom = waiting.count;
  waiting.add_bottom();
  hit.triangle = TreeHit::none;
}

// Back to the braid; false: there is none around it.
MERISTEM_INLINE bool Lane::leave_tree() {
  if (hit.triangle != TreeHit::none) {
    traveller->met(owner, hit);
    hit.t = traveller->t_max;
  }
  in_tree = false;
  nodes = braid.nodes;
  waiting.count = bottom;
  if (!nodes) return false;
  child = waiting.take(hit.t);
  return true;
}

// Enters a tree, or whatever else stands at an end of a braid.
MERISTEM_INLINE void Lane::enter_end() {
  const OfBraid of{braid};
  const std::uint32_t end = child & ~is_end;
  if (of.is_strand(end)) return enter_tree(of.strand(end));
  StreamRay::Leg inside;
  if (nested == StreamRay::most_nested) {
    traveller->enter(of.other(end));
  } else if (traveller->enter(of.other(end), inside)) {
    outside[nested++] = {ray, t_min, braid};
    return enter_leg(inside);
  }
  hit.t = traveller->t_max;
  child = waiting.take(hit.t);
}

// To a node or a block.
MERISTEM_INLINE bool Lane::go_to_place() {
  while (!is_at_node()) {
    if (child == is_over) {
      if (in_tree && leave_tree()) continue;
      if (nested > 0)
        leave_leg();
      else if (!begin_leg())
        return false;
    } else if (in_tree) {
      return true;
    } else {
      enter_end();
    }
  }
  return true;
}

MERISTEM_INLINE bool Lane::pass_end() {
  if (in_tree && child != is_over) {
    if (meet_block<false>(tree, child & ~is_end, RayLanes(*ray, t_min), hit) && any) waiting.count = bottom + 1;
    child = waiting.take(hit.t);
  }
  return go_to_place();
}

MERISTEM_INLINE void Lane::prefetch_end() const {
  if (child == is_over) return;
  const SurfaceTree::Node& node = nodes[(child & ~is_end) / 8];
  if (in_tree)
    OfTree{tree}.prefetch(node, child % 8);
  else
    OfBraid{braid}.prefetch(node, child % 8);
}

MERISTEM_INLINE void Lane::descend() {
  const SurfaceTree::Node& node = nodes[child];
  waiting.add_children(node, child, meet_children(node, *ray, splat(t_min), hit.t));
  const std::uint32_t next = waiting.take(hit.t);
  const std::uint32_t ends = std::uint32_t(std::int32_t(next) >> 31);  // all bits of an end, none of a node
  prefetch_node(nodes[next & ~ends]);                                  // of the root for an end: no branch
  child = next;
}

// Lanes by where they are: those at nodes go on one after the other without a branch between them.
struct Lanes {
  Lane* at_node[RayStream::most_lanes];
  Lane* at_end[RayStream::most_lanes];
  int nodes = 0, ends = 0;

  MERISTEM_INLINE void add(Lane* lane) {
    const bool is_at_node = lane->is_at_node();
    at_node[nodes] = lane;
    at_end[ends] = lane;
    nodes += is_at_node;
    ends += !is_at_node;
  }
};

// The next ray that has a way at all.
[[gnu::noinline]] bool fill(RayStream& rays, int place, Lane& lane) {
  while (StreamRay* const next = rays.next(place))
    if (lane.begin(*next)) return true;
  return false;
}

void run_stream(RayStream& rays) {
  Lane lanes[RayStream::most_lanes];
  Lanes both[2], *now = &both[0], *next = &both[1];
  for (int i = 0; i < RayStream::most_lanes && fill(rays, i, lanes[i]); ++i) now->add(&lanes[i]);
  while (now->nodes + now->ends > 0) {
    next->nodes = next->ends = 0;
    for (int i = 0; i < now->nodes; ++i) {
      now->at_node[i]->descend();
      next->add(now->at_node[i]);
    }
    for (int i = 0; i < now->ends; ++i) {
      Lane& lane = *now->at_end[i];
      if (lane.pass_end() || fill(rays, int(&lane - lanes), lane)) next->add(&lane);
    }
    for (int i = 0; i < next->ends; ++i) next->at_end[i]->prefetch_end();
    std::swap(now, next);
  }
}

}  // namespace
}  // namespace meristem
