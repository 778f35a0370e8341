// Flattening: numbers for the vertices of a surface that stands in several places, in formats without instances. Each
// block of vertices is written once for each place, so the surface is expanded once and need not be kept.
#pragma once

#include "renderer/interchange/mesh_writer.h"

namespace meristem {

class Flattening {
 public:
  // `first`: vertices in the file so far.
  void begin(std::span<const Affine3d> places, std::uint64_t first);
  // The next vertices of the surface.
  void add_block(std::size_t vertices);
  // The number in the file of a vertex of the surface, in one of the places.
  std::uint64_t number(std::uint32_t vertex, std::size_t place) const;

  struct Place {
    Affine3d to_world, from_world;
    bool mirrors = false;
    MeshVertex apply(const MeshVertex& v) const;
    // Counter-clockwise seen from outside in a mirror, too.
    std::array<std::uint32_t, 3> corners(const MeshTriangle& triangle) const;
  };
  const std::vector<Place>& places() const { return places_; }

 private:
  std::vector<Place> places_;
  std::uint64_t first_ = 0;
  std::vector<std::uint32_t> block_starts_;
  std::uint32_t vertices_ = 0;
};

}  // namespace meristem
