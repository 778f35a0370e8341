#include "geometry/accel/leaf_store.h"

#include <array>
#include <type_traits>
#include <utility>

namespace meristem {

namespace {

constexpr std::size_t arrays = 5 + SurfaceVertices::arrays + FaceOrigins::arrays;

// What stands before the arrays of a surface in the file.
struct Header {
  std::array<std::uint64_t, arrays> sizes;
  std::uint64_t face_count;
  SurfaceVertices::Layout vertices;
  CellLabel label;
};
static_assert(std::is_trivially_copyable_v<Header>);

// Calls visit(array, i) for each array of a surface and its tree.
template <class Faces, class Vertices, class Nodes, class Visit>
void for_each_array(Faces& faces, Vertices& vertices, Nodes& nodes, const Visit& visit) {
  visit(faces.grids, 0), visit(faces.triangles, 1), visit(faces.triangle_sources, 2), visit(faces.leaves, 3);
  visit(nodes, 4);
  SurfaceVertices::for_each_array(vertices, 5, visit);
  FaceOrigins::for_each_array(faces.origins, 5 + SurfaceVertices::arrays, visit);
}

template <class T>
iovec part_of(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {const_cast<T*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

LeafStore::~LeafStore() {
  for (const auto& [name, block] : blocks_) file_.free(block);
  file_.add_index_bytes(-node_bytes * std::ptrdiff_t(blocks_.size()));
}

void LeafStore::keep(Key name, const SurfacePatch& patch, const CellLabel& label) {
  {
    const std::lock_guard lock(mutex_);
    if (blocks_.contains(name)) return;
  }
  Header header{{}, patch.faces().face_count, patch.vertices().layout(), label};
  std::vector<iovec> parts{{&header, sizeof(header)}};
  for_each_array(patch.faces(), patch.vertices(), patch.tree().nodes(), [&](const auto& values, std::size_t i) {
    header.sizes[i] = values.size();
    parts.push_back(part_of(values));
  });
  const ScratchFile::Block block = file_.write(std::move(parts));
  if (block.bytes == 0) return;
  const std::lock_guard lock(mutex_);
  if (blocks_.emplace(name, block).second)
    file_.add_index_bytes(node_bytes);
  else
    file_.free(block);  // another thread was first
}

std::optional<LeafStore::Leaf> LeafStore::find(Key name) const {
  ScratchFile::Block block;
  {
    const std::lock_guard lock(mutex_);
    const auto at = blocks_.find(name);
    if (at == blocks_.end()) return {};
    block = at->second;
  }
  Header header;
  if (!file_.read(block, 0, {{&header, sizeof(header)}})) return {};
  SurfaceFaces faces;
  SurfaceVertices vertices;
  std::vector<SurfaceTree::Node> nodes;
  faces.face_count = header.face_count;
  vertices.set_layout(header.vertices);
  std::vector<iovec> parts;
  for_each_array(faces, vertices, nodes, [&](auto& values, std::size_t i) {
    values.resize(header.sizes[i]);
    parts.push_back(part_of(values));
  });
  if (!file_.read(block, sizeof(header), std::move(parts))) return {};
  file_.count_read_back();
  return Leaf{std::make_unique<SurfacePatch>(std::move(faces), std::move(vertices), std::move(nodes)), header.label};
}

}  // namespace meristem
