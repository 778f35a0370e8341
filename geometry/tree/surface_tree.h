// SurfaceTree: boxes over the triangles of a tessellation, and rays through them. Why it is not Embree's grids:
// docs/decisions/rays.md, "A tree of our own".
//
// Nodes of eight children whose boxes are kept in bytes (Ylitie et al. 2017, "Efficient Incoherent Ray Traversal on
// GPUs Through Compressed Wide BVHs"); a child is a node or a block of up to eight triangles that are met at once: two
// by two quads of a grid, or triangles. No box loses a hit to rounding, and triangles are met by their edges alone
// (Woop et al. 2013, "Watertight Ray/Triangle Intersection"): a ray passes between no two triangles that share an edge.
//
// A hit depends on the triangle and the ray only: not on the tree, the other triangles or the instruction set. Of
// triangles at one distance the one with the smallest tie_key() is met, so that it does not matter either in which tree
// they stand; where one stands there twice, the first in the order of the tree.
#pragma once

#include "geometry/base/key.h"
#include "geometry/cells/position_view.h"
#include "geometry/cells/tessellation.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meristem {

// A ray made ready for all trees in one frame.
struct TreeRay {
  TreeRay(Vec3f origin, Vec3f direction);

  // Of x, y, z; the fourth is not used.
  alignas(16) std::array<float, 4> origin, reciprocal;
  alignas(16) std::array<float, 4> slack;  // in t, for each unit of distance: what rounding may do to a plane of a box
  std::array<std::uint32_t, 3> near_side;  // of a box: 0 lower, 1 upper
  int axis;                                // along which the direction is longest
  float shear_x, shear_y, shear_z;         // make the direction (0, 0, 1), with the axis last
};

// The nearest hit so far; t is the end of the ray before there is one.
struct TreeHit {
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  float t;
  std::uint32_t triangle = none;  // 64 * node + 8 * child + place in it
  float u = 0, v = 0;             // weights of the second and third corner
};

// A hash of where the corners of a triangle lie.
Key tie_key(const PositionView& positions, const std::array<std::uint32_t, 3>& corners);

class SurfaceTree {
 public:
  // Over all triangles of a tessellation, with room to read behind its last position; sorts those outside grids. Their
  // list outlives it, unchanged (it may be moved).
  // `parallel`: large ones are built by parallel_for().
  explicit SurfaceTree(Tessellation& tessellation, bool parallel = false);

  // The same from its nodes, over the triangles as they were sorted then; the list outlives it (it may be moved).
  struct Node;
  SurfaceTree(const SurfaceFaces& faces, std::vector<Node> nodes);
  const std::vector<Node>& nodes() const { return nodes_; }

  // Looks for a triangle in (t_min, hit.t]; returns whether there is one. `positions` are those of the tessellation,
  // with room to read behind the last.
  bool intersect(const PositionView& positions, const TreeRay& ray, float t_min, TreeHit& hit) const;
  // Whether any triangle is met in (t_min, t_max].
  bool occluded(const PositionView& positions, const TreeRay& ray, float t_min, float t_max) const;

  // What a hit has met: a triangle of the tessellation's list, or one of a quad of the grid that holds these vertices.
  static constexpr std::uint32_t none = TreeHit::none;
  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::uint32_t index;  // in the list; none: of a grid
    std::uint32_t grid;   // none, rarely: see the corners
  };
  Triangle triangle(std::uint32_t met) const { return triangle(nodes_.data(), triangles_, met); }
  static Triangle triangle(const Node* nodes, const std::array<std::uint32_t, 3>* triangles, std::uint32_t met);

  std::size_t bytes() const;
  // Up to so many small parts, at least eight, that hold all triangles.
  struct Part {
    Bounds3f box;         // no larger than it has to be but for rounding
    std::uint32_t start;  // index of a node, or 8 * node + child of a block, with is_block
  };
  static constexpr std::uint32_t is_block = std::uint32_t(1) << 31;
  std::vector<Part> parts(std::size_t most) const;
  const std::array<std::uint32_t, 3>* triangles() const { return triangles_; }

  // What a ray keeps for later at most: of each level all children but one. No tree is deeper.
  static constexpr int most_levels = 64, most_waiting = 7 * most_levels;

  // The first cache line says which children a ray may meet, the second what they are. A plane of a box lies at
  // origin + bounds * 2^(exponent - 127).
  struct alignas(128) Node {
    std::array<float, 3> origin;
    std::array<std::uint8_t, 3> exponent;
    std::uint8_t children;
    std::uint8_t bounds[3][2][8];  // axis, lower or upper, child
    // Quads of a grid: their first vertex, how many vertices the grid's rows are apart, and columns + 16 * rows of
    // quads (1 or 2). Triangles: the first, 0, and how many. A node: its index, 0, and 0.
    std::uint32_t first[8];
    std::uint16_t stride[8];
    std::uint8_t shape[8];
    std::uint32_t grid;           // the first of those that its quads are of; none: there are none
    std::uint32_t grids_further;  // by child, four bits of how many grids later its own comes; 15: so many or more
  };
  static_assert(sizeof(Node) == 128);

 private:
  std::vector<Node> nodes_;  // none: nothing is there; the first is the root
  const std::array<std::uint32_t, 3>* triangles_ = nullptr;
};

}  // namespace meristem
