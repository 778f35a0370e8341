// Mesh: polygon faces with attributes and keys, the state of a model (or of a cell of it) between two steps.
//
// Orientable, manifold or manifold with boundary; corners of a face run counter-clockwise seen from outside. Corner 0
// of a face is never changed by a step: its reference edge runs from corner 0 to corner 1, and everything about the
// face that must come out the same in every cell is computed from its corners in this order.
//
// Positions lie on the model's grid (quantum.h): every step rounds what it places, so that sums over a vertex's
// neighbours are exact in double and need no order. Plain data; thread-safe to read.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/base/key.h"
#include "geometry/mesh/face_origin.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace meristem {

// What is shown of a vertex that is as fine as wanted, however much further the mesh around it is refined.
struct FrozenVertex {
  bool is_frozen = false;
  bool is_copy = false;  // came into being frozen: shown where another vertex is
  Vec3f position;
  Vec3f normal;
  Vec2f uv;
};

// A vertex whose last level fades in (geometry/cells/fading.h): where it would be shown without that level, and the
// share of its own place.
struct FadingVertex {
  float share = 1;
  Vec3f position;
  Vec3f normal;
  Vec2f uv;
};

// A face that stands for others that were left out (geometry/cells/thinning.h): by how much it is larger than its rule
// says, and what grows on it; and by how much finer than others it is refined.
struct Enlargement {
  float of_face = 1, of_growth = 1;
  float detail = 1;
};

struct Mesh {
  // Faces: corners of face f are corner_vertices[face_starts[f] .. face_starts[f + 1])
  std::vector<std::uint32_t> face_starts{0};
  std::vector<std::uint32_t> corner_vertices;
  std::vector<Key> face_keys;
  std::vector<std::uint32_t> face_origins;  // index into origins: what growth gave the face
  std::vector<Enlargement> enlargements;    // empty: none; or one a face
  std::vector<Vec2f> seam_widths;           // where a texture has seams: how wide each face is in u and v, about

  // Corners. Empty or one a corner.
  std::vector<Vec2d> corner_uv;  // each face's own u, v: from the base mesh through growth, averaged into `uv` by the
                                 // first subdivision; beside `uv` (then shown) where a texture has seams, throughout
  std::vector<float> corner_sharpness;  // crease sharpness of the edge from this corner to the next, 0 to 10; both
                                        // faces of an edge agree

  // Vertices
  std::vector<Vec3d> positions;
  std::vector<Key> vertex_keys;
  std::vector<Vec2d> uv;                // present after the first subdivision, and where a texture has seams
  std::vector<float> vertex_sharpness;  // empty or one a vertex
  // Level of detail (geometry/cells/level_of_detail.h); empty where everything is wanted in full.
  std::vector<double> nominal_scale;  // the local scale that refinement alone leaves; 0: not measured yet
  std::vector<FrozenVertex> frozen;   // empty: none is
  std::vector<FadingVertex> fading;   // empty: levels do not fade in

  std::vector<FaceOrigin> origins;

  std::uint32_t face_count() const { return std::uint32_t(face_keys.size()); }
  std::uint32_t vertex_count() const { return std::uint32_t(positions.size()); }
  std::uint32_t corner_count(std::uint32_t f) const { return face_starts[f + 1] - face_starts[f]; }
  std::span<const std::uint32_t> corners(std::uint32_t f) const {
    return {corner_vertices.data() + face_starts[f], corner_count(f)};
  }
  std::size_t bytes() const;
  void shrink_to_fit();

  // Appends a face without attributes of corners; returns its index.
  std::uint32_t add_face(std::span<const std::uint32_t> vertices, Key key, std::uint32_t origin);
  std::uint32_t add_vertex(Vec3d position, Key key);
};

// The face's reference frame (the paper's figure 7): origin at the centroid of the corners, z along the Newell normal
// (outwards), x from the centroid towards the midpoint of the reference edge (corner 0 to corner 1) projected onto the
// plane, y = z cross x; columns are unit. Model space.
struct FaceFrame {
  Vec3d origin, x, y, z;
  double radius = 0;  // mean distance of the corners from the centroid
};
FaceFrame face_frame(const Mesh& mesh, std::uint32_t face);

// Newell's normal of a polygon: twice its area long, towards the side from which it runs counter-clockwise.
Vec3d newell_normal(const Mesh& mesh, std::uint32_t face);

// What is wrong with the mesh as a manifold (an edge with three faces or two of the same direction, a vertex with two
// fans, a face that repeats a vertex, an index out of range, a non-finite position), or an empty text.
std::string manifold_defect(const Mesh& mesh);

// True if every edge has two faces.
bool is_closed(const Mesh& mesh);

}  // namespace meristem
