// Builtin: a function of the expression language: what it takes, what it says of itself, and the graph it stands for.
#pragma once

#include "geometry/fields/functions.h"
#include "geometry/fields/graph.h"

#include <string>
#include <vector>

namespace meristem {

// What a call may ask of the parser: the graph, a number for each textual rand(), and errors at one of its arguments.
class CallContext {
 public:
  virtual ~CallContext() = default;
  virtual Graph& graph() = 0;
  virtual int next_occurrence() = 0;
  // The grid that the texts at these arguments name; the second may be absent.
  virtual std::shared_ptr<const Grid> grid(std::size_t name, std::size_t grid_name) = 0;
  [[noreturn]] virtual void fail(std::size_t argument, const std::string& message) = 0;
};

struct Builtin {
  FunctionInfo info;
  // One letter an argument: s scalar, v vector, c scalar or vector (componentwise), k constant scalar, m constant
  // vector, t text. Those behind a ';' may be left out; those behind a '*' are repeated, at least once as a group.
  std::string_view arguments;
  NodeId (*build)(CallContext& call, std::span<const NodeId> arguments);
};

const Builtin* find_builtin(std::string_view name);
const std::vector<std::string>& builtin_names();

}  // namespace meristem
