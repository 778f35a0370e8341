#include "geometry/fields/graph.h"

#include "geometry/base/check.h"

#include <algorithm>
#include <bit>

namespace meristem {

namespace {

bool is_commutative(Op op) {
  switch (op) {
    case Op::Add:
    case Op::Mul:
    case Op::Equal:
    case Op::And:
    case Op::Or:
    case Op::Dot: return true;
    default: return false;
  }
}

Key hash_node(const Node& n, std::span<const NodeId> arguments) {
  Key h = hash_keys(Key(n.op) | Key(n.type) << 8, std::bit_cast<std::uint32_t>(n.value), Key(n.parameter));
  for (NodeId a : arguments) h = hash_keys(h, Key(a));
  return h;
}

// Runs one kernel on operands that each stand for all lanes.
Vec3f run_once(Op op, int parameter, const CurveTable* curve, std::span<const float> operands) {
  std::vector<std::array<float, lane_group>> lanes(operands.size());
  std::vector<Operand> where(operands.size());
  for (std::size_t i = 0; i < operands.size(); ++i) {
    lanes[i].fill(operands[i]);
    where[i] = {lanes[i].data(), 0};
  }
  std::array<std::array<float, lane_group>, 3> out{};
  KernelCall call{{out[0].data(), out[1].data(), out[2].data()}, where.data(), int(operands.size()), parameter};
  if (curve) {
    call.pieces = curve->pieces.data();
    call.parameter = int(curve->pieces.size());
  }
  best_kernels().functions[std::size_t(op)](call, lane_group);
  return {out[0][0], out[1][0], out[2][0]};
}

}  // namespace

ValueType result_type(Op op, bool any_vector) {
  switch (op) {
    case Op::MakeVector:
    case Op::Cross:
    case Op::Norm:
    case Op::Rotate:
    case Op::VectorNoise:
    case Op::VectorFbm:
    case Op::VectorTurbulence:
    case Op::VectorNoise4:
    case Op::VectorFbm4:
    case Op::CellColor:
    case Op::VoronoiPosition:
    case Op::VoronoiColor:
    case Op::GridGradient: return ValueType::Vector;
    default: return is_componentwise(op) && any_vector ? ValueType::Vector : ValueType::Scalar;
  }
}

NodeId Graph::add(Node n, std::span<const NodeId> arguments) {
  const Key h = hash_node(n, arguments);
  const auto [first, last] = known_.equal_range(h);
  for (auto it = first; it != last; ++it) {
    const Node& k = node(it->second);
    if (k.op == n.op && k.type == n.type && k.parameter == n.parameter &&
        std::bit_cast<std::uint32_t>(k.value) == std::bit_cast<std::uint32_t>(n.value) &&
        std::ranges::equal(this->arguments(k), arguments))
      return it->second;
  }
  if (nodes_.size() >= max_nodes) throw TooLarge{};
  n.first_argument = std::int32_t(arguments_.size());
  n.argument_count = std::int32_t(arguments.size());
  arguments_.insert(arguments_.end(), arguments.begin(), arguments.end());
  nodes_.push_back(n);
  known_.emplace(h, NodeId(nodes_.size() - 1));
  return NodeId(nodes_.size() - 1);
}

NodeId Graph::constant(float value) {
  Node n;
  n.constant = true;
  n.value = value;
  return add(n, {});
}

NodeId Graph::input(int slot, ValueType type) {
  Node n;
  n.op = Op::Input;
  n.type = type;
  n.parameter = slot;
  return add(n, {});
}

NodeId Graph::component(NodeId vector, int index) {
  const Node& v = node(vector);
  CHECK(v.type == ValueType::Vector && index >= 0 && index < 3, "component {}", index);
  if (v.op == Op::MakeVector) return arguments(v)[std::size_t(index)];
  Node n;
  n.op = Op::Component;
  n.parameter = index;
  return add(n, std::array{vector});
}

NodeId Graph::make_vector(NodeId x, NodeId y, NodeId z) {
  Node n;
  n.op = Op::MakeVector;
  n.type = ValueType::Vector;
  n.constant = is_constant(x) && is_constant(y) && is_constant(z);
  return add(n, std::array{x, y, z});
}

NodeId Graph::to_vector(NodeId id) { return is_vector(id) ? id : make_vector(id, id, id); }

Vec3f Graph::constant_value(NodeId id) const {
  const Node& n = node(id);
  CHECK(n.constant, "node {} is not constant", id);
  if (n.op == Op::Constant) return {n.value, 0, 0};
  const auto a = arguments(n);
  return {node(a[0]).value, node(a[1]).value, node(a[2]).value};
}

// Only rewritings that keep every bit of a finite value (but for the sign of a zero).
NodeId Graph::simplified(Op op, std::span<const NodeId> a) const {
  auto is = [&](std::size_t i, float value) {
    const Node& n = node(a[i]);
    return n.op == Op::Constant && n.value == value;
  };
  auto keeps_type = [&](std::size_t kept, std::size_t dropped) { return is_vector(a[kept]) || !is_vector(a[dropped]); };
  switch (op) {
    case Op::Add:
      if (is(0, 0) && keeps_type(1, 0)) return a[1];
      return is(1, 0) && keeps_type(0, 1) ? a[0] : -1;
    case Op::Mul:
      if (is(0, 1) && keeps_type(1, 0)) return a[1];
      return is(1, 1) && keeps_type(0, 1) ? a[0] : -1;
    case Op::Sub: return is(1, 0) ? a[0] : -1;
    case Op::Div: return is(1, 1) ? a[0] : -1;
    case Op::Min:
    case Op::Max: return a[0] == a[1] ? a[0] : -1;
    case Op::Select:
      if (is_vector(a[1]) != is_vector(a[2]) || is_vector(a[0])) return -1;
      if (a[1] == a[2]) return a[1];
      return node(a[0]).op == Op::Constant ? a[is(0, 0) ? 2 : 1] : -1;
    default: return -1;
  }
}

// Small constant exponents as products: faster, and with sharper bounds. -1 for others.
NodeId Graph::small_power(NodeId base, NodeId exponent) {
  if (node(exponent).op != Op::Constant) return -1;
  const float e = node(exponent).value;
  if (e == 1) return base;
  if (e == 0.5f) return make(Op::Sqrt, {base});
  if (e != 2 && e != 3 && e != 4) return -1;
  const NodeId square = make(Op::Mul, {base, base});
  return e == 2 ? square : make(Op::Mul, {square, e == 3 ? base : square});
}

NodeId Graph::make(Op op, std::span<const NodeId> given, int parameter) {
  if (op == Op::Pow)
    if (const NodeId product = small_power(given[0], given[1]); product >= 0) return product;
  std::vector<NodeId> arguments(given.begin(), given.end());
  if (is_commutative(op) && arguments[0] > arguments[1]) std::swap(arguments[0], arguments[1]);
  if (const NodeId same = simplified(op, arguments); same >= 0) return same;
  Node n;
  n.op = op;
  n.parameter = parameter;
  n.type = result_type(op, std::ranges::any_of(arguments, [&](NodeId a) { return is_vector(a); }));
  const bool pure_kernel = op != Op::Rand && op != Op::GridValue && op != Op::GridGradient;
  const bool constant = pure_kernel && std::ranges::all_of(arguments, [&](NodeId a) { return is_constant(a); });
  return constant ? fold(n, arguments) : add(n, arguments);
}

NodeId Graph::curve(NodeId x, CurveTable table) {
  curves_.push_back(std::move(table));
  return make(Op::Curve, {x}, int(curves_.size()) - 1);
}

NodeId Graph::grid(Op op, NodeId place, std::shared_ptr<const Grid> grid) {
  const auto known = std::ranges::find(grids_, grid);
  const int index = int(known - grids_.begin());
  if (known == grids_.end()) grids_.push_back(std::move(grid));
  return make(op, {place}, index);
}

NodeId Graph::fold(const Node& n, std::span<const NodeId> arguments) {
  const CurveTable* curve = n.op == Op::Curve ? &curve_table(n.parameter) : nullptr;
  std::vector<float> operands;
  auto push = [&](NodeId a, int c) { operands.push_back(constant_value(a)[is_vector(a) ? c : 0]); };
  if (is_componentwise(n.op)) {
    std::array<NodeId, 3> values{};
    const int components = n.type == ValueType::Vector ? 3 : 1;
    for (int c = 0; c < components; ++c) {
      operands.clear();
      for (NodeId a : arguments) push(a, c);
      values[std::size_t(c)] = constant(run_once(n.op, n.parameter, curve, operands).x);
    }
    return components == 3 ? make_vector(values[0], values[1], values[2]) : values[0];
  }
  for (NodeId a : arguments)
    for (int c = 0; c < (is_vector(a) ? 3 : 1); ++c) push(a, c);
  const Vec3f v = run_once(n.op, n.parameter, curve, operands);
  if (n.type == ValueType::Scalar) return constant(v.x);
  return make_vector(constant(v.x), constant(v.y), constant(v.z));
}

}  // namespace meristem
