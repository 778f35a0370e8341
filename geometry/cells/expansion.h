// expand(): what comes of a cell: either its final surface, or its mesh some steps later, cut into child cells.
//
// The unit of lazy expansion. A pure function of the model and the cell's own data (mesh and halo): it traces no ray,
// takes no lock and waits for nothing, so any thread may expand any cell at any time, again after eviction, and get the
// same bits.
#pragma once

#include "geometry/cells/extract.h"
#include "geometry/cells/model.h"
#include "geometry/cells/tessellation.h"
#include "geometry/mesh/rings.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace meristem {

// A cell that is split: its mesh before step `level`, and the child cells as runs of `faces`.
struct InnerCell {
  CellMesh cell;
  PackedArrays packed;  // taken out of its mesh
  int level = 0;
  VertexFaces faces_around;                    // of its mesh
  std::vector<std::uint32_t> child_starts{0};  // into child_faces
  std::vector<std::uint32_t> child_faces;
  std::vector<Bounds3f> child_bounds;  // conservative, of everything that will come of the child
  std::vector<Key> child_keys;

  std::size_t child_count() const { return child_bounds.size(); }
  std::span<const std::uint32_t> faces_of_child(std::size_t child) const {
    return {child_faces.data() + child_starts[child], child_starts[child + 1] - child_starts[child]};
  }
  // The cell with all of its mesh.
  CellMesh whole() const;
  std::size_t bytes() const;
};

struct StepWork {
  std::uint64_t faces = 0;  // owned faces made
  double time_s = 0;
};

struct Expansion {
  std::optional<Tessellation> leaf;  // exactly one of
  std::unique_ptr<InnerCell> inner;  // these two
  CellMesh mesh;                     // of a leaf, if the model's settings ask for it; then its surface is empty
  std::vector<StepWork> work;        // by level; levels that did not run are zero
  std::uint64_t faces = 0;           // owned faces made, over all steps
};

// The cell that is the whole base mesh, and a child of a split cell with the halo it needs. A null footprint wants
// everything in full. Another `individual` than 0 salts the keys: another plant of the same kind.
CellMesh root_cell(const Model& model, const Footprint* footprint = nullptr, Key individual = 0);
CellMesh child_cell(const Model& model, const InnerCell& parent, std::size_t child);

// Expands a cell before step `level`; `uv_readers` as for tessellate(). Throws what a step throws (a rule that gives
// non-finite positions, a limit).
Expansion expand(const Model& model, CellMesh cell, int level, const UvReaders& uv_readers = {});

// Bounds of the whole model, before anything is expanded, whichever individual and footprint; and of one individual as
// seen with a footprint, which are closer where steps can derive them: the more of their levels, the closer, and the
// dearer (Step::derive).
Bounds3f model_bounds(const Model& model);
Bounds3f model_bounds(const Model& model, const Footprint* footprint, Key individual, int derived_levels);

}  // namespace meristem
