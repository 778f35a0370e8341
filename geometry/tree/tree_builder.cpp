#include "geometry/tree/tree_builder.h"

#include "geometry/base/parallel.h"
#include "geometry/base/scratch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <xmmintrin.h>

namespace meristem {

namespace {

using Node = SurfaceTree::Node;

constexpr std::uint32_t most_children = 8, most_triangles = 8, bins = 8;
constexpr std::size_t parallel_from = 1 << 13;  // items

struct Box {
  __m128 lower = _mm_set1_ps(INFINITY), upper = _mm_set1_ps(-INFINITY);

  void extend(const Box& b) {
    lower = _mm_min_ps(lower, b.lower);
    upper = _mm_max_ps(upper, b.upper);
  }
  void extend(__m128 p) {
    lower = _mm_min_ps(lower, p);
    upper = _mm_max_ps(upper, p);
  }
  // Half of it.
  float area() const {
    alignas(16) float s[4];
    _mm_store_ps(s, _mm_sub_ps(upper, lower));
    return s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
  }
};

// The box of some vertices, and whether all are numbers.
struct Corners {
  Box box;
  __m128 differences = _mm_setzero_ps();  // of numbers from themselves: NaN if one is not finite

  void add(__m128 p) {
    box.extend(p);
    differences = _mm_add_ps(differences, _mm_sub_ps(p, p));
  }
  bool are_finite() const { return (_mm_movemask_ps(_mm_cmpeq_ps(differences, _mm_setzero_ps())) & 7) == 7; }
};

// A rectangle of a grid's quads from a vertex on, or a triangle.
struct Source {
  std::uint32_t first;
  std::uint16_t stride;  // 0: a triangle
  std::uint16_t columns, rows;
  std::uint32_t grid;

  bool is_triangle() const { return stride == 0; }
  std::uint32_t blocks() const { return (columns + 1u) / 2 * ((rows + 1u) / 2); }
};

// What trees are built over.
struct Item {
  Box box;
  Source source;

  std::uint32_t weight() const { return source.is_triangle() ? 1 : most_triangles * source.blocks(); }
  __m128 doubled_centroid() const { return _mm_add_ps(box.lower, box.upper); }
};
constexpr std::uint32_t node_weight = most_children * most_triangles;  // what a node above blocks alone holds

// Vertices of a tessellation, as boxes.
class Vertices {
 public:
  explicit Vertices(const Tessellation& t) : t_(t) {}

  Corners corners_of(const Source& s) const {
    Corners corners;
    if (s.is_triangle())
      for (std::uint32_t v : t_.triangles[s.first]) corners.add(position(v));
    else
      for (std::uint32_t j = 0; j <= s.rows; ++j)
        for (std::uint32_t i = 0; i <= s.columns; ++i) corners.add(position(s.first + j * s.stride + i));
    return corners;
  }

 private:
  __m128 position(std::uint32_t v) const { return _mm_loadu_ps(&t_.positions[v].x); }  // and four bytes behind it

  const Tessellation& t_;
};

// Cuts a rectangle into others of so many columns and rows at most, row by row.
template <class Visit>
void cut(const Source& whole, std::uint32_t columns, std::uint32_t rows, const Visit& visit) {
  for (std::uint32_t y = 0; y < whole.rows; y += rows)
    for (std::uint32_t x = 0; x < whole.columns; x += columns)
      visit(Source{whole.first + y * whole.stride + x, whole.stride,
                   std::uint16_t(std::min(columns, whole.columns - x)), std::uint16_t(std::min(rows, whole.rows - y)),
                   whole.grid});
}

// All of a tessellation: of grids clusters of 4 x 2 blocks, which fill a node, or what there is instead; then
// triangles. Blocks and triangles that have a corner which is not a finite number are left out.
class Items {
 public:
  explicit Items(const Tessellation& t) : list_(most_of(t)) {
    const Vertices vertices(t);
    for (std::uint32_t i = 0; i < t.grids.size(); ++i) {
      const Tessellation::Grid& g = t.grids[i];
      const Source quads{g.first_vertex, g.width, std::uint16_t(g.width - 1), std::uint16_t(g.height - 1), i};
      cut(quads, 8, 4, [&](const Source& cluster) {
        if (!add(vertices, cluster)) cut(cluster, 2, 2, [&](const Source& block) { add(vertices, block); });
      });
    }
    for (std::uint32_t i = 0; i < t.triangles.size(); ++i) add(vertices, {i, 0, 1, 1, SurfaceTree::none});
  }
  std::span<Item> span() { return list_.span().first(count_); }

 private:
  static std::size_t most_of(const Tessellation& t) {
    std::size_t most = t.triangles.size();
    for (const Tessellation::Grid& g : t.grids) most += std::size_t(g.width / 2) * std::size_t(g.height / 2);
    return most;
  }
  bool add(const Vertices& vertices, const Source& source) {
    const Corners corners = vertices.corners_of(source);
    if (!corners.are_finite()) return false;
    list_[count_++] = {corners.box, source};
    return true;
  }

  Scratch<Item> list_;
  std::size_t count_ = 0;
};

struct Extent {
  Box box, centroids;  // of items; centroids doubled
  std::size_t weight = 0;

  void add(const Item& item) {
    box.extend(item.box);
    centroids.extend(item.doubled_centroid());
    weight += item.weight();
  }
  void add(const Extent& e) {
    box.extend(e.box);
    centroids.extend(e.centroids);
    weight += e.weight;
  }
};

struct Range {
  std::span<Item> items;
  Extent extent;
};

Extent extent_of(std::span<const Item> items) {
  Extent extent;
  for (const Item& item : items) extent.add(item);
  return extent;
}

// Where items lie along the axis along which their centroids lie farthest apart.
class Axis {
 public:
  explicit Axis(const Box& centroids) {
    alignas(16) float lower[4], size[4];
    _mm_store_ps(lower, centroids.lower);
    _mm_store_ps(size, _mm_sub_ps(centroids.upper, centroids.lower));
    axis_ = size[0] >= size[1] ? (size[0] >= size[2] ? 0 : 2) : (size[1] >= size[2] ? 1 : 2);
    lower_ = lower[axis_];
    size_ = size[axis_];
  }
  bool is_point() const { return !(size_ > 0) || !std::isfinite(float(bins) / size_); }
  float place(const Item& item) const {
    alignas(16) float c[4];
    _mm_store_ps(c, item.doubled_centroid());
    return c[axis_];
  }
  std::size_t bin(const Item& item) const {
    return std::min(std::size_t((place(item) - lower_) * (float(bins) / size_)), std::size_t(bins) - 1);
  }

 private:
  int axis_;
  float lower_, size_;
};

std::pair<Range, Range> cut_at(std::span<Item> items, std::size_t middle) {
  const auto a = items.first(middle), b = items.subspan(middle);
  return {{a, extent_of(a)}, {b, extent_of(b)}};
}

// Two parts, each with an item at least: by the surface area heuristic over bins.
std::pair<Range, Range> split(const Range& range, int level) {
  constexpr int most_uneven_levels = SurfaceTree::most_levels / 2;
  const Axis axis(range.extent.centroids);
  const std::size_t half = range.items.size() / 2;
  if (axis.is_point() || level > most_uneven_levels) return cut_at(range.items, half);
  std::array<Extent, bins> extents;
  for (const Item& item : range.items) extents[axis.bin(item)].add(item);
  const auto cost = [](const Extent& e) { return e.weight > 0 ? e.box.area() * float(e.weight) : INFINITY; };
  std::array<float, bins> cost_behind{};
  Extent behind, before;
  for (std::size_t i = bins - 1; i > 0; --i) {
    behind.add(extents[i]);
    cost_behind[i] = cost(behind);
  }
  float least = INFINITY;
  std::size_t best = 0;
  for (std::size_t i = 1; i < bins; ++i) {
    before.add(extents[i - 1]);
    if (const float both = cost(before) + cost_behind[i]; both < least) least = both, best = i;
  }
  if (best == 0) return cut_at(range.items, half);
  const auto second = std::ranges::partition(range.items, [&](const Item& item) { return axis.bin(item) < best; });
  const auto first_count = range.items.size() - second.size();
  std::pair<Range, Range> parts{{range.items.first(first_count), {}}, {range.items.subspan(first_count), {}}};
  for (std::size_t i = 0; i < bins; ++i) (i < best ? parts.first : parts.second).extent.add(extents[i]);
  return parts;
}

// A node as it is filled.
class NodeWriter {
 public:
  explicit NodeWriter(const Box& box) : node_{} {
    _mm_store_ps(lower_, box.lower);
    alignas(16) float upper[4];
    _mm_store_ps(upper, box.upper);
    for (int axis = 0; axis < 3; ++axis) {
      node_.origin[axis] = lower_[axis];
      // The least power of two of which 255 steps are enough.
      const double size = double(upper[axis]) - double(lower_[axis]);
      const int exponent = size > 0 ? std::clamp(std::ilogb(size / 255) + 1, -126, 127) : -126;
      node_.exponent[axis] = std::uint8_t(exponent + 127);
      steps_[axis] = std::ldexp(1.0, -exponent);
    }
  }

  void add(const Box& box, std::uint32_t first, std::uint32_t stride, std::uint32_t shape) {
    const int child = node_.children++;
    alignas(16) float lower[4], upper[4];
    _mm_store_ps(lower, box.lower);
    _mm_store_ps(upper, box.upper);
    for (int axis = 0; axis < 3; ++axis) {
      const auto place = [&](float x) { return (double(x) - double(lower_[axis])) * steps_[axis]; };
      node_.bounds[axis][0][child] = std::uint8_t(place(lower[axis]));
      node_.bounds[axis][1][child] = std::uint8_t(std::ceil(place(upper[axis])));
    }
    node_.first[child] = first;
    node_.stride[child] = std::uint16_t(stride);
    node_.shape[child] = std::uint8_t(shape);
  }
  void add_grid(std::uint32_t grid) {
    node_.grid = has_grid_ && node_.grid != grid ? SurfaceTree::none : grid;
    has_grid_ = true;
  }
  void add_node(const Box& box, std::size_t index) { add(box, std::uint32_t(index), 0, 0); }
  const Node& node() const { return node_; }

 private:
  Node node_;
  bool has_grid_ = false;
  alignas(16) float lower_[4];
  double steps_[3];
};

class Builder {
 public:
  explicit Builder(const Tessellation& tessellation) : vertices_(tessellation) {}

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
    std::size_t count = 1;
    children[0] = range;
    while (count < most_children) {
      Range* largest = nullptr;
      for (std::size_t i = 0; i < count; ++i)
        if (children[i].extent.weight > node_weight &&
            (!largest || children[i].extent.box.area() > largest->extent.box.area()))
          largest = &children[i];
      if (!largest) break;
      std::tie(*largest, children[count++]) = split(*largest, level);
    }
    const std::size_t first = out.nodes.size();
    out.nodes.resize(first + count);
    NodeWriter writer(range.extent.box);
    for (std::size_t i = 0; i < count; ++i) writer.add_node(children[i].extent.box, first + i);
    out.nodes[index] = writer.node();
    if (range.items.size() < parallel_from) {
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
        writer.add(vertices_.corners_of(b).box, b.first, b.stride, b.columns + 16u * b.rows);
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
};

}  // namespace

BuiltTree build_tree(const Tessellation& tessellation) {
  BuiltTree tree;
  Items items(tessellation);
  if (items.span().empty()) return tree;
  tree.triangles.reserve(tessellation.triangles.size());
  tree.nodes.reserve(items.span().size());
  tree.nodes.resize(1);
  Builder(tessellation).make_node(tree, 0, {items.span(), extent_of(items.span())}, 0);
  return tree;
}

}  // namespace meristem
