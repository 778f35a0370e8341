// Step: one level of a model's derivation: M(n) -> M(n+1), over the whole mesh or over the mesh of one cell.
//
// A step is a pure function of the faces it is given: the children of a face, and the vertices they own, come out with
// the same bits in every cell that holds the face and enough neighbours. A model's steps are made at load, one object a
// level, and then only read: any thread may apply them to any cell at the same time.
#pragma once

#include "geometry/cells/extent.h"
#include "geometry/cells/footprint.h"
#include "geometry/mesh/mesh.h"
#include "geometry/mesh/quantum.h"
#include "geometry/mesh/refine_plan.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace meristem {

class VertexFaces;

// A mesh with a border region: faces [0, owned_faces) are the cell's own, the others its halo. `rings[f]` is the
// distance of face f from the owned ones by shared vertices (0 for these, 1 for those that touch one, ...). An eager or
// base mesh has no halo.
struct CellMesh {
  Mesh mesh;
  std::uint32_t owned_faces = 0;
  std::vector<std::uint8_t> rings;  // one a face; ascending
  // Empty, or one an owned face: a number that steps hand on to all that comes of the face.
  std::vector<std::uint32_t> labels{};
  // How coarse it may be; null: everything in full. Must outlive the cell. Not carried along by steps.
  const Footprint* footprint = nullptr;
};

// Bounds of what comes of a face after so many steps.
struct DerivedBounds {
  Bounds3d box;
  int levels = 0;
};

class Step {
 public:
  virtual ~Step() = default;

  // For statistics and reports: "grow 2", "subdivide 3 (placed)".
  virtual std::string name() const = 0;
  // Rings of halo that the input needs so that the output has `rings_after` complete rings.
  virtual int halo_rings(int rings_after) const = 0;
  // The most faces that one face with `corners` corners becomes.
  virtual std::uint32_t max_children(std::uint32_t corners) const = 0;
  // Applies the step. Output faces stand grouped by parent in the parents' order; owned children come first; halo
  // beyond `rings_after` is dropped, as are vertices that no face uses.
  virtual void apply(const CellMesh& in, int rings_after, CellMesh& out) const = 0;
  // The extent after the step of everything that comes of a region with extent `e`.
  virtual Extent bound(const Extent& e) const = 0;
  // Bounds of all that this step and those after it make of a face that it grows and that shares no vertex with others,
  // found by deriving it without meshes: tighter than bound(), since they are those of this face's key. The first
  // `levels` levels are derived, from this on, and what grows on them is bounded for any key. None: it cannot.
  virtual std::optional<DerivedBounds> derive(const CellMesh& cell, std::uint32_t face, int levels) const {
    (void)cell, (void)face, (void)levels;
    return {};
  }
  // The longest displacement after refining a part of that extent to a local scale of at most `scale`.
  virtual double offset_bound(const Extent& before, double scale) const {
    (void)before, (void)scale;
    return 0;
  }
  // Whether faces with this symbol are replaced by this step.
  virtual bool grows(std::int32_t symbol) const {
    (void)symbol;
    return false;
  }
  // What the scene calls a symbol that it grows; for reports.
  virtual std::string symbol_name(std::int32_t symbol) const {
    (void)symbol;
    return {};
  }
  // Whether the step itself makes less of what is smaller than the cell's footprint, so that nothing is to be left out
  // before it.
  virtual bool thins() const { return false; }
  // Below how many footprints what grows on faces with this symbol is thinned before the step (thinning.h); 0: it is
  // not.
  virtual double thinning(std::int32_t symbol) const {
    (void)symbol;
    return 0;
  }
  // Whether there is any such symbol.
  virtual bool enlarges() const { return false; }
  // About how many final faces come of one with that origin where faces are wanted `footprint` large, if each that can
  // be refined further becomes `refined`.
  virtual double thinned_faces(const FaceOrigin& origin, double footprint, double refined) const {
    (void)origin, (void)footprint, (void)refined;
    return 0;
  }
  // Told once, by the model's constructor, before any apply(): the grid on which it must place vertices.
  virtual void set_quantum(const Quantum& quantum) { (void)quantum; }
  // What vertices are rounded to that the step shows for good, as it freezes them: Model::coarsest_lattice().
  virtual void set_shown_quantum(const Quantum& quantum) { (void)quantum; }
  // Whether vertices are moved off the scheme's smooth position (so that no limit is known).
  virtual bool displaces() const { return false; }
  virtual bool refines() const { return false; }
  // Whether owned faces may leave the cell, to stand in its halo alone, so that nothing is shown of a mesh before it.
  virtual bool drops_faces() const { return false; }
  // The scheme by which it refines. After a last step that says so and does not displace, the final vertices are moved
  // to the limit surface.
  virtual std::optional<RefineOptions> refinement() const { return {}; }
};

// A cell of the listed owned faces of another (ascending). All others become its halo as far as `max_ring` rings reach;
// faces beyond are dropped, as are vertices that no face uses. Computes rings[]; faces stay in order but are sorted by
// ring (stable).
CellMesh cell_of_faces(const CellMesh& cell, std::span<const std::uint32_t> owned, int max_ring);
// The same, linear in what is cut out instead of in the whole.
CellMesh cell_of_faces(const CellMesh& cell, std::span<const std::uint32_t> owned, int max_ring,
                       const VertexFaces& faces_around);

// Drops what lies beyond so many rings of the owned faces, in the same way.
void trim_halo(CellMesh& cell, int max_ring);

}  // namespace meristem
