#include "geometry/tree/braid.h"

#include "geometry/tree/node_writer.h"
#include "geometry/tree/tree_kernels.h"
#include "geometry/tree/tree_split.h"

namespace meristem {

namespace {

using tree::Box;
using tree::Item;
using tree::Range;

// More strands of a tree cost memory and gain little.
constexpr std::size_t most_strands_of_tree = 16;

// As large as nodes can be made: what is not finite is entered by all rays but those that begin beyond.
Bounds3f bounded(Bounds3f b) {
  constexpr float most = 0x1p100f;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(b.lower[axis] > -most)) b.lower[axis] = -most;
    if (!(b.upper[axis] < most)) b.upper[axis] = most;
  }
  return b;
}

// What is sorted: the strands as they come, with their boxes as items.
class Strands {
 public:
  Strands(std::span<const Braid::Tree> trees, std::span<const Bounds3f> others) {
    for (std::uint32_t i = 0; i < trees.size(); ++i)
      for (const SurfaceTree::Part& part : trees[i].tree->parts(most_strands_of_tree))
        add(part.box, {trees[i].tree->nodes().data(), trees[i].tree->triangles(), trees[i].positions, part.start, i});
    for (std::uint32_t i = 0; i < others.size(); ++i)
      if (!others[i].empty()) add(bounded(others[i]), {nullptr, nullptr, nullptr, 0, i});
  }

  std::span<Item> items() { return items_; }
  const Bounds3f& bounds() const { return bounds_; }
  const Braid::Strand& of(const Item& item) const { return strands_[item.source.first]; }

 private:
  void add(const Bounds3f& b, const Braid::Strand& strand) {
    const Box box{_mm_setr_ps(b.lower.x, b.lower.y, b.lower.z, 0), _mm_setr_ps(b.upper.x, b.upper.y, b.upper.z, 0)};
    items_.push_back({box, {std::uint32_t(strands_.size()), 0, 1, 1, SurfaceTree::none}});
    strands_.push_back(strand);
    bounds_.extend(b);
  }

  std::vector<Item> items_;
  std::vector<Braid::Strand> strands_;
  Bounds3f bounds_;
};

// Nodes and strands in the order in which rays come to them.
struct Builder {
  const Strands& from;
  std::vector<SurfaceTree::Node> nodes;
  std::vector<Braid::Strand> strands;

  void make_node(std::size_t index, const Range& range, int level) {
    std::array<Range, tree::most_children> children;
    const std::size_t count = tree::split_for_node(range, level, 1, children);
    tree::NodeWriter writer(range.extent.box);
    const std::size_t first_node = nodes.size();
    std::size_t inner = 0;
    for (const Range& child : std::span(children).first(count)) {
      if (child.items.size() > 1) {
        writer.add_node(child.extent.box, first_node + inner++);
      } else {
        writer.add(child.extent.box, std::uint32_t(strands.size()), 0, 1);
        strands.push_back(from.of(child.items[0]));
      }
    }
    nodes[index] = writer.node();
    nodes.resize(first_node + inner);
    std::size_t next = first_node;
    for (const Range& child : std::span(children).first(count))
      if (child.items.size() > 1) make_node(next++, child, level + 1);
  }
};

}  // namespace

Braid::Braid(std::span<const Tree> trees, std::span<const Bounds3f> others) {
  Strands strands(trees, others);
  bounds_ = strands.bounds();
  if (strands.items().empty()) return;
  Builder builder{strands, std::vector<SurfaceTree::Node>(1), {}};
  builder.make_node(0, {strands.items(), tree::extent_of(strands.items())}, 0);
  nodes_.assign(builder.nodes.begin(), builder.nodes.end());
  strands_.assign(builder.strands.begin(), builder.strands.end());
}

void Braid::intersect(const TreeRay& ray, float t_min, BraidVisitor& visitor) const {
  if (!nodes_.empty()) best_tree_kernels().intersect_braid(view(), ray, t_min, visitor);
}

bool Braid::occluded(const TreeRay& ray, float t_min, BraidVisitor& visitor) const {
  return !nodes_.empty() && best_tree_kernels().occlude_braid(view(), ray, t_min, visitor);
}

}  // namespace meristem
