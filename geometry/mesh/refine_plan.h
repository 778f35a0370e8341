// RefinePlan: one level of mesh refinement as index tables: everything about M(n) -> M(n+1) that follows from topology
// and creases alone. Cells of one shape share one plan (RefinePlans), so applying a level is arithmetic on arrays.
//
// Schemes: Catmull-Clark (faces of any size become quads) and Loop (triangles). Creases after DeRose et al. 1998, with
// OpenSubdiv's rules (Sdc::Crease): sharpness falls from level to level, 10 stays, fractions blend.
//
// A plan covers the owned faces and `rings_after` rings of halo of the refined mesh; it needs refine_halo_rings() in
// the input. Immutable; any thread may apply it.
#pragma once

#include "geometry/mesh/mesh.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace meristem {

enum class Scheme : std::uint8_t { CatmullClark, Loop };

// How the smoothing treats boundaries: EdgeAndCorner keeps vertices that have a single face in place, EdgeOnly rounds
// them.
enum class BoundaryRule : std::uint8_t { EdgeAndCorner, EdgeOnly };

// How the sharpness of a crease falls from level to level: Uniform by one; Chaikin, after DeRose et al. 1998, by one
// from 3/4 of its own and 1/4 of the mean of the other semi-sharp edges at the vertex, so that sharpness varies along a
// crease.
enum class Creasing : std::uint8_t { Uniform, Chaikin };

struct RefineOptions {
  Scheme scheme = Scheme::CatmullClark;
  BoundaryRule boundary = BoundaryRule::EdgeAndCorner;
  Creasing creasing = Creasing::Uniform;
  bool operator==(const RefineOptions&) const = default;
  std::uint64_t bits() const {  // below 256, other ones for other options
    return std::uint64_t(creasing) << 5 | std::uint64_t(scheme) << 4 | std::uint64_t(boundary);
  }
};

// What a refined vertex comes from. The paper's kinds of vertex.
enum class VertexKind : std::uint8_t { Vertex, Edge, Face };

struct RefinePlan {
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  // The refined mesh: kept faces (owned first, then by ring) over kept vertices.
  std::vector<std::uint32_t> face_starts, corner_vertices;
  std::vector<float> corner_sharpness, vertex_sharpness;  // empty if nothing is sharp
  std::vector<std::uint32_t> face_parents;                // input face
  std::vector<std::uint8_t> face_child_index;             // which child of it
  std::vector<std::uint8_t> rings;
  std::uint32_t owned_faces = 0;
  std::uint32_t kept_vertices = 0;
  std::vector<VertexKind> kinds;  // of the kept vertices

  // All computed vertices: the kept ones first, then those that only the normals of kept ones need.
  std::uint32_t computed_vertices = 0;
  std::vector<std::uint32_t> normal_faces;        // their faces, as runs of corners_per_face computed vertices
  std::vector<std::uint16_t> normal_face_counts;  // that meet in each computed vertex
  std::uint32_t corners_per_face = 4;

  struct FaceVertex {
    std::uint32_t face, out;
  };
  struct EdgeVertex {
    std::uint32_t ends[2], faces[2];  // faces[1] is none on a boundary
    std::uint32_t opposite[2];        // Loop: the third vertices of the two triangles
    float crease = 0;                 // weight of the sharp rule, 0 to 1
    std::uint32_t out;
  };
  enum class Rule : std::uint8_t { Smooth, Crease, Corner };
  struct VertexVertex {
    std::uint32_t vertex, out;
    std::uint32_t first_neighbor, neighbor_count;  // in `neighbors`: ends of the edges
    std::uint32_t first_face, face_count;          // in `vertex_faces`
    Rule rule = Rule::Smooth, next_rule = Rule::Smooth;
    float weight = 1;                                                   // of `rule`; the rest goes to next_rule
    std::uint32_t ends[2] = {none, none}, next_ends[2] = {none, none};  // of the crease
  };
  std::vector<FaceVertex> face_vertices;
  std::vector<EdgeVertex> edge_vertices;
  std::vector<VertexVertex> vertex_vertices;
  std::vector<std::uint32_t> neighbors, vertex_faces;

  std::size_t bytes() const;
};

// Rings of halo a refinement needs in its input. The normals of the last kept vertices need edge points of the
// outermost of these faces; by Chaikin's rule those depend on what meets at the far ends of their edges.
constexpr int refine_halo_rings(int rings_after, Creasing creasing = Creasing::Uniform) {
  return creasing == Creasing::Chaikin ? rings_after / 2 + 2 : (rings_after + 1) / 2 + 1;
}

// Builds the plan for a mesh whose first owned_faces are owned (the rest halo, complete up to
// refine_halo_rings()). About 0.5 us a face.
std::shared_ptr<const RefinePlan> make_refine_plan(const Mesh& mesh, std::uint32_t owned_faces, int rings_after,
                                                   const RefineOptions& options);

// The same through a table of plans by shape, shared by all threads; holds at most a fixed number of bytes (older plans
// are dropped).
std::shared_ptr<const RefinePlan> shared_refine_plan(const Mesh& mesh, std::uint32_t owned_faces, int rings_after,
                                                     const RefineOptions& options);
// What that table holds.
std::size_t refine_plan_bytes();
// How much it may hold; see PlanTable.
void set_refine_plan_capacity(std::size_t bytes);

}  // namespace meristem
