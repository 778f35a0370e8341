// Braid: one tree over many surface trees, so that a ray goes from each to the next without going through whose they
// are.
//
// After Benthin et al. 2017, "Improved Two-Level BVHs using Partial Re-Braiding": each tree is opened from its root on,
// and its parts, the strands, are sorted anew among those of all others. Where boxes of whole trees overlap, as those
// of twigs do, a ray enters far fewer strands than trees. Triangles stay where they are.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/tree/surface_tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace meristem {

// What a ray does on its way through a braid.
class BraidVisitor {
 public:
  explicit BraidVisitor(float t) : t_max(t) {}
  // A tree is met, at hit.t up to t_max: t_max is to become hit.t. It may come again, with another triangle. Not where
  // anything will do.
  virtual void met(std::uint32_t tree, const TreeHit& hit) { (void)tree, (void)hit; }
  // A box of `others` is entered: t_max becomes the t of what is met in it, or less than 0 if anything will do.
  virtual void enter(std::uint32_t other) = 0;

  float t_max;  // the end of the ray

 protected:
  ~BraidVisitor() = default;
};

class Braid {
 public:
  struct Tree {
    const SurfaceTree* tree;
    PositionView positions;  // as for SurfaceTree::intersect()
  };
  // Trees that outlive it, and boxes of anything else; by their places in these lists a visitor is told of them. Some
  // 0.2 us a strand or box, and 80 bytes while it is made.
  Braid(std::span<const Tree> trees, std::span<const Bounds3f> others);

  // Trees and boxes are met in the order of the ray as far as boxes tell; nothing behind t_max.
  void intersect(const TreeRay& ray, float t_min, BraidVisitor& visitor) const;
  // Whether a triangle is met or a visit has made t_max less than 0; stops at the first.
  bool occluded(const TreeRay& ray, float t_min, BraidVisitor& visitor) const;

  const Bounds3f& bounds() const { return bounds_; }  // of all strands and boxes
  std::size_t bytes() const {
    return nodes_.capacity() * sizeof(SurfaceTree::Node) + strands_.capacity() * sizeof(Strand);
  }

  // A part of a tree, at an end of the nodes.
  struct alignas(16) Strand {
    const SurfaceTree::Node* nodes;
    const std::array<std::uint32_t, 3>* triangles;
    PositionView positions;
    std::uint32_t start;  // as SurfaceTree::Part has it
    std::uint32_t owner;  // its tree
  };
  // Shapes of the children of nodes: what `first` is the number of.
  static constexpr std::uint8_t is_node = 0, is_strand = 1, is_other = 2;
  struct View {
    const SurfaceTree::Node* nodes;
    const Strand* strands;
  };
  View view() const { return {nodes_.empty() ? nullptr : nodes_.data(), strands_.data()}; }  // nothing: no nodes

 private:
  std::vector<SurfaceTree::Node> nodes_;
  std::vector<Strand> strands_;
  Bounds3f bounds_;
};

}  // namespace meristem
