#include "geometry/cells/extract.h"

#include <unordered_map>

namespace meristem {

namespace {

// Numbers old indices in the order in which they are first asked for.
class Renumbering {
 public:
  std::uint32_t operator()(std::uint32_t old) {
    const auto [it, is_new] = index_.try_emplace(old, std::uint32_t(old_.size()));
    if (is_new) old_.push_back(old);
    return it->second;
  }
  const std::vector<std::uint32_t>& old() const { return old_; }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> index_;
  std::vector<std::uint32_t> old_;
};

template <class T>
std::vector<T> gather(const std::vector<T>& from, const std::vector<std::uint32_t>& indices) {
  std::vector<T> result;
  if (from.empty()) return result;
  result.reserve(indices.size());
  for (std::uint32_t i : indices) result.push_back(from[i]);
  return result;
}

}  // namespace

Mesh extract_faces(const Mesh& mesh, std::span<const std::uint32_t> faces) {
  Mesh part;
  Renumbering vertices, origins;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t f : faces) {
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      part.corner_vertices.push_back(vertices(mesh.corner_vertices[c]));
      corners.push_back(c);
    }
    part.face_starts.push_back(std::uint32_t(part.corner_vertices.size()));
    part.face_keys.push_back(mesh.face_keys[f]);
    part.face_origins.push_back(origins(mesh.face_origins[f]));
  }
  part.corner_uv = gather(mesh.corner_uv, corners);
  part.corner_sharpness = gather(mesh.corner_sharpness, corners);
  part.positions = gather(mesh.positions, vertices.old());
  part.vertex_keys = gather(mesh.vertex_keys, vertices.old());
  part.uv = gather(mesh.uv, vertices.old());
  part.vertex_sharpness = gather(mesh.vertex_sharpness, vertices.old());
  part.nominal_scale = gather(mesh.nominal_scale, vertices.old());
  part.frozen = gather(mesh.frozen, vertices.old());
  part.origins = gather(mesh.origins, origins.old());
  return part;
}

}  // namespace meristem
