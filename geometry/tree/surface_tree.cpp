#include "geometry/tree/surface_tree.h"

#include "geometry/tree/tree_builder.h"
#include "geometry/tree/tree_kernels.h"

namespace meristem {

const TreeKernels& best_tree_kernels() {
  static const TreeKernels& best = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                                           __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2")
                                       ? avx2_tree_kernels()
                                       : baseline_tree_kernels();
  return best;
}

SurfaceTree::SurfaceTree(Tessellation& tessellation, bool parallel) {
  BuiltTree built = build_tree(tessellation, parallel);
  nodes_ = std::move(built.nodes);
  nodes_.shrink_to_fit();
  auto sort = [&](auto& list) {
    std::remove_reference_t<decltype(list)> sorted;
    sorted.reserve(list.size());
    for (std::uint32_t i : built.triangles) sorted.push_back(list[i]);
    list.swap(sorted);
  };
  sort(tessellation.triangles);
  sort(tessellation.triangle_sources);
  triangles_ = tessellation.triangles.data();
}

bool SurfaceTree::intersect(const Vec3f* positions, const TreeRay& ray, float t_min, TreeHit& hit) const {
  if (nodes_.empty()) return false;
  return best_tree_kernels().intersect({nodes_.data(), triangles_, positions}, ray, t_min, hit);
}

bool SurfaceTree::occluded(const Vec3f* positions, const TreeRay& ray, float t_min, float t_max) const {
  if (nodes_.empty()) return false;
  return best_tree_kernels().occluded({nodes_.data(), triangles_, positions}, ray, t_min, t_max);
}

SurfaceTree::Triangle SurfaceTree::triangle(std::uint32_t met) const {
  const Node& node = nodes_[met / 64];
  const std::uint32_t child = met / 8 % 8, place = met % 8, first = node.first[child], stride = node.stride[child];
  if (stride == 0) return {triangles_[first + place], first + place, none};
  const std::uint32_t quad = place % 4, v00 = first + quad % 2 + quad / 2 * stride, v10 = v00 + 1, v01 = v00 + stride,
                      v11 = v01 + 1;
  if (place < 4) return {{v00, v10, v01}, none, node.grid};
  return {{v11, v01, v10}, none, node.grid};
}

std::size_t SurfaceTree::bytes() const { return nodes_.capacity() * sizeof(Node); }

}  // namespace meristem
