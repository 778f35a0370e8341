// Extent: what is known of a region of a mesh before the next step: enough to bound everything that will ever come of
// it. Carried through the steps by Step::bound(); plain data.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/fields/expression.h"
#include "geometry/mesh/face_origin.h"

#include <array>
#include <vector>

namespace meristem {

// A symbol that stands on some of the region's faces, and the range of its parameters.
struct SymbolRange {
  std::int32_t symbol = -1;
  std::array<Interval, max_growth_parameters> parameters{};
  // The largest distance of a corner of such a face from its centroid, but for its enlargement.
  float radius = 0;
  Interval enlargement{1, 1};  // of the faces (thinning.h)
  // What grows on faces that are enlarged reaches no further than so, however much they are.
  double enlarged_reach = 0;
};

// Bounds on |longest edge after| / |longest edge before| of one smoothing: of quads around vertices of valence 4
// without creases, of quads around any vertex, and of faces of any size (for these "edge" is the largest distance of
// two corners).
constexpr double regular_contraction = 0.5;
constexpr double worst_contraction = 1.0;
constexpr double worst_first_contraction = 1.42;

struct Extent {
  Bounds3d box;  // of the control points that the owned faces depend on (owned faces and ring 1)
  // Of those after the next step, which is a refinement (if none follows: of the surface that is shown), but for its
  // displacement; empty: not known better than by `box`.
  Bounds3d refined_box;
  // Of the smooth surface, within two rings:
  double edge = 0;      // the longest edge
  double edge_sum = 0;  // the longest edge of one direction plus the longest of the other; at most 2 * edge
  double contraction = worst_first_contraction;  // of edges under the next smoothing
  double next_contraction = worst_contraction;   // of edges under all smoothings after it
  // Of what displacement has added to it:
  double ripple = 0;       // the longest edge of the displacement as a surface of its own
  double last_offset = 0;  // the longest displacement of the last step
  Interval u, v;
  // The largest size of a wanted face anywhere in the region, which says how large what thins may become; 0: everything
  // is wanted in full, so that nothing does.
  double footprint = 0;
  std::vector<SymbolRange> symbols;  // those with a production in a later step

  // After a step that may have made vertices and faces of any shape: nothing is known of directions and valences.
  void forget_shape();
  // A bound on the local scale after the next smoothing, before its displacement.
  double refined_scale() const;
  // Where the next smoothing, before its displacement, puts the control points.
  const Bounds3d& smooth_box() const { return refined_box.empty() ? box : refined_box; }
  // Carries box and edges through a smoothing and a displacement by vectors between `down` (not positive) and `up` (not
  // negative), of a length of at most `longest`.
  void refine(Vec3d down, Vec3d up, double longest);
};

}  // namespace meristem
