#include "geometry/fields/expression.h"

#include "geometry/base/check.h"
#include "geometry/fields/interval.h"
#include "geometry/fields/parser.h"
#include "geometry/fields/program.h"

#include <optional>

namespace meristem {

int Symbols::add(std::string name, ValueType type, std::string doc) {
  CHECK(find(name) < 0, "the variable {} is there already", name);
  entries_.push_back({std::move(name), type, std::move(doc)});
  return size() - 1;
}

int Symbols::find(std::string_view name) const {
  for (int i = 0; i < size(); ++i)
    if (entries_[std::size_t(i)].name == name) return i;
  return -1;
}

namespace {

bool has_inputs(const Graph& graph, NodeId result) {
  for (NodeId i = 0; i <= result; ++i)
    if (graph.node(i).op == Op::Input) return true;
  return false;
}

class CompiledExpression final : public Expression {
 public:
  CompiledExpression(std::string_view text, ParsedExpression parsed)
      : text_(text), graph_(std::move(parsed.graph)), result_(parsed.result), program_(graph_, result_) {
    if (!has_inputs(graph_, result_)) fixed_bounds_ = bounds_of(graph_, result_, {});
  }

  ValueType type() const override { return graph_.node(result_).type; }
  bool is_constant() const override { return graph_.is_constant(result_); }
  bool uses(int slot) const override { return program_.uses(slot); }
  bool uses_random() const override { return program_.uses_random(); }
  const std::string& text() const override { return text_; }

  void evaluate(const Block& block, float* x, float* y, float* z) const override {
    program_.run(best_kernels(), block, x, y, z);
  }
  Vec3f evaluate_point(std::span<const Vec3f> values, Key key, Key salt) const override {
    return program_.run_one(best_kernels(), values, key, salt);
  }
  IntervalValue evaluate_bounds(std::span<const IntervalValue> inputs) const override {
    return fixed_bounds_ ? *fixed_bounds_ : bounds_of(graph_, result_, inputs);
  }

 private:
  std::string text_;
  Graph graph_;
  NodeId result_;
  Program program_;
  std::optional<IntervalValue> fixed_bounds_;  // where they do not depend on inputs
};

}  // namespace

std::shared_ptr<const Expression> Expression::compile(std::string_view text, const Symbols& symbols, ValueType wanted) {
  return std::make_shared<CompiledExpression>(text, parse_expression(text, symbols, wanted));
}

float Expression::evaluate_scalar(std::span<const Vec3f> values, Key key, Key salt) const {
  CHECK(type() == ValueType::Scalar, "\"{}\" is a vector", text());
  return evaluate_point(values, key, salt).x;
}

Vec3f Expression::evaluate_vector(std::span<const Vec3f> values, Key key, Key salt) const {
  CHECK(type() == ValueType::Vector, "\"{}\" is a scalar", text());
  return evaluate_point(values, key, salt);
}

}  // namespace meristem
