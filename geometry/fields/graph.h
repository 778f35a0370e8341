// Graph: an expression as operations on scalars and vectors. Equal operations on equal arguments are one node, and
// operations on constants are done at once (by the kernels that would do them later, so with the same bits).
// Nodes only refer to earlier ones. Not thread-safe while it is built; then immutable.
#pragma once

#include "geometry/fields/expression.h"
#include "geometry/fields/grid.h"
#include "geometry/fields/kernels.h"

#include <cstdint>
#include <initializer_list>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace meristem {

using NodeId = std::int32_t;

struct Node {
  Op op = Op::Constant;
  ValueType type = ValueType::Scalar;
  bool constant = false;  // depends on no input and no random number
  std::int32_t first_argument = 0, argument_count = 0;
  std::int32_t parameter = 0;  // slot of an Input; index of a Component; octaves; type of voronoi; occurrence of a
                               // Rand; index of a Curve's table or a grid
  float value = 0;             // of a Constant
};

// The pieces of one curve(), by place; the first and the last are constant.
struct CurveTable {
  std::vector<CurvePiece> pieces;
};

class Graph {
 public:
  static constexpr std::size_t max_nodes = 10000;
  struct TooLarge {};  // thrown by whatever would make a node beyond max_nodes

  NodeId constant(float value);
  NodeId input(int slot, ValueType type);
  NodeId component(NodeId vector, int index);
  NodeId make_vector(NodeId x, NodeId y, NodeId z);
  // A scalar three times; a vector as it is.
  NodeId to_vector(NodeId node);
  // Componentwise operations broadcast scalars over vectors; the others want the types of their kernel.
  NodeId make(Op op, std::span<const NodeId> arguments, int parameter = 0);
  NodeId make(Op op, std::initializer_list<NodeId> arguments, int parameter = 0) {
    return make(op, std::span<const NodeId>(arguments.begin(), arguments.size()), parameter);
  }
  NodeId curve(NodeId x, CurveTable table);
  // Op::GridValue or Op::GridGradient at a vector.
  NodeId grid(Op op, NodeId place, std::shared_ptr<const Grid> grid);

  const Node& node(NodeId id) const { return nodes_[std::size_t(id)]; }
  std::size_t size() const { return nodes_.size(); }
  std::span<const NodeId> arguments(const Node& n) const {
    return {arguments_.data() + n.first_argument, std::size_t(n.argument_count)};
  }
  std::span<const NodeId> arguments(NodeId id) const { return arguments(node(id)); }
  bool is_vector(NodeId id) const { return node(id).type == ValueType::Vector; }
  bool is_constant(NodeId id) const { return node(id).constant; }
  // The value of a constant node (scalars in x).
  Vec3f constant_value(NodeId id) const;
  const CurveTable& curve_table(int index) const { return curves_[std::size_t(index)]; }
  const Grid& grid(int index) const { return *grids_[std::size_t(index)]; }

 private:
  NodeId add(Node node, std::span<const NodeId> arguments);
  NodeId simplified(Op op, std::span<const NodeId> arguments) const;  // an existing node of the same value, or -1
  NodeId small_power(NodeId base, NodeId exponent);
  NodeId fold(const Node& node, std::span<const NodeId> arguments);

  std::vector<Node> nodes_;
  std::vector<NodeId> arguments_;
  std::vector<CurveTable> curves_;
  std::vector<std::shared_ptr<const Grid>> grids_;
  std::unordered_multimap<Key, NodeId> known_;
};

// The type of what an operation gives for arguments of which some are vectors.
ValueType result_type(Op op, bool any_vector);

}  // namespace meristem
