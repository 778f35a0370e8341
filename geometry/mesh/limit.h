// Limit surface: where the vertices of a smoothed mesh would come to lie, and the surface's normals there, if smoothing
// went on for ever.
//
// Masks: Catmull-Clark after Halstead, Kass and DeRose 1993, Loop after Hoppe et al. 1994, as in OpenSubdiv's
// Sdc::Scheme; along creases the cubic B-spline, with tangents across them by the eigenvectors of the rules in use.
// Edges that are still sharp count as sharp for ever; where such a crease ends within the surface, its last vertex
// counts as smooth (both an approximation, better with each level). A vertex holds one normal: where the surface has a
// ridge (a crease or corner within it) that is the mean of the normals of its sides.
//
// Every vertex comes out with the same bits from every mesh that holds its faces: sums of positions are exact (see
// quantum.h), and masks that are not symmetric start at the neighbour with the smallest key. Pure; any thread.
// Cost: about 60 ns a vertex with tables from another mesh of the same shape; without, some 200 ns more.
#pragma once

#include "geometry/mesh/quantum.h"
#include "geometry/mesh/refine_plan.h"

#include <memory>
#include <vector>

namespace meristem {

// The neighbours of vertices of the owned faces, counter-clockwise. Follows from topology and creases alone.
struct LimitPlan {
  // A smooth vertex of four quads (ends of its edges 0 to 3, then the opposite corners of its faces; face i lies
  // between edges i and i + 1) or six triangles (ends of its edges).
  struct RegularVertex {
    std::uint32_t vertex, ring[8];
  };
  // Any other: ends of its edges, then (of quads) the opposite corners of its faces, from first_point on in `points`.
  // On a boundary the first and the last edge are the boundary's, with one face less than edges.
  struct OtherVertex {
    std::uint32_t vertex, first_point, edge_count, face_count;
    RefinePlan::Rule rule;
    std::uint32_t crease[2] = {0, 0};  // of a crease: its two edges, ascending
  };

  Scheme scheme = Scheme::CatmullClark;
  std::vector<RegularVertex> regular;
  std::vector<OtherVertex> others;
  std::vector<std::uint32_t> points;

  std::size_t bytes() const;
};

std::shared_ptr<const LimitPlan> make_limit_plan(const Mesh& mesh, std::uint32_t owned_faces,
                                                 const RefineOptions& options);

// By vertex of the mesh; zero for vertices that no owned face uses.
struct LimitSurface {
  std::vector<Vec3d> positions;  // in the convex hull of the vertex's faces, but for rounding
  std::vector<Vec3d> normals;    // unit, outwards; zero only if all faces around the vertex are degenerate
};

LimitSurface limit_surface(const Mesh& mesh, const LimitPlan& plan);

// The same with a plan from a table by shape, shared by all threads. The mesh must be one that the scheme's refinement
// makes (all quads, all triangles), its positions on a grid, its halo one complete ring around the owned faces.
LimitSurface limit_surface(const Mesh& mesh, std::uint32_t owned_faces, const RefineOptions& options);

// Of a mesh with faces of any size, whose halo is such that it can be refined: it is refined once, where the vertices
// that come of its own lie on the same limit, and only these are evaluated.
LimitSurface limit_surface_of_cage(const Mesh& cage, std::uint32_t owned_faces, const RefineOptions& options,
                                   const Quantum& quantum);
// What that table holds.
std::size_t limit_plan_bytes();
// How much it may hold; see PlanTable.
void set_limit_plan_capacity(std::size_t bytes);

}  // namespace meristem
