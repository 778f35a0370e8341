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

// What is sorted: strands and others, with their boxes as items.
class Ends {
 public:
  Ends(std::span<const Braid::Tree> trees, std::span<const Bounds3f> others) {
    items_.reserve(trees.size() + others.size());
    for (std::uint32_t i = 0; i < trees.size(); ++i)
      for (const SurfaceTree::Part& part : trees[i].tree->parts(most_strands_of_tree)) {
        add(part.box, std::uint32_t(strands_.size()), Braid::is_strand);
        strands_.push_back(
            {trees[i].tree->nodes().data(), trees[i].tree->triangles(), trees[i].positions, part.start, i});
      }
    for (std::uint32_t i = 0; i < others.size(); ++i)
      if (!others[i].empty()) add(bounded(others[i]), i, Braid::is_other);
  }

  std::span<Item> items() { return items_; }
  const Bounds3f& bounds() const { return bounds_; }
  static std::uint8_t shape_of(const Item& item) { return std::uint8_t(item.source.grid); }
  const Braid::Strand& strand_of(const Item& item) const { return strands_[item.source.first]; }
  std::size_t strand_count() const { return strands_.size(); }
  void forget_items() { items_ = {}; }

 private:
  void add(const Bounds3f& b, std::uint32_t number, std::uint8_t shape) {
    const Box box{_mm_setr_ps(b.lower.x, b.lower.y, b.lower.z, 0), _mm_setr_ps(b.upper.x, b.upper.y, b.upper.z, 0)};
    items_.push_back({box, {number, 0, 1, 1, shape}});
    bounds_.extend(b);
  }

  std::vector<Item> items_;
  std::vector<Braid::Strand> strands_;
  Bounds3f bounds_;
};

// Nodes and strands in the order in which rays come to them.
struct Builder {
  const Ends& from;
  std::vector<SurfaceTree::Node> nodes;
  std::vector<Braid::Strand> strands;

  void make_node(std::size_t index, const Range& range, int level) {
    std::array<Range, tree::most_children> children;
    const std::size_t count = tree::split_for_node(range, level, 1, children);
    tree::NodeWriter writer(range.extent.box);
    const std::size_t first_node = nodes.size();
    std::size_t inner = 0;
    for (const Range& child : std::span(children).first(count)) {
      if (child.items.size() > 1)
        writer.add_node(child.extent.box, first_node + inner++);
      else
        add_end(child, writer);
    }
    nodes[index] = writer.node();
    nodes.resize(first_node + inner);
    std::size_t next = first_node;
    for (const Range& child : std::span(children).first(count))
      if (child.items.size() > 1) make_node(next++, child, level + 1);
  }

 private:
  void add_end(const Range& end, tree::NodeWriter& writer) {
    const Item& item = end.items[0];
    if (Ends::shape_of(item) == Braid::is_other)
      return writer.add(end.extent.box, item.source.first, 0, Braid::is_other);
    writer.add(end.extent.box, std::uint32_t(strands.size()), 0, Braid::is_strand);
    strands.push_back(from.strand_of(item));
  }
};

}  // namespace

Braid::Braid(std::span<const Tree> trees, std::span<const Bounds3f> others) {
  Ends ends(trees, others);
  bounds_ = ends.bounds();
  if (ends.items().empty()) return;
  Builder builder{ends, std::vector<SurfaceTree::Node>(1), {}};
  builder.nodes.reserve(ends.items().size() / 4 + 1);
  builder.strands.reserve(ends.strand_count());
  builder.make_node(0, {ends.items(), tree::extent_of(ends.items())}, 0);
  ends.forget_items();  // before the nodes stand twice
  nodes_.assign(builder.nodes.begin(), builder.nodes.end());
  strands_ = std::move(builder.strands);
}

void Braid::intersect(const TreeRay& ray, float t_min, BraidVisitor& visitor) const {
  if (!nodes_.empty()) best_tree_kernels().intersect_braid(view(), ray, t_min, visitor);
}

bool Braid::occluded(const TreeRay& ray, float t_min, BraidVisitor& visitor) const {
  return !nodes_.empty() && best_tree_kernels().occlude_braid(view(), ray, t_min, visitor);
}

}  // namespace meristem
