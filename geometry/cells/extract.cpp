#include "geometry/cells/extract.h"

#include "geometry/cells/numbering.h"

namespace meristem {

namespace {

template <class T>
std::vector<T> gather(const std::vector<T>& from, std::span<const std::uint32_t> indices) {
  std::vector<T> result;
  if (from.empty()) return result;
  result.reserve(indices.size());
  for (std::uint32_t i : indices) result.push_back(from[i]);
  return result;
}

}  // namespace

Mesh extract_faces(const Mesh& mesh, std::span<const std::uint32_t> faces) {
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
  part.corner_uv = gather(mesh.corner_uv, corners);
  part.corner_sharpness = gather(mesh.corner_sharpness, corners);
  part.positions = gather(mesh.positions, vertices.indices());
  part.vertex_keys = gather(mesh.vertex_keys, vertices.indices());
  part.uv = gather(mesh.uv, vertices.indices());
  part.vertex_sharpness = gather(mesh.vertex_sharpness, vertices.indices());
  part.nominal_scale = gather(mesh.nominal_scale, vertices.indices());
  part.frozen = gather(mesh.frozen, vertices.indices());
  part.fading = gather(mesh.fading, vertices.indices());
  part.enlargements = gather(mesh.enlargements, faces);
  part.origins = gather(mesh.origins, origins.indices());
  return part;
}

}  // namespace meristem
