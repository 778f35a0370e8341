#include "geometry/fields/builder.h"

#include <vector>

namespace meristem {

namespace {

NodeId hash(CallContext& call, Arguments a) {
  std::vector<NodeId> parts;
  for (NodeId n : a)
    for (int c = 0; c < (call.graph().is_vector(n) ? 3 : 1); ++c)
      parts.push_back(call.graph().is_vector(n) ? call.graph().component(n, c) : n);
  return call.graph().make(Op::Hash, parts);
}
NodeId rand(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId uniform = b.g.make(Op::Rand, {b.argument_or(a, 2, 0)}, call.next_occurrence());
  if (a.empty()) return uniform;
  return b.mix(a[0], b.argument_or(a, 1, 1), uniform);
}

// values[i] where position lies in [i, i + 1); the last from there on.
NodeId pick_by_index(Builder& b, NodeId position, Arguments values) {
  NodeId result = values[values.size() - 1];
  for (std::size_t i = values.size() - 1; i-- > 0;)
    result = b.select(b.less(position, b.number(double(i + 1))), values[i], result);
  return result;
}
void want_equal_types(Builder& b, Arguments a, std::size_t first, std::size_t stride) {
  for (std::size_t i = first; i < a.size(); i += stride)
    if (b.g.is_vector(a[i]) != b.g.is_vector(a[first])) b.call.fail(i, "all choices must be scalars or all vectors");
}
NodeId choose(CallContext& call, Arguments a) {
  Builder b(call);
  want_equal_types(b, a, 1, 1);
  return pick_by_index(b, b.mul(a[0], b.number(double(a.size() - 1))), a.subspan(1));
}
NodeId swatch(CallContext& call, Arguments a) {
  Builder b(call);
  want_equal_types(b, a, 1, 1);
  return pick_by_index(b, a[0], a.subspan(1));
}
NodeId wchoose(CallContext& call, Arguments a) {
  Builder b(call);
  want_equal_types(b, a, 1, 2);
  NodeId total = b.number(0);
  std::vector<NodeId> ends;
  for (std::size_t i = 2; i < a.size(); i += 2) ends.push_back(total = b.add(total, b.max(a[i], b.number(0))));
  const NodeId position = b.mul(a[0], total);
  NodeId result = a[a.size() - 2];
  for (std::size_t i = ends.size() - 1; i-- > 0;) result = b.select(b.less(position, ends[i]), a[1 + 2 * i], result);
  return result;
}
// The whole number of [lower, upper] at an index that wraps.
NodeId cycle(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId lower = b.unary(Op::Floor, a[1]), upper = b.unary(Op::Floor, a[2]);
  const NodeId count = b.add(b.sub(upper, lower), b.number(1));
  return b.add(lower, b.g.make(Op::Mod, {b.unary(Op::Floor, a[0]), count}));
}
NodeId pick(CallContext& call, Arguments a) {
  Builder b(call);
  const NodeId lower = b.unary(Op::Floor, a[1]), upper = b.unary(Op::Floor, a[2]);
  const NodeId count = b.add(b.sub(upper, lower), b.number(1));
  return b.clamp(b.add(lower, b.unary(Op::Floor, b.mul(a[0], count))), lower, upper);
}

constexpr Builtin builtins[] = {
    {{"hash", "chance", "hash(a, ...)", "a random number in [0, 1) that depends on the arguments alone"}, "*c", hash},
    {{"rand", "chance", "rand(min=0, max=1, seed=0)",
      "a random number of this vertex or face, another one for each rand in the text"},
     ";sss",
     rand},
    {{"choose", "chance", "choose(index, a, b, ...)", "index in [0, 1) chooses with equal shares"}, "sc*c", choose},
    {{"wchoose", "chance", "wchoose(index, a, weight, ...)", "index in [0, 1) chooses with shares by weight"},
     "s*cs",
     wchoose},
    {{"swatch", "chance", "swatch(index, a, b, ...)", "index in [0, 1) chooses the first, in [1, 2) the second, ..."},
     "sc*c",
     swatch},
    {{"pick", "chance", "pick(index, lo, hi)", "index in [0, 1) chooses a whole number from lo to hi"}, "sss", pick},
    {{"cycle", "chance", "cycle(index, lo, hi)", "lo to hi and around again as index counts up"}, "sss", cycle},
};

}  // namespace

std::span<const Builtin> chance_builtins() { return builtins; }

}  // namespace meristem
