#include "renderer/language/override.h"

#include "geometry/fields/expression.h"
#include "renderer/language/jsonc_reader.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>

namespace meristem {

namespace {

class Override {
 public:
  Override(const std::string& text, int frame, Diagnostics& diagnostics)
      : source_(std::make_shared<SourceText>(SourceText{"--set", text})), frame_(frame), diagnostics_(diagnostics) {}

  void apply(Value& scene) {
    const std::size_t equals = text().find('=');
    if (text().empty() || text()[0] != '/' || equals == std::string::npos)
      return fail(0, "expected /path=value, such as /camera/fov=35");
    Value* at = &scene;
    for (std::size_t begin = 1; at && begin <= equals;) {
      const std::size_t end = std::min(text().find('/', begin), equals);
      at = step(*at, begin, end);
      begin = end + 1;
    }
    if (!at) return;
    if (std::optional<Value> value = value_from(equals + 1)) *at = std::move(*value);
  }

 private:
  const std::string& text() const { return source_->text; }
  Location place(std::size_t offset) const { return {source_, offset}; }
  void fail(std::size_t offset, std::string message) { diagnostics_.error(place(offset), std::move(message)); }

  static std::string unescaped(std::string_view part) {
    std::string result;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const bool escape = part[i] == '~' && i + 1 < part.size() && (part[i + 1] == '0' || part[i + 1] == '1');
      result += escape ? (part[++i] == '1' ? '/' : '~') : part[i];
    }
    return result;
  }

  // The part [begin, end) of the path from `value` on; null after an error.
  Value* step(Value& value, std::size_t begin, std::size_t end) {
    const std::string key = unescaped(std::string_view(text()).substr(begin, end - begin));
    if (value.kind == Value::Kind::Array) return item(value, key, begin);
    if (value.kind == Value::Kind::Null) value.kind = Value::Kind::Object;
    if (value.kind != Value::Kind::Object) {
      fail(begin, fmt::format("\"{}\" lies in {}, which has no members", key, value.kind_name()));
      return nullptr;
    }
    for (Member& member : value.members)
      if (member.key == key) return &member.value;
    Value made;
    made.location = place(begin);
    value.members.push_back({key, place(begin), std::move(made)});
    return &value.members.back().value;
  }

  Value* item(Value& list, const std::string& key, std::size_t begin) {
    std::size_t i = 0;
    const auto [after, error] = std::from_chars(key.data(), key.data() + key.size(), i);
    if (error == std::errc() && after == key.data() + key.size() && i < list.items.size()) return &list.items[i];
    fail(begin, fmt::format("no entry {}: the list has {}", key,
                            list.items.empty() ? "none" : fmt::format("the entries 0 to {}", list.items.size() - 1)));
    return nullptr;
  }

  std::optional<Value> value_from(std::size_t offset) {
    const std::string_view written = std::string_view(text()).substr(offset);
    if (written.starts_with('=')) return evaluated(offset + 1);
    if (is_json(written)) return read_json(offset);
    Value value;
    value.kind = Value::Kind::Text;
    value.text = written;
    value.location = place(offset);
    return value;
  }

  static bool is_json(std::string_view written) {
    if (written.empty()) return false;
    double number = 0;
    const char* const end = written.data() + written.size();
    const auto [after, error] = std::from_chars(written.data(), end, number);
    return (error == std::errc() && after == end) || written == "true" || written == "false" || written == "null" ||
           std::string_view("[{\"").find(written[0]) != std::string_view::npos;
  }

  // Read where it stands: what is before it is blanked, so that places in it are right.
  std::optional<Value> read_json(std::size_t offset) {
    auto blanked = std::make_shared<SourceText>(*source_);
    blanked->text.replace(0, offset, std::string(offset, ' '));
    Diagnostics mistakes;
    Value value = read_jsonc(blanked, mistakes);
    for (const Diagnostic& d : mistakes.list()) fail(d.location.offset, d.message);
    relocate(value);
    return mistakes.has_errors() ? std::nullopt : std::optional(std::move(value));
  }

  void relocate(Value& value) {
    value.location.source = source_;
    for (Value& item : value.items) relocate(item);
    for (Member& member : value.members) {
      member.key_location.source = source_;
      relocate(member.value);
    }
  }

  std::optional<Value> evaluated(std::size_t offset) {
    Symbols symbols;
    symbols.add("frame", ValueType::Scalar, "number of the frame");
    const std::array<Vec3f, 1> inputs{Vec3f(float(frame_), 0, 0)};
    const std::string formula = text().substr(offset);
    try {
      const auto scalar = compiled(formula, symbols, ValueType::Scalar);
      Value value = scalar ? number(double(scalar->evaluate_scalar(inputs)), offset) : Value{};
      if (!scalar) {
        value.kind = Value::Kind::Array;
        value.location = place(offset);
        const Vec3f v = Expression::compile(formula, symbols, ValueType::Vector)->evaluate_vector(inputs);
        for (int i = 0; i < 3; ++i) value.items.push_back(number(double(v[i]), offset));
      }
      return value;
    } catch (const ExpressionError& error) {
      fail(offset + error.offset, error.what());
      return std::nullopt;
    }
  }

  // Null if the formula is not of that type or not one at all.
  static std::shared_ptr<const Expression> compiled(const std::string& formula, const Symbols& symbols,
                                                    ValueType type) {
    try {
      return Expression::compile(formula, symbols, type);
    } catch (const ExpressionError&) {
      return nullptr;
    }
  }

  Value number(double x, std::size_t offset) const {
    Value value;
    value.kind = Value::Kind::Number;
    value.number = x;
    value.location = place(offset);
    return value;
  }

  std::shared_ptr<const SourceText> source_;
  int frame_;
  Diagnostics& diagnostics_;
};

}  // namespace

void apply_override(Value& scene, const std::string& text, int frame, Diagnostics& diagnostics) {
  Override(text, frame, diagnostics).apply(scene);
}

}  // namespace meristem
