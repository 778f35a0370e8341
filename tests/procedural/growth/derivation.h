// What the tests of growth share: Values from JSON text with places, and models derived step by step.
#pragma once

#include "geometry/base/check.h"
#include "procedural/components.h"
#include "procedural/growth/forecast.h"
#include "procedural/growth/grow_step.h"

#include <cctype>
#include <charconv>
#include <set>
#include <string>

namespace meristem::test {

// Just enough JSON for tests: no escapes, and the text is taken to be right.
class JsonText {
 public:
  explicit JsonText(const std::string& text) : source_(std::make_shared<SourceText>(SourceText{"test", text})) {}

  Value read() {
    skip();
    Value v;
    v.location = {source_, at_};
    const char c = peek();
    if (c == '{')
      read_object(v);
    else if (c == '[')
      read_array(v);
    else if (c == '"') {
      v.kind = Value::Kind::Text;
      v.text = read_text();
    } else if (c == 'n')
      at_ += 4;  // null
    else
      read_number(v);
    skip();
    return v;
  }

 private:
  char peek() const { return at_ < source_->text.size() ? source_->text[at_] : '\0'; }
  void skip() {
    while (std::isspace(static_cast<unsigned char>(peek())) || peek() == ',' || peek() == ':') ++at_;
  }
  std::string read_text() {
    const std::size_t end = source_->text.find('"', at_ + 1);
    CHECK(end != std::string::npos, "an open string");
    std::string text = source_->text.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return text;
  }
  void read_object(Value& v) {
    v.kind = Value::Kind::Object;
    for (++at_, skip(); peek() != '}'; skip()) {
      Member m;
      m.key_location = {source_, at_};
      m.key = read_text();
      m.value = read();
      v.members.push_back(std::move(m));
    }
    ++at_;
  }
  void read_array(Value& v) {
    v.kind = Value::Kind::Array;
    for (++at_, skip(); peek() != ']'; skip()) v.items.push_back(read());
    ++at_;
  }
  void read_number(Value& v) {
    v.kind = Value::Kind::Number;
    const char* begin = source_->text.data() + at_;
    const auto result = std::from_chars(begin, source_->text.data() + source_->text.size(), v.number);
    CHECK(result.ec == std::errc{}, "not a number: {}", begin);
    at_ += std::size_t(result.ptr - begin);
  }

  std::shared_ptr<const SourceText> source_;
  std::size_t at_ = 0;
};

inline const TemplateRegistry& templates() {
  static const TemplateRegistry registry = [] {
    TemplateRegistry r;
    register_templates(r);
    return r;
  }();
  return registry;
}

inline const BaseRegistry& bases() {
  static const BaseRegistry registry = [] {
    BaseRegistry r("base");
    register_bases(r);
    return r;
  }();
  return registry;
}

// A base mesh and the grow steps over it.
struct Derivation {
  Diagnostics diagnostics;
  std::shared_ptr<GrowthSymbols> symbols = std::make_shared<GrowthSymbols>();
  Mesh base;
  std::vector<std::unique_ptr<GrowStep>> steps;
  Quantum quantum{0x1p-30};

  Derivation(const std::string& base_text, const std::vector<std::string>& step_texts, Key seed = 1,
             const std::string& folder = {}) {
    const auto material = [](const std::string& name, const Location&) { return int(name.size()); };
    GrowContext context{templates(), symbols, seed, material, folder};
    for (const std::string& text : step_texts)
      for (auto& step : make_grow_steps(JsonText(text).read(), context, diagnostics)) steps.push_back(std::move(step));
    const Value base_value = JsonText(base_text).read();
    if (const auto shape = bases().create(base_value, "", diagnostics)) {
      BaseContext base_context{*symbols, diagnostics, seed, -1, folder};
      base = shape->build(base_context);
    }
    snap_to_grid(base, quantum);
    for (auto& step : steps) step->set_quantum(quantum);
    symbols->report_terminals(diagnostics);
  }

  // Errors and warnings as "line:column message", in the order found.
  std::vector<std::string> messages() const {
    std::vector<std::string> result;
    for (const Diagnostic& d : diagnostics.list())
      result.push_back(fmt::format("{}:{} {}", d.location.line(), d.location.column(), d.message));
    return result;
  }

  CellMesh whole() const { return {base, base.face_count(), std::vector<std::uint8_t>(base.face_count(), 0)}; }
  CellMesh grown(std::size_t step_count) const {
    CellMesh cell = whole();
    for (std::size_t i = 0; i < step_count; ++i) {
      CellMesh next;
      steps[i]->apply(cell, 0, next);
      cell = std::move(next);
    }
    return cell;
  }
  Mesh grown() const { return grown(steps.size()).mesh; }
};

// The truth about a mesh as an Extent, for the symbols with rules.
inline Extent extent_of(const Mesh& mesh) {
  Extent e;
  e.u = e.v = {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  std::map<std::int32_t, SymbolRange> ranges;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.corners(f);
    const FaceFrame frame = face_frame(mesh, f);
    double radius = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3d p = mesh.positions[corners[i]];
      e.box.extend(p);
      radius = std::max(radius, length(p - frame.origin));
      for (std::size_t j = 0; j < corners.size(); ++j)
        if (corners.size() != 4 || j == (i + 1) % 4) e.edge = std::max(e.edge, length(p - mesh.positions[corners[j]]));
      const Vec2d uv = mesh.corner_uv.empty() ? mesh.uv.empty() ? Vec2d{} : mesh.uv[corners[i]]
                                              : mesh.corner_uv[mesh.face_starts[f] + i];
      e.u = {std::min(e.u.lower, float(uv.x)), std::max(e.u.upper, float(uv.x))};
      e.v = {std::min(e.v.lower, float(uv.y)), std::max(e.v.upper, float(uv.y))};
    }
    const FaceOrigin& origin = mesh.origins[mesh.face_origins[f]];
    if (origin.symbol < 0) continue;
    SymbolRange& range = ranges[origin.symbol];
    const bool is_new = range.symbol < 0;
    range.symbol = origin.symbol;
    range.radius = std::max(range.radius, std::nextafterf(float(radius), INFINITY));
    for (std::size_t i = 0; i < origin.parameters.size(); ++i) {
      const float p = origin.parameters[i];
      range.parameters[i] =
          is_new ? Interval{p, p}
                 : Interval{std::min(range.parameters[i].lower, p), std::max(range.parameters[i].upper, p)};
    }
  }
  for (const auto& [symbol, range] : ranges) e.symbols.push_back(range);
  return e;
}

// V - E + F.
inline int euler_characteristic(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto c = mesh.corners(f);
    for (std::size_t i = 0; i < c.size(); ++i) edges.insert(std::minmax(c[i], c[(i + 1) % c.size()]));
  }
  return int(mesh.vertex_count()) - int(edges.size()) + int(mesh.face_count());
}

// The faces that carry the symbol.
inline std::vector<std::uint32_t> faces_with(const Mesh& mesh, int symbol) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.origins[mesh.face_origins[f]].symbol == symbol) result.push_back(f);
  return result;
}

inline const std::string octagon =
    R"json({ "type": "prism", "sides": 8, "radius": 0.25, "height": 1, "cap": "shoot(1)" })json";

}  // namespace meristem::test
