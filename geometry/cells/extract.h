// Cutting meshes into cells: a part of a mesh as a mesh of its own.
#pragma once

#include "geometry/mesh/face_origins.h"
#include "geometry/mesh/mesh.h"

#include <span>

namespace meristem {

// The listed faces, in this order, with the vertices they use (in order of first use) and all attributes.
// Origins are kept in use order too. Linear in the faces listed plus one table over the mesh's vertices.
Mesh extract_faces(const Mesh& mesh, std::span<const std::uint32_t> faces);

// The u, v of corners: those that meet in a vertex mostly agree, and share theirs.
class CornerUvs {
 public:
  CornerUvs() = default;
  explicit CornerUvs(const Mesh& mesh);
  bool empty() const { return number_of_.empty(); }
  std::size_t size() const { return number_of_.size(); }
  Vec2d operator[](std::size_t corner) const { return values_[number_of_[corner]]; }
  std::size_t bytes() const { return 4 * number_of_.capacity() + sizeof(Vec2d) * values_.capacity(); }

 private:
  std::vector<std::uint32_t> number_of_;
  std::vector<Vec2d> values_;
};

// What is large in a mesh and only wanted when a part of it is cut out.
struct PackedArrays {
  FaceOrigins origins;
  CornerUvs corner_uv;

  // Takes them out of the mesh, and puts them back into a copy.
  static PackedArrays out_of(Mesh& mesh);
  Mesh back_in(const Mesh& mesh) const;
  std::size_t bytes() const { return origins.bytes() + corner_uv.bytes(); }
};
// Of a mesh that they were taken out of.
Mesh extract_faces(const Mesh& mesh, const PackedArrays& packed, std::span<const std::uint32_t> faces);

}  // namespace meristem
