#include "geometry/tree/surface_tree.h"

#include "geometry/base/check.h"
#include "geometry/base/scratch.h"
#include "geometry/tree/tree_builder.h"
#include "geometry/tree/tree_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace meristem {

Key tie_key(const PositionView& positions, const std::array<std::uint32_t, 3>& corners) {
  Key key = 0;
  for (const std::uint32_t corner : corners) {
    const auto bits = std::bit_cast<std::array<std::uint32_t, 3>>(positions[corner]);
    key = hash_keys(key, Key(bits[0]) << 32 | bits[1], bits[2]);
  }
  return key;
}

bool wins_tie(const TreeView& tree, std::uint32_t a, std::uint32_t b) {
  const auto key = [&](std::uint32_t met) {
    return tie_key(tree.positions, SurfaceTree::triangle(tree.nodes, tree.triangles, met).corners);
  };
  const Key of_a = key(a), of_b = key(b);
  return of_a < of_b || (of_a == of_b && a < b);
}

bool wins_tie_in_block(const TreeView& tree, std::uint32_t block, int a, int b) {
  const SurfaceTree::Node& node = tree.nodes[block / 8];
  if (node.stride[block % 8] == 0 && a >= int(node.shape[block % 8])) return false;
  return wins_tie(tree, 8 * block + std::uint32_t(a), 8 * block + std::uint32_t(b));
}

const TreeKernels& best_tree_kernels() {
  static const TreeKernels& best = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                                           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2")
                                       ? avx2_tree_kernels()
                                       : baseline_tree_kernels();
  return best;
}

namespace {

template <class T>
void sort(std::vector<T>& list, const std::vector<std::uint32_t>& order) {
  Scratch<T> old(list.size());
  std::ranges::copy(list, old.data());
  list.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) list[i] = old[order[i]];
}

}  // namespace

SurfaceTree::SurfaceTree(Tessellation& tessellation, bool parallel) {
  thread_local BuiltTree built;  // what stays is copied: no tree leaves holes in the heap
  build_tree(tessellation, parallel, built);
  constexpr std::size_t most_nodes = std::size_t(1) << 26;  // TreeHit::triangle counts 64 to a node
  CHECK(built.nodes.size() < most_nodes, "{} nodes in one tree", built.nodes.size());
  nodes_.assign(built.nodes.begin(), built.nodes.end());
  sort(tessellation.triangles, built.triangles);
  sort(tessellation.triangle_sources, built.triangles);
  constexpr std::size_t most_kept = 8192;  // a mebibyte
  if (built.nodes.capacity() > most_kept || built.triangles.capacity() > 16 * most_kept) built = {};
  triangles_ = tessellation.triangles.data();
}

SurfaceTree::SurfaceTree(const SurfaceFaces& faces, std::vector<Node> nodes)
    : nodes_(std::move(nodes)), triangles_(faces.triangles.data()) {}

bool SurfaceTree::intersect(const PositionView& positions, const TreeRay& ray, float t_min, TreeHit& hit) const {
  if (nodes_.empty()) return false;
  return best_tree_kernels().intersect({nodes_.data(), triangles_, positions}, ray, t_min, hit);
}

bool SurfaceTree::occluded(const PositionView& positions, const TreeRay& ray, float t_min, float t_max) const {
  if (nodes_.empty()) return false;
  return best_tree_kernels().occluded({nodes_.data(), triangles_, positions}, ray, t_min, t_max);
}

SurfaceTree::Triangle SurfaceTree::triangle(const Node* nodes, const std::array<std::uint32_t, 3>* triangles,
                                            std::uint32_t met) {
  const Node& node = nodes[met / 64];
  const std::uint32_t child = met / 8 % 8, place = met % 8, first = node.first[child], stride = node.stride[child];
  if (stride == 0) return {triangles[first + place], first + place, none};
  const std::uint32_t quad = place % 4, v00 = first + quad % 2 + quad / 2 * stride, v10 = v00 + 1, v01 = v00 + stride,
                      v11 = v01 + 1;
  const std::uint32_t further = node.grids_further >> (4 * child) & 15,
                      grid = further < 15 ? node.grid + further : none;
  if (place < 4) return {{v00, v10, v01}, none, grid};
  return {{v11, v01, v10}, none, grid};
}

namespace {

// Of a child; rounded outwards, since a plane may have more digits than a float.
Bounds3f box_of(const SurfaceTree::Node& node, std::size_t child) {
  Bounds3f box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = std::ldexp(1., node.exponent[axis] - 127), origin = node.origin[axis];
    const double lower = origin + node.bounds[axis][0][child] * step,
                 upper = origin + node.bounds[axis][1][child] * step;
    const float near_lower = float(lower), near_upper = float(upper);
    box.lower[int(axis)] = near_lower > lower ? std::nextafter(near_lower, -INFINITY) : near_lower;
    box.upper[int(axis)] = near_upper < upper ? std::nextafter(near_upper, INFINITY) : near_upper;
  }
  return box;
}

}  // namespace

// From the root on, the largest box is divided that can be.
std::vector<SurfaceTree::Part> SurfaceTree::parts(std::size_t most) const {
  if (nodes_.empty()) return {};
  const auto area = [](const Part& p) { return p.start & is_block ? 0 : p.box.surface_area(); };
  std::vector<Part> parts{{{}, 0}};
  for (auto largest = parts.begin(); !(largest->start & is_block);) {
    const std::uint32_t index = largest->start;
    const Node& node = nodes_[index];
    if (parts.size() - 1 + node.children > most) break;
    parts.erase(largest);
    for (std::uint32_t c = 0; c < node.children; ++c)
      parts.push_back({box_of(node, c), node.shape[c] == 0 ? node.first[c] : (8 * index + c) | is_block});
    largest = std::ranges::max_element(parts, {}, area);
  }
  return parts;
}

std::size_t SurfaceTree::bytes() const { return nodes_.capacity() * sizeof(Node); }

}  // namespace meristem
