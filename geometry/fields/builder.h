// Builder: what the builtins make graphs with; and their groups, which builtins.cpp joins. Not thread-safe, as the
// graph.
#pragma once

#include "geometry/fields/builtins.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

namespace meristem {

using Arguments = std::span<const NodeId>;

// Shorthands for building: B is a graph with operators as functions.
struct Builder {
  explicit Builder(CallContext& c) : call(c), g(c.graph()) {}

  NodeId number(double v) { return g.constant(float(v)); }
  NodeId add(NodeId a, NodeId b) { return g.make(Op::Add, {a, b}); }
  NodeId sub(NodeId a, NodeId b) { return g.make(Op::Sub, {a, b}); }
  NodeId mul(NodeId a, NodeId b) { return g.make(Op::Mul, {a, b}); }
  NodeId div(NodeId a, NodeId b) { return g.make(Op::Div, {a, b}); }
  NodeId min(NodeId a, NodeId b) { return g.make(Op::Min, {a, b}); }
  NodeId max(NodeId a, NodeId b) { return g.make(Op::Max, {a, b}); }
  NodeId less(NodeId a, NodeId b) { return g.make(Op::Less, {a, b}); }
  NodeId at_least(NodeId a, NodeId b) { return g.make(Op::LessEqual, {b, a}); }
  NodeId equal(NodeId a, NodeId b) { return g.make(Op::Equal, {a, b}); }
  NodeId select(NodeId condition, NodeId a, NodeId b) { return g.make(Op::Select, {condition, a, b}); }
  NodeId mix(NodeId a, NodeId b, NodeId t) { return g.make(Op::Mix, {a, b, t}); }
  NodeId unary(Op op, NodeId a) { return g.make(op, {a}); }
  NodeId clamp(NodeId a, NodeId lower, NodeId upper) { return min(max(a, lower), upper); }
  NodeId unit_clamp(NodeId a) { return clamp(a, number(0), number(1)); }
  NodeId pow(NodeId a, NodeId b) { return g.make(Op::Pow, {a, b}); }
  NodeId argument_or(Arguments a, std::size_t i, double fallback) { return i < a.size() ? a[i] : number(fallback); }

  // A constant integer argument within [lower, upper].
  int integer(Arguments a, std::size_t i, int fallback, int lower, int upper, const char* what) {
    if (i >= a.size()) return fallback;
    const float v = g.constant_value(a[i]).x;
    if (v != std::floor(v) || v < float(lower) || v > float(upper))
      call.fail(i, fmt::format("{} must be a whole number from {} to {}, not {}", what, lower, upper, v));
    return int(v);
  }

  CallContext& call;
  Graph& g;
};

template <Op op>
NodeId direct(CallContext& call, Arguments a) {
  return call.graph().make(op, a);
}

// 1 within range of source, 0 beyond range + falloff; between them by interpolation: 0 linear, 1 smooth, 2 gaussian.
NodeId remap_of(Builder& b, NodeId x, NodeId source, NodeId range, NodeId falloff, NodeId interpolation);

// The builtins by group, in the order of docs/expressions.md.
std::span<const Builtin> arithmetic_builtins();  // numbers, angles, ramps, vectors
std::span<const Builtin> colour_builtins();
std::span<const Builtin> noise_builtins();
std::span<const Builtin> chance_builtins();
std::span<const Builtin> curve_builtins();  // and grids

}  // namespace meristem
