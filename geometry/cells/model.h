// Model: a base mesh and the steps that make an object of it; what a scene file describes in a few kilobytes.
// Built once at load, then read-only: any thread may expand cells of it.
#pragma once

#include "geometry/cells/step.h"

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace meristem {

// How a model is cut into cells. What rays meet does not depend on it (but for SurfaceHit::level); speed and memory do.
struct CellSettings {
  // Final faces of a leaf cell: fewer, and rays meet more boxes and every cell has more halo than surface; more, and
  // what a ray asks for drags along what none does. Of 1024, 2048 and 4096 the second was fastest on whole pictures.
  std::uint32_t leaf_faces = 2048;
  std::uint32_t inner_faces = 8192;  // an expansion stops to split when it would hold more
  bool keeps_leaf_meshes = false;    // for placing parts on the final faces, instead of surfaces
};

// The scheme whose limit surface a mesh is taken for.
struct Smoothing {
  RefineOptions scheme;
  bool is_refined =
      false;        // whether that scheme has made the mesh, so that its faces are as the limit's masks want them
  Quantum quantum;  // of the model
};

class Model {
 public:
  // Chooses the quantum from the bounds of all that will grow, tells the steps and rounds the base to it. The base must
  // be manifold and not empty. Throws std::runtime_error if the bounds are not finite (a rule without bound).
  Model(std::string name, Mesh base, std::vector<std::unique_ptr<Step>> steps, CellSettings settings = {});

  const std::string& name() const { return name_; }
  const CellMesh& base() const { return base_; }
  int levels() const { return int(steps_.size()); }
  const Step& step(int level) const { return *steps_[std::size_t(level)]; }
  const Quantum& quantum() const { return quantum_; }
  // How far the planes may be apart to whose crossings shown vertices are rounded (position_lattice.h): 2^-18 of a
  // power of two above the reach of all that will grow, in full.
  double coarsest_lattice() const { return coarsest_lattice_; }
  const CellSettings& settings() const { return settings_; }

  // Rings of halo a cell needs before step `level` (levels(): of the final mesh).
  int halo_rings(int level) const { return halo_rings_[std::size_t(level)]; }
  // Of everything that may come of it, whichever individual and footprint. Found when they are first asked for (some
  // 0.1 us a face of the base): several placers may ask those of one ground.
  const Bounds3f& bounds() const;
  // The number of refining steps from `level` to the end without another kind of step in between the end.
  int trailing_refinements(int level) const;
  // An upper bound on the final faces of one face before step `level`; at most 1e18.
  double estimated_faces(std::uint32_t corners, std::int32_t symbol, int level) const;
  // The sum of these bounds over all faces of the base. Linear.
  double estimated_faces() const;
  // An upper bound on how far anything that will ever grow on a face reaches beyond it, from `level` on. `radius`: of
  // its corners around its centroid. Where it is more than `enough`, any number above that. Some microseconds a level.
  double growth_reach(const FaceOrigin& origin, const Bounds3d& face, double radius, int level,
                      double enough = INFINITY) const;
  // What the steps from `level` on may still add, where the local scale before them is `scale`: the sum of their
  // longest displacements. An estimate: that refinement halves the scale is not exact. From a table.
  double remaining_offset(int level, double scale) const;
  // Whether faces may be dropped at `level` or later.
  bool drops_faces_later(int level) const;
  // Whether anything that grows at `level` or later may be enlarged where it thins.
  bool enlarges_later(int level) const;
  // Whether exactly two refinements lie between `level` and the last step before it that does not refine.
  bool is_two_refinements_in(int level) const;
  // What is shown of a mesh before step `level` on which nothing grows any more: the limit surface, if nothing but
  // plain smoothing lies ahead or, at the end, lies behind; else the mesh itself.
  std::optional<Smoothing> smoothing(int level) const;
  // The scheme of the first step at `level` or later that refines.
  std::optional<Scheme> next_scheme(int level) const;
  // Whether that is Loop's, and after it Catmull-Clark follows.
  bool makes_quads_of_triangles_later(int level) const;
  // The first step at `level` or later that replaces faces with this symbol; levels(): none does.
  int growing_step(std::int32_t symbol, int level) const;
  bool grows_later(std::int32_t symbol, int level) const { return growing_step(symbol, level) < levels(); }

 private:
  std::string name_;
  CellMesh base_;
  std::vector<std::unique_ptr<Step>> steps_;
  Quantum quantum_;
  double coarsest_lattice_ = 0;
  CellSettings settings_;
  void find_remaining_offsets();
  double count_faces(std::uint32_t corners, bool may_grow, int level) const;

  std::vector<int> halo_rings_;
  Extent base_extent_;
  // By level and by the power of two of the scale, from the smallest on.
  int smallest_exponent_ = 0;
  std::vector<std::vector<double>> remaining_offsets_;
  std::vector<double> faces_of_quad_;  // by level, of one on which nothing grows
  mutable std::once_flag has_bounds_;
  mutable Bounds3f bounds_;
};

// Bounds of everything that will ever come of a region, roundings included but for that of what is shown: the extent
// carried through all steps from `level` on.
Bounds3d final_bounds(const Model& model, Extent extent, int level);

}  // namespace meristem
