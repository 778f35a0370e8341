#include "geometry/tree/tree_builder.h"

#include "geometry/base/parallel.h"
#include "geometry/tree/node_writer.h"
#include "geometry/tree/tree_split.h"

#include <algorithm>
#include <array>
#include <limits>

namespace meristem {

namespace tree {

namespace {

using Node = SurfaceTree::Node;

class Builder {
 public:
  Builder(const Tessellation& tessellation, bool parallel)
      : vertices_(tessellation), parallel_from_(parallel ? 1 << 13 : std::numeric_limits<std::size_t>::max()) {}

  // Fills the node at `index` of what is built, and all below it.
  void make_node(BuiltTree& out, std::size_t index, const Range& range, int level) const {
    if (range.extent.weight <= node_weight)
      out.nodes[index] = node_of_blocks(out, range, level);
    else
      make_inner_node(out, index, range, level);
  }

 private:
  void make_inner_node(BuiltTree& out, std::size_t index, const Range& range, int level) const {
    std::array<Range, most_children> children;
    const std::size_t count = split_for_node(range, level, node_weight, children);
    const std::size_t first = out.nodes.size();
    out.nodes.resize(first + count);
    NodeWriter writer(range.extent.box);
    for (std::size_t i = 0; i < count; ++i) writer.add_node(children[i].extent.box, first + i);
    out.nodes[index] = writer.node();
    if (range.items.size() < parallel_from_) {
      for (std::size_t i = 0; i < count; ++i) make_node(out, first + i, children[i], level + 1);
      return;
    }
    std::array<BuiltTree, most_children> parts;
    parallel_for(count, [&](std::size_t i) {
      parts[i].nodes.resize(1);
      make_node(parts[i], 0, children[i], level + 1);
    });
    for (std::size_t i = 0; i < count; ++i) append(out, first + i, std::exchange(parts[i], {}));
  }

  Node node_of_blocks(BuiltTree& out, const Range& range, int level) const {
    NodeWriter writer(range.extent.box);
    const auto grids = std::ranges::partition(range.items, [](const Item& i) { return i.source.is_triangle(); });
    std::uint32_t blocks = 0;
    for (const Item& item : grids) writer.add_grid(item.source.grid);
    for (const Item& item : grids)
      cut(item.source, 2, 2, [&](const Source& b) {
        writer.add_quads(vertices_.corners_of(b).box, b);
        ++blocks;
      });
    const auto triangles = range.items.first(range.items.size() - grids.size());
    if (!triangles.empty())
      add_triangles(out, {triangles, extent_of(triangles)}, most_children - blocks, level, writer);
    return writer.node();
  }

  // As so many blocks at most, of which there are enough.
  void add_triangles(BuiltTree& out, const Range& range, std::size_t most_blocks, int level, NodeWriter& writer) const {
    constexpr std::size_t few = 4;  // are not worth another block
    const std::size_t count = range.items.size();
    if (count <= few || most_blocks == 1) {
      writer.add(range.extent.box, std::uint32_t(out.triangles.size()), 0, std::uint32_t(count));
      for (const Item& item : range.items) out.triangles.push_back(item.source.first);
      return;
    }
    const auto least_blocks = [](std::size_t n) { return (n + most_triangles - 1) / most_triangles; };
    auto [a, b] = split(range, level);
    if (least_blocks(a.items.size()) + least_blocks(b.items.size()) > most_blocks) {
      const Axis axis(range.extent.centroids);
      const std::size_t middle =
          most_triangles *
          std::clamp<std::size_t>((a.items.size() + most_triangles / 2) / most_triangles, 1, least_blocks(count) - 1);
      std::ranges::nth_element(range.items, range.items.begin() + std::ptrdiff_t(middle), {},
                               [&](const Item& item) { return axis.place(item); });
      std::tie(a, b) = cut_at(range.items, middle);
    }
    const std::size_t of_a = std::clamp(most_blocks * a.items.size() / count, least_blocks(a.items.size()),
                                        most_blocks - least_blocks(b.items.size()));
    add_triangles(out, a, of_a, level + 1, writer);
    add_triangles(out, b, most_blocks - of_a, level + 1, writer);
  }

  // A tree of which the root is to become the node at `index`.
  static void append(BuiltTree& out, std::size_t index, const BuiltTree& part) {
    const auto nodes = std::uint32_t(out.nodes.size() - 1), triangles = std::uint32_t(out.triangles.size());
    const auto moved = [&](Node node) {
      for (int i = 0; i < node.children; ++i)
        if (node.stride[i] == 0) node.first[i] += node.shape[i] == 0 ? nodes : triangles;
      return node;
    };
    out.nodes[index] = moved(part.nodes[0]);
    for (std::size_t i = 1; i < part.nodes.size(); ++i) out.nodes.push_back(moved(part.nodes[i]));
    out.triangles.insert(out.triangles.end(), part.triangles.begin(), part.triangles.end());
  }

  const Vertices vertices_;
  const std::size_t parallel_from_;  // items
};

}  // namespace

}  // namespace tree

void build_tree(const Tessellation& tessellation, bool parallel, BuiltTree& built) {
  built.nodes.clear();
  built.triangles.clear();
  tree::Items items(tessellation);
  if (items.span().empty()) return;
  built.nodes.resize(1);
  tree::Builder(tessellation, parallel).make_node(built, 0, {items.span(), tree::extent_of(items.span())}, 0);
}

}  // namespace meristem
