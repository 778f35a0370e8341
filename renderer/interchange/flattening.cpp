#include "renderer/interchange/flattening.h"

#include <algorithm>
#include <utility>

namespace meristem {

void Flattening::begin(std::span<const Affine3d> places, std::uint64_t first) {
  places_.clear();
  for (const Affine3d& m : places) places_.push_back({m, m.inverse(), m.determinant() < 0});
  first_ = first;
  block_starts_.clear();
  vertices_ = 0;
}

void Flattening::add_block(std::size_t vertices) {
  block_starts_.push_back(vertices_);
  vertices_ += std::uint32_t(vertices);
}

std::uint64_t Flattening::number(std::uint32_t vertex, std::size_t place) const {
  const auto next = std::upper_bound(block_starts_.begin(), block_starts_.end(), vertex);
  const std::uint64_t start = *std::prev(next), end = next == block_starts_.end() ? vertices_ : *next;
  return first_ + places_.size() * start + place * (end - start) + (vertex - start);
}

MeshVertex Flattening::Place::apply(const MeshVertex& v) const {
  MeshVertex result = v;
  result.position = Vec3f(to_world.point(Vec3d(v.position)));
  result.normal = Vec3f(normalize(from_world.transposed_vector(Vec3d(v.normal))));
  return result;
}

std::array<std::uint32_t, 3> Flattening::Place::corners(const MeshTriangle& triangle) const {
  std::array<std::uint32_t, 3> result = triangle.vertices;
  if (mirrors) std::swap(result[1], result[2]);
  return result;
}

}  // namespace meristem
