#include "geometry/cells/extract.h"

#include "geometry/cells/numbering.h"

#include <type_traits>

namespace meristem {

namespace {

template <class List>
auto gather(const List& from, std::span<const std::uint32_t> indices) {
  std::vector<std::remove_cvref_t<decltype(from[0])>> result;
  if (from.empty()) return result;
  result.reserve(indices.size());
  for (std::uint32_t i : indices) result.push_back(from[i]);
  return result;
}

template <class Origins, class Uvs>
Mesh extract(const Mesh& mesh, const Origins& face_origins, const Uvs& corner_uv,
             std::span<const std::uint32_t> faces) {
  Mesh part;
  std::size_t corner_count = 0;
  for (std::uint32_t f : faces) corner_count += mesh.corner_count(f);
  std::vector<std::uint32_t> corners;
  for (auto* list : {&corners, &part.corner_vertices}) list->reserve(corner_count);
  for (auto* list : {&part.face_starts, &part.face_origins}) list->reserve(faces.size() + 1);
  part.face_keys.reserve(faces.size());
  Numbering vertices(corner_count / 4), origins(faces.size() / 8);
  for (std::uint32_t f : faces) {
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      part.corner_vertices.push_back(vertices.add(mesh.corner_vertices[c]).number);
      corners.push_back(c);
    }
    part.face_starts.push_back(std::uint32_t(part.corner_vertices.size()));
    part.face_keys.push_back(mesh.face_keys[f]);
    part.face_origins.push_back(origins.add(mesh.face_origins[f]).number);
  }
  part.corner_uv = gather(corner_uv, corners);
  part.corner_sharpness = gather(mesh.corner_sharpness, corners);
  part.positions = gather(mesh.positions, vertices.indices());
  part.vertex_keys = gather(mesh.vertex_keys, vertices.indices());
  part.uv = gather(mesh.uv, vertices.indices());
  part.vertex_sharpness = gather(mesh.vertex_sharpness, vertices.indices());
  part.nominal_scale = gather(mesh.nominal_scale, vertices.indices());
  part.frozen = gather(mesh.frozen, vertices.indices());
  part.fading = gather(mesh.fading, vertices.indices());
  part.enlargements = gather(mesh.enlargements, faces);
  part.seam_widths = gather(mesh.seam_widths, faces);
  part.origins = gather(face_origins, origins.indices());
  return part;
}

}  // namespace

Mesh extract_faces(const Mesh& mesh, std::span<const std::uint32_t> faces) {
  return extract(mesh, mesh.origins, mesh.corner_uv, faces);
}

Mesh extract_faces(const Mesh& mesh, const PackedArrays& packed, std::span<const std::uint32_t> faces) {
  return extract(mesh, packed.origins, packed.corner_uv, faces);
}

CornerUvs::CornerUvs(const Mesh& mesh) {
  if (mesh.corner_uv.empty()) return;
  constexpr std::uint32_t none = ~std::uint32_t(0);
  std::vector<std::uint32_t> last(mesh.vertex_count(), none);
  number_of_.reserve(mesh.corner_uv.size());
  for (std::size_t c = 0; c < mesh.corner_uv.size(); ++c) {
    std::uint32_t& number = last[mesh.corner_vertices[c]];
    if (number == none || values_[number] != mesh.corner_uv[c]) {
      number = std::uint32_t(values_.size());
      values_.push_back(mesh.corner_uv[c]);
    }
    number_of_.push_back(number);
  }
  values_.shrink_to_fit();
}

PackedArrays PackedArrays::out_of(Mesh& mesh) {
  PackedArrays packed{FaceOrigins(mesh.origins), CornerUvs(mesh)};
  mesh.origins = {};
  mesh.corner_uv = {};
  return packed;
}

Mesh PackedArrays::back_in(const Mesh& mesh) const {
  Mesh whole = mesh;
  for (std::size_t i = 0; i < origins.size(); ++i) whole.origins.push_back(origins[i]);
  for (std::size_t c = 0; c < corner_uv.size(); ++c) whole.corner_uv.push_back(corner_uv[c]);
  return whole;
}

}  // namespace meristem
