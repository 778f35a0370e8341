#include "geometry/fields/parser.h"

#include "geometry/base/source.h"
#include "geometry/fields/builtins.h"
#include "geometry/fields/lexer.h"
#include "geometry/fields/time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>

namespace meristem {

namespace {

const char* type_name(bool is_vector) { return is_vector ? "a vector" : "a scalar"; }

// A value, or a text (then the node is meaningless), and the bytes it was written in.
struct Operand {
  NodeId node = 0;
  std::size_t begin = 0, end = 0;
  std::optional<std::string_view> text = std::nullopt;
};

struct BinaryOperator {
  std::string_view symbol;
  int precedence;
  Op op;
};
constexpr BinaryOperator binary_operators[] = {
    {"||", 1, Op::Or},  {"&&", 2, Op::And},       {"==", 3, Op::Equal},     {"!=", 3, Op::Equal}, {"<", 4, Op::Less},
    {">", 4, Op::Less}, {"<=", 4, Op::LessEqual}, {">=", 4, Op::LessEqual}, {"+", 5, Op::Add},    {"-", 5, Op::Sub},
    {"*", 6, Op::Mul},  {"/", 6, Op::Div},        {"%", 6, Op::Mod},        {"^", 7, Op::Pow}};
constexpr int arithmetic_precedence = 5;
constexpr int lowest_precedence = 1;

constexpr const char* time_name = "time";

// How many arguments a Builtin takes, from its letters.
struct Arity {
  explicit Arity(std::string_view letters) {
    for (char c : letters) {
      if (c == ';')
        optional = true;
      else if (c == '*')
        repeat_from = int(kinds.size());
      else
        kinds.push_back(c);
      if (!optional) least = int(kinds.size());
    }
  }
  bool accepts(int count) const {
    if (count < least) return false;
    if (repeat_from < 0) return count <= int(kinds.size());
    return (count - repeat_from) % (int(kinds.size()) - repeat_from) == 0;
  }
  char kind(int i) const {
    if (i < int(kinds.size())) return kinds[std::size_t(i)];
    return kinds[std::size_t(repeat_from + (i - repeat_from) % (int(kinds.size()) - repeat_from))];
  }
  // "2 arguments", "1 to 4 arguments", "at least 2 arguments"
  std::string described() const {
    const char* noun = least == 1 && (repeat_from >= 0 || int(kinds.size()) == 1) ? "argument" : "arguments";
    if (repeat_from >= 0) return fmt::format("at least {} {}", least, noun);
    if (least == int(kinds.size())) return fmt::format("{} {}", least, noun);
    return fmt::format("{} to {} arguments", least, kinds.size());
  }

  std::string kinds;
  int least = 0;
  int repeat_from = -1;
  bool optional = false;
};

class Parser final : public CallContext {
 public:
  Parser(std::string_view text, const Symbols& symbols) : text_(text), symbols_(symbols), lexer_(text) {}

  ParsedExpression run(ValueType wanted) {
    try {
      advance();
      statements();
      const Operand result = expression();
      if (token_.is(";")) advance();
      if (token_.kind != Token::Kind::End) fail_at_token("expected an operator or the end");
      const NodeId node = typed_result(result, wanted);
      return {std::move(graph_), node};
    } catch (const Graph::TooLarge&) {
      throw ExpressionError(fmt::format("the expression has more than {} operations", Graph::max_nodes), token_.offset,
                            token_.length);
    }
  }

  Graph& graph() override { return graph_; }
  int next_occurrence() override { return occurrences_++; }
  std::shared_ptr<const Grid> grid(std::size_t name, std::size_t grid_name) override {
    const auto& list = *call_arguments_;
    GridSource* const grids = GridScope::current();
    if (!grids) fail(name, "grids cannot be named here");
    try {
      return grids->open(std::string(*list[name].text),
                         grid_name < list.size() ? std::string(*list[grid_name].text) : std::string());
    } catch (const std::runtime_error& error) {
      fail(name, error.what());
    }
  }
  [[noreturn]] void fail(std::size_t argument, const std::string& message) override {
    const auto& list = *call_arguments_;
    fail_at(list[std::min(argument, list.size() - 1)], message);
  }

 private:
  // Counts nesting while it lives.
  class Level {
   public:
    explicit Level(Parser& p) : parser_(p) {
      if (++parser_.depth_ > max_expression_nesting)
        parser_.fail_here(fmt::format("nested more than {} deep", max_expression_nesting));
    }
    ~Level() { --parser_.depth_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;

   private:
    Parser& parser_;
  };

  // Errors
  [[noreturn]] void fail_here(const std::string& message) const {
    throw ExpressionError(message, token_.offset, std::max<std::size_t>(token_.length, 1));
  }
  [[noreturn]] void fail_at_token(const std::string& expected) const {
    if (token_.kind == Token::Kind::End)
      fail_here(expected + (text_.starts_with('#') ? "; '#' begins a comment, and a colour is [r, g, b] from 0 to 1"
                                                   : ", not the end of the expression"));
    fail_here(fmt::format("{}, not '{}'", expected, text_.substr(token_.offset, token_.length)));
  }
  [[noreturn]] static void fail_at(const Operand& o, const std::string& message) {
    throw ExpressionError(message, o.begin, o.end - o.begin);
  }
  [[noreturn]] static void fail_unknown(const char* what, const Token& name, const std::vector<std::string>& known,
                                        const std::vector<std::string>& listed) {
    std::string message = fmt::format("unknown {} \"{}\"", what, name.text);
    if (const std::string_view nearest = nearest_name(name.text, known); !nearest.empty())
      message += fmt::format("; did you mean \"{}\"?", nearest);
    else if (!listed.empty())
      message += fmt::format("; known: {}", fmt::join(listed, ", "));
    throw ExpressionError(message, name.offset, name.length);
  }

  // Tokens
  void advance() {
    previous_end_ = token_.offset + token_.length;
    token_ = lexer_.next();
  }
  Token take() {
    const Token t = token_;
    advance();
    return t;
  }
  void expect(std::string_view symbol, const char* why) {
    if (!token_.is(symbol)) fail_at_token(fmt::format("expected '{}' {}", symbol, why));
    advance();
  }
  Token peek() {
    const std::size_t position = lexer_.position();
    const Token t = lexer_.next();
    lexer_.seek(position);
    return t;
  }
  Operand since(std::size_t begin, NodeId node) const { return {node, begin, previous_end_}; }

  // Statements
  static bool assigns(const Token& t) {
    static constexpr std::string_view operators[] = {"=", "+=", "-=", "*=", "/=", "%=", "^="};
    return t.kind == Token::Kind::Symbol && std::ranges::find(operators, t.text) != std::end(operators);
  }
  void statements() {
    for (;;) {
      if (token_.is_word("if"))
        if_statement();
      else if (token_.kind == Token::Kind::Name && assigns(peek()))
        assignment();
      else
        return;
    }
  }
  void assignment() {
    const Token name = take();
    const std::string_view sign = take().text;
    Operand value;
    if (sign == "=") {
      value = expression();
    } else {
      const Operand old{variable(name), name.offset, name.offset + name.length};
      value = binary(operator_of(sign.substr(0, 1)), old, expression());
    }
    expect(";", "after an assignment");
    assign(std::string(name.text), value.node);
  }
  void assign(const std::string& name, NodeId value) {
    const auto found = locals_.find(name);
    undo_.emplace_back(name, found == locals_.end() ? -1 : found->second);
    locals_[name] = value;
  }

  // The statements between braces; what they assigned, with the values before undone.
  std::map<std::string, NodeId> block() {
    expect("{", "before the statements of an if");
    const std::size_t mark = undo_.size();
    statements();
    expect("}", "after the statements of an if");
    return roll_back(mark);
  }
  std::map<std::string, NodeId> roll_back(std::size_t mark) {
    std::map<std::string, NodeId> assigned;
    for (; undo_.size() > mark; undo_.pop_back()) {
      const auto& [name, old] = undo_.back();
      assigned.emplace(name, locals_.at(name));
      if (old < 0)
        locals_.erase(name);
      else
        locals_[name] = old;
    }
    return assigned;
  }
  // Both branches are evaluated; a variable then has the value of the branch taken. One that only one branch knows is
  // unknown after it.
  void if_statement() {
    const Level level(*this);
    const Token word = take();
    expect("(", "after if");
    const Operand condition = scalar(expression(), "a condition");
    expect(")", "after the condition");
    const auto then = block();
    std::map<std::string, NodeId> otherwise;
    if (token_.is_word("else")) {
      advance();
      if (token_.is_word("if")) {
        const std::size_t mark = undo_.size();
        if_statement();
        otherwise = roll_back(mark);
      } else {
        otherwise = block();
      }
    }
    merge(condition, then, otherwise, Operand{0, word.offset, word.offset + word.length});
  }
  void merge(const Operand& condition, const std::map<std::string, NodeId>& then,
             const std::map<std::string, NodeId>& otherwise, const Operand& word) {
    auto names = then;
    names.insert(otherwise.begin(), otherwise.end());
    for (const auto& [name, unused] : names) {
      const NodeId a = value_in(then, name), b = value_in(otherwise, name);
      if (a < 0 || b < 0) continue;
      if (graph_.is_vector(a) != graph_.is_vector(b))
        fail_at(word, fmt::format("\"{}\" is {} in one branch and {} in the other", name,
                                  type_name(graph_.is_vector(a)), type_name(graph_.is_vector(b))));
      assign(name, graph_.make(Op::Select, {condition.node, a, b}));
    }
  }
  NodeId value_in(const std::map<std::string, NodeId>& branch, const std::string& name) {
    if (const auto found = branch.find(name); found != branch.end()) return found->second;
    return known_value(name);
  }

  // Values
  NodeId known_value(std::string_view name) {
    if (const auto local = locals_.find(std::string(name)); local != locals_.end()) return local->second;
    if (const int slot = symbols_.find(name); slot >= 0) return graph_.input(slot, symbols_.type(slot));
    if (name == "PI") return graph_.constant(float(pi));
    if (name == "E") return graph_.constant(2.71828182845904523536f);
    if (name == time_name && TimeScope::current()) return graph_.constant(float(TimeScope::current()->read()));
    return -1;
  }
  NodeId variable(const Token& name) {
    if (const NodeId value = known_value(name.text); value >= 0) return value;
    if (const Builtin* function = find_builtin(name.text))
      throw ExpressionError(fmt::format("\"{}\" is a function: {}", name.text, function->info.signature), name.offset,
                            name.length);
    std::vector<std::string> inputs;
    for (int i = 0; i < symbols_.size(); ++i) inputs.push_back(symbols_.name(i));
    if (TimeScope::current() && symbols_.find(time_name) < 0) inputs.push_back(time_name);
    std::vector<std::string> known = inputs;
    for (const auto& [local, unused] : locals_) known.push_back(local);
    fail_unknown("variable", name, known, inputs);
  }

  Operand scalar(const Operand& o, const char* what) const {
    if (graph_.is_vector(o.node)) fail_at(o, fmt::format("{} must be a scalar, not a vector", what));
    return o;
  }
  NodeId typed_result(const Operand& o, ValueType wanted) {
    if (wanted == ValueType::Vector) return graph_.to_vector(o.node);
    if (graph_.is_vector(o.node))
      fail_at(o, "the result must be a scalar, not a vector; one component is v[0], the length is length(v)");
    return o.node;
  }

  // expression = choice { "->" name "(" arguments ")" }
  Operand expression() {
    const Level level(*this);
    Operand value = choice();
    while (token_.is("->")) {
      advance();
      if (token_.kind != Token::Kind::Name) fail_at_token("expected a function after '->'");
      value = call(take(), &value);
    }
    return value;
  }
  Operand choice() {
    const Operand condition = binary_chain(lowest_precedence);
    if (!token_.is("?")) return condition;
    advance();
    scalar(condition, "a condition");
    const Operand a = expression();
    expect(":", "between the two values of '?'");
    const Operand b = expression();
    return since(condition.begin, graph_.make(Op::Select, {condition.node, a.node, b.node}));
  }

  static const BinaryOperator& operator_of(std::string_view symbol) {
    return *std::ranges::find(binary_operators, symbol, &BinaryOperator::symbol);
  }
  Operand binary_chain(int least) {
    Operand left = unary();
    for (;;) {
      const auto* found = token_.kind == Token::Kind::Symbol
                              ? std::ranges::find(binary_operators, token_.text, &BinaryOperator::symbol)
                              : std::end(binary_operators);
      if (found == std::end(binary_operators) || found->precedence < least || found->op == Op::Pow) return left;
      advance();
      left = binary(*found, left, binary_chain(found->precedence + 1));
    }
  }
  Operand binary(const BinaryOperator& o, const Operand& a, const Operand& b) {
    if (o.precedence < arithmetic_precedence) {
      const std::string what = fmt::format("an operand of '{}'", o.symbol);
      scalar(a, what.c_str());
      scalar(b, what.c_str());
    }
    const bool swapped = o.symbol == ">" || o.symbol == ">=";
    NodeId node = graph_.make(o.op, {swapped ? b.node : a.node, swapped ? a.node : b.node});
    if (o.symbol == "!=") node = graph_.make(Op::Not, {node});
    return since(a.begin, node);
  }
  Operand unary() {
    const std::size_t begin = token_.offset;
    if (!token_.is("-") && !token_.is("!") && !token_.is("~") && !token_.is("+")) return power();
    const Level level(*this);
    const Token sign = take();
    const Operand a = unary();
    if (sign.is("+")) return since(begin, a.node);
    if (sign.is("!")) return since(begin, graph_.make(Op::Not, {scalar(a, "an operand of '!'").node}));
    return since(begin, graph_.make(Op::Sub, {graph_.constant(sign.is("~") ? 1.0f : 0.0f), a.node}));
  }
  // The exponent may have a sign: 2^-x; powers group from the right.
  Operand power() {
    const Operand base = postfix();
    if (!token_.is("^")) return base;
    const Level level(*this);
    advance();
    const Operand exponent = unary();
    return since(base.begin, graph_.make(Op::Pow, {base.node, exponent.node}));
  }
  Operand postfix() {
    Operand value = primary();
    while (token_.is("[")) {
      if (!graph_.is_vector(value.node)) fail_at(value, "only a vector has components; this is a scalar");
      advance();
      const Operand index = expression();
      expect("]", "after the index");
      value = since(value.begin, component(value.node, index));
    }
    return value;
  }
  NodeId component(NodeId vector, const Operand& index) {
    scalar(index, "an index");
    const bool constant = graph_.is_constant(index.node);
    const float i = constant ? graph_.constant_value(index.node).x : 0;
    if (!constant || (i != 0 && i != 1 && i != 2)) fail_at(index, "an index must be 0, 1 or 2");
    return graph_.component(vector, int(i));
  }

  Operand primary() {
    const std::size_t begin = token_.offset;
    if (token_.kind == Token::Kind::Number) {
      const float value = take().number;
      return since(begin, graph_.constant(value));
    }
    if (token_.kind == Token::Kind::Name) {
      const Token name = take();
      if (token_.is("(")) return call(name, nullptr);
      return since(begin, variable(name));
    }
    if (token_.is("(")) {
      advance();
      const NodeId node = expression().node;
      close(")", begin, "'('");
      return since(begin, node);
    }
    if (token_.is("[")) return vector_literal();
    if (token_.kind == Token::Kind::Text) fail_here("a text can only be an argument of a function such as vdb");
    fail_at_token("expected a value");
  }
  void close(std::string_view symbol, std::size_t opened, const char* what) {
    if (!token_.is(symbol))
      fail_at_token(fmt::format("expected '{}' for the {} at column {}", symbol, what, opened + 1));
    advance();
  }
  Operand vector_literal() {
    const std::size_t begin = take().offset;
    std::array<NodeId, 3> parts{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (i > 0) expect(",", "between the three components of a vector");
      parts[i] = scalar(expression(), "a component of a vector").node;
    }
    close("]", begin, "'['");
    return since(begin, graph_.make_vector(parts[0], parts[1], parts[2]));
  }

  // Calls. `first` is what stands before "->".
  Operand call(const Token& name, const Operand* first) {
    const Builtin* function = find_builtin(name.text);
    if (!function) fail_unknown("function", name, builtin_names(), {});
    std::vector<Operand> arguments;
    if (first) arguments.push_back(*first);
    parse_arguments(name, arguments);
    check(*function, name, arguments);
    std::vector<NodeId> nodes;
    for (const Operand& a : arguments) nodes.push_back(a.node);
    call_arguments_ = &arguments;
    return since(first ? first->begin : name.offset, function->build(*this, nodes));
  }
  Operand argument() {
    if (token_.kind != Token::Kind::Text) return expression();
    const Token text = take();
    return {graph_.constant(0), text.offset, text.offset + text.length, text.text};
  }
  void parse_arguments(const Token& name, std::vector<Operand>& arguments) {
    const std::size_t opened = token_.offset;
    expect("(", "after the name of a function");
    if (!token_.is(")")) {
      arguments.push_back(argument());
      while (token_.is(",")) {
        advance();
        arguments.push_back(argument());
      }
    }
    close(")", opened, fmt::format("'(' of {}", name.text).c_str());
  }
  void check(const Builtin& function, const Token& name, const std::vector<Operand>& arguments) {
    const Arity arity(function.arguments);
    if (!arity.accepts(int(arguments.size())))
      throw ExpressionError(fmt::format("{} takes {}, not {}: {}", name.text, arity.described(), arguments.size(),
                                        function.info.signature),
                            name.offset, name.length);
    for (std::size_t i = 0; i < arguments.size(); ++i) check_type(function, arguments[i], i, arity.kind(int(i)));
  }
  void check_type(const Builtin& function, const Operand& argument, std::size_t index, char kind) {
    if ((kind == 't') != argument.text.has_value())
      fail_at(argument,
              fmt::format("argument {} must be {}: {}", index + 1,
                          kind == 't' ? "a text such as 'rock.vdb'" : "a value, not a text", function.info.signature));
    const bool vector = graph_.is_vector(argument.node);
    if ((kind == 's' || kind == 'k') && vector)
      fail_at(argument,
              fmt::format("argument {} must be a scalar, not a vector: {}", index + 1, function.info.signature));
    if ((kind == 'v' || kind == 'm') && !vector)
      fail_at(argument,
              fmt::format("argument {} must be a vector, not a scalar: {}", index + 1, function.info.signature));
    if ((kind == 'k' || kind == 'm') && !graph_.is_constant(argument.node))
      fail_at(argument, fmt::format("argument {} must be a constant: {}", index + 1, function.info.signature));
  }

  std::string_view text_;
  const Symbols& symbols_;
  Lexer lexer_;
  Token token_;
  std::size_t previous_end_ = 0;
  Graph graph_;
  std::map<std::string, NodeId> locals_;
  std::vector<std::pair<std::string, NodeId>> undo_;  // assignments, with the value before (-1: none)
  const std::vector<Operand>* call_arguments_ = nullptr;
  int depth_ = 0;
  int occurrences_ = 0;
};

}  // namespace

ParsedExpression parse_expression(std::string_view text, const Symbols& symbols, ValueType wanted) {
  if (text.size() > max_expression_bytes)
    throw ExpressionError(fmt::format("the expression is longer than {} bytes", max_expression_bytes),
                          max_expression_bytes, 1);
  return Parser(text, symbols).run(wanted);
}

}  // namespace meristem
