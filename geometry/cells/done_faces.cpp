#include "geometry/cells/done_faces.h"

#include "geometry/cells/extract.h"

#include <algorithm>

namespace meristem {

namespace {

// Cells whose faces are few anyway, or mostly go on, keep a shape whose tables others may have made already.
constexpr std::uint32_t few_faces = 16;
constexpr double worth_taking = 0.5;

bool is_done(const Model& model, const Mesh& mesh, std::uint32_t face, int level) {
  return std::ranges::all_of(mesh.corners(face), [&](std::uint32_t v) { return mesh.frozen[v].is_frozen; }) &&
         !model.grows_later(mesh.origins[mesh.face_origins[face]].symbol, level);
}

}  // namespace

std::optional<DoneFaces> take_done_faces(const Model& model, CellMesh& cell, int level, Squares& squares) {
  const Mesh& mesh = cell.mesh;
  if (mesh.frozen.empty() || cell.owned_faces < few_faces) return {};
  DoneFaces done{{}, level, {{}, squares.refinements}};
  Squares rest{{}, squares.refinements};
  std::vector<std::uint32_t> done_faces, others;
  std::uint32_t first = 0;
  for (std::uint32_t corners : squares.corners) {
    const std::uint32_t end = first + squares.faces_of(corners);
    bool all_done = true;
    for (std::uint32_t f = first; f < end && all_done; ++f) all_done = is_done(model, mesh, f, level);
    (all_done ? done.squares : rest).corners.push_back(corners);
    for (; first < end; ++first) (all_done ? done_faces : others).push_back(first);
  }
  if (double(done_faces.size()) < worth_taking * cell.owned_faces) return {};
  done.mesh = extract_faces(mesh, done_faces);
  cell = cell_of_faces(cell, others, model.halo_rings(level));
  squares = std::move(rest);
  return done;
}

}  // namespace meristem
