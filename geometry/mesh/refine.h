// refine(): applies a RefinePlan to a mesh: smooth positions, u, v and keys of the next level, and what vertex
// placement wants to know about it (the paper's local normal and local scale, a tangent). Mesh refinement and vertex
// placement stay separate: refine() gives the scheme's own positions; whoever places vertices moves them afterwards.
//
// Every vertex comes out with the same bits from every mesh that holds its neighbours: see quantum.h.
// Linear in the plan. Pure; any thread.
#pragma once

#include "geometry/base/scratch.h"
#include "geometry/mesh/quantum.h"
#include "geometry/mesh/refine_plan.h"

#include <vector>

namespace meristem {

// The refined mesh, with the vertices beyond the kept ones that the normals at its rim need.
struct RefinedMesh {
  explicit RefinedMesh(std::uint32_t computed_vertices) : positions(computed_vertices), uv(computed_vertices) {}
  Mesh mesh;                 // kept faces and vertices
  Scratch<Vec3d> positions;  // of all computed vertices; the first are those of `mesh`
  Scratch<Vec2d> uv;
};

// step_key is hashed into the keys of everything new.
RefinedMesh refine(const Mesh& mesh, const RefinePlan& plan, const Quantum& quantum, Key step_key);

// For every kept vertex of the plan, from the computed positions.
struct LocalGeometry {
  LocalGeometry(std::uint32_t vertices, bool with_tangents)
      : normals(vertices), scales(vertices), tangents(with_tangents ? vertices : 0) {}
  Scratch<Vec3d> normals;   // local normal: the mean of the unit normals of the faces that meet there, normalised; zero
                            // if they cancel
  Scratch<double> scales;   // local scale: the mean over these faces of their mean diagonal (for triangles: mean edge)
  Scratch<Vec3d> tangents;  // unit, at right angles to the normal, along growing u (any fixed direction where u is
                            // constant); only if asked for
};
LocalGeometry local_geometry(const RefinePlan& plan, const RefinedMesh& refined, const Quantum& quantum,
                             bool with_tangents);

// Which of its frozen ends the vertex is shown at that refinement puts on an edge, which of its frozen corners the one
// that it puts in a face: those with the smallest keys, of a quad on the diagonal by which it is cut. So of a quad that
// is shown refined come the triangles that it is cut into by itself (tessellation.h), each from the same corner on,
// however often it is refined; all others have no area.
std::uint32_t done_edge_place(const Mesh& mesh, std::uint32_t a, std::uint32_t b);
std::uint32_t done_face_place(const Mesh& mesh, std::uint32_t face);

// u, v by vertex: mesh.uv, or the mean of the corners' own where growth left them at corners (the paper's figure 9).
std::vector<Vec2d> vertex_uv(const Mesh& mesh);

// Whether faces keep u, v of their own through subdivision, as a texture's seams ask for; whether those that corners
// have differ anywhere; and what makes such a mesh keep them.
inline bool has_seams(const Mesh& mesh) { return !mesh.uv.empty() && !mesh.corner_uv.empty(); }
bool corners_differ(const Mesh& mesh);
void keep_seams(Mesh& mesh);
// Of a face by its corners: Mesh::seam_widths, which refinement halves. No part of a face is wider than its own.
Vec2f seam_width(const Mesh& mesh, std::uint32_t face);

// The unit normal of a polygon on the grid of unit vectors; zero if it has no area.
Vec3d unit_face_normal(std::span<const Vec3d> positions, const std::uint32_t* corners, std::uint32_t count);

}  // namespace meristem
