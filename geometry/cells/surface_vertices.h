// SurfaceVertices: the vertices of a resident surface on as few bytes as they need. There are millions of them.
//
// Positions take 6 bytes instead of 12 where they lie on a lattice of at most 65536 planes an axis, as those that
// PositionLattice has rounded do unless the surface is very large for its faces: nothing is lost by packing. Normals
// take 4, and u, v 4 more if they are wanted. Immutable; any thread.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/cells/packing.h"
#include "geometry/cells/position_view.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meristem {

class SurfaceVertices {
 public:
  SurfaceVertices() = default;
  SurfaceVertices(std::vector<Vec3f> positions, std::span<const PackedAttributes> attributes, bool has_uv);
  SurfaceVertices(const SurfaceVertices&) = delete;
  SurfaceVertices(SurfaceVertices&&) = default;
  SurfaceVertices& operator=(SurfaceVertices&&) = default;

  std::size_t size() const { return size_; }
  bool has_uv() const { return words_a_vertex_ == 2; }
  PositionView positions() const {
    return is_packed() ? PositionView(packed_.data(), bounds_.lower, lattice_step_) : PositionView(loose_.data());
  }
  // The normal, and behind it u, v if there are any.
  const std::uint32_t* attributes(std::size_t vertex) const { return &attributes_[words_a_vertex_ * vertex]; }
  const Bounds3f& bounds() const { return bounds_; }
  std::size_t bytes() const;  // beside itself

  // What is no array, for files.
  struct Layout {
    Bounds3f bounds;
    float lattice_step;
    std::uint32_t words_a_vertex;
    std::uint64_t size;
  };
  Layout layout() const { return {bounds_, lattice_step_, words_a_vertex_, size_}; }
  void set_layout(const Layout& layout);
  // Calls visit(array, i) for each of its arrays, from number `first` on. Files may end behind their last number.
  static constexpr std::size_t arrays = 3;
  template <class Vertices, class Visit>
  static void for_each_array(Vertices& vertices, std::size_t first, const Visit& visit) {
    visit(vertices.loose_, first), visit(vertices.packed_, first + 1), visit(vertices.attributes_, first + 2);
  }

 private:
  bool is_packed() const { return lattice_step_ > 0; }
  bool pack(std::span<const Vec3f> positions);

  // One of the two; with room to read behind the last vertex.
  std::vector<Vec3f> loose_;
  std::vector<std::uint16_t> packed_;
  std::vector<std::uint32_t> attributes_;
  Bounds3f bounds_;         // of the positions; the lattice begins at its lower corner
  float lattice_step_ = 0;  // 0: not packed
  std::uint32_t words_a_vertex_ = 2;
  std::uint64_t size_ = 0;
};

}  // namespace meristem
