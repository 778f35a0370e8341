// LightTree: a bounding volume hierarchy over lights that stand somewhere, to choose one by what it gives to a point,
// and to find those that a ray may cross. Choosing goes down from the root, to each child with a probability by its
// LightBounds::importance(); so thousands of lights cost a dozen steps. Built as in Pharr, Jakob, Humphreys 2023,
// section 12.6.3, with the cost of Conty Estevez and Kulla 2018, equation 2. Immutable; any thread; the same tree for
// the same lights in the same order.
#pragma once

#include "geometry/accel/surface.h"
#include "renderer/scene/light_bounds.h"

#include <array>
#include <cstdint>
#include <vector>

namespace meristem {

class LightTree {
 public:
  // lights[i] is what light number i of pick() is. Those without power are never picked nor crossed.
  explicit LightTree(const std::vector<LightBounds>& lights);

  bool empty() const { return nodes_.empty(); }

  struct Pick {
    int light = -1;  // none: no light of the tree reaches the receiver
    float probability = 0;
  };
  Pick pick(const Receiver& receiver, float random) const;
  // With which pick() gives this light for this receiver.
  float probability(const Receiver& receiver, std::size_t light) const;
  // LightBounds::importance() of all lights together.
  float importance(const Receiver& receiver) const {
    return nodes_.empty() ? 0 : nodes_[0].bounds.importance(receiver);
  }

  // Calls visit(light) for the lights whose boxes the ray may cross before t = `end`, in an order of the tree.
  template <class Visit>
  void visit_crossed(const Ray& ray, float end, Visit&& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, max_depth + 2> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!crosses(ray, end, node.bounds.box)) continue;
      if (node.light >= 0) {
        visit(std::size_t(node.light));
      } else {
        stack[depth++] = node.child + 1;
        stack[depth++] = node.child;
      }
    }
  }

 private:
  static constexpr std::size_t max_depth = 64;
  struct Node {
    LightBounds bounds;
    std::uint32_t parent = 0;
    std::uint32_t child = 0;  // the first of two
    std::int32_t light = -1;  // of a leaf
  };
  struct Item {
    LightBounds bounds;
    std::int32_t light;
  };
  void build(std::uint32_t node, Item* begin, Item* end, std::size_t depth);
  static Item* split(Item* begin, Item* end, std::size_t depth);
  static bool crosses(const Ray& ray, float end, const Bounds3f& box);
  // The probability of going on to the first child; -1 if neither reaches the receiver.
  float share_of_first(const Node& node, const Receiver& receiver) const;

  std::vector<Node> nodes_;           // [0] is the root; the children of a node stand together
  std::vector<std::int32_t> leaves_;  // by light: its node, or -1
};

}  // namespace meristem
