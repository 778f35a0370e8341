// The parser: text of the expression language to a graph. Recursive descent, of bounded depth.
#pragma once

#include "geometry/fields/graph.h"

#include <string_view>

namespace meristem {

constexpr std::size_t max_expression_bytes = 64 * 1024;
constexpr int max_expression_nesting = 200;

struct ParsedExpression {
  Graph graph;
  NodeId result = 0;  // of the wanted type
};

// Throws ExpressionError.
ParsedExpression parse_expression(std::string_view text, const Symbols& symbols, ValueType wanted);

}  // namespace meristem
