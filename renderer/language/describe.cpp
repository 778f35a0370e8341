#include "renderer/language/describe.h"

#include "renderer/language/jsonc_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <sstream>

namespace meristem {

namespace {

constexpr std::size_t page_width = 100;

// What a kind is and where its components stand in a scene file.
struct KindPage {
  const char* kind;
  const char* title;
  const char* place;
};

constexpr KindPage kind_pages[] = {
    {"section", "Sections of a scene file", "Objects without a type."},
    {"base", "Base meshes", "The member \"base\" of a model: the mesh before the first step."},
    {"step", "Steps", "The list \"steps\" of a model. A step is recognised by the member of its name."},
    {"production", "Productions", "The lists in \"rules\" of a grow step: what a face with a symbol is replaced by."},
    {"template", "Templates", "The member \"template\" of a production; its parameters stand beside it."},
    {"grid", "Grids",
     "The section \"grids\": fields of samples by name. A grid is recognised by the member of its name."},
    {"material", "Materials", "The section \"materials\": materials by name."},
    {"light", "Lights", "The list \"lights\"."},
    {"camera", "Cameras", "The member \"camera\", or \"cameras\" by name."},
    {"integrator", "Integrators", "The section \"render\": how light is gathered."},
    {"sampler", "Samplers", "The section \"render\": where the random numbers come from."},
    {"filter", "Filters", "The section \"render\": how samples make pixels."},
};

KindPage page_of(const std::string& kind) {
  for (const KindPage& page : kind_pages)
    if (kind == page.kind) return page;
  return {kind.c_str(), kind.c_str(), ""};
}

// A Raw parameter's type, from its schema: "list", "object", "vector expression", "its own form".
std::string raw_type(const ParamInfo& param) {
  Diagnostics ignored;
  const Value schema = read_jsonc(std::make_shared<const SourceText>(SourceText{"", param.schema}), ignored);
  if (const Value* reference = schema.find("$ref")) {
    std::string name = reference->text.substr(reference->text.rfind('/') + 1);
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
  }
  const Value* const type = schema.find("type");
  if (!type || type->kind != Value::Kind::Text) return "its own form";
  return type->text == "array" ? "list" : type->text == "string" ? "text" : type->text;
}

std::string type_name(const ParamInfo& param) {
  using Type = ParamInfo::Type;
  switch (param.type) {
    case Type::Real: return "number";
    case Type::Integer: return "whole number";
    case Type::Boolean: return "true or false";
    case Type::Text: return "text";
    case Type::Choice: return fmt::format("one of {}", fmt::join(param.choices, ", "));
    case Type::Vector: return "[x, y, z]";
    case Type::Color: return "colour";
    case Type::ScalarExpression: return "expression";
    case Type::VectorExpression: return "vector expression";
    case Type::Component: return param.component_kind;
    case Type::Raw: return raw_type(param);
  }
  return {};
}

// "number, 0 to 180 deg"
std::string type_and_range(const ParamInfo& param) {
  std::string result = type_name(param);
  const std::string range = param.type == ParamInfo::Type::Color ? "" : range_text(param.range);
  if (!range.empty())
    result += ", " + range;
  else if (*param.range.unit)
    result += fmt::format(", {}", param.range.unit);
  return param.takes_time ? result + ", or an expression of time" : result;
}

// Breaks a text between words, each line at most page_width columns with its margin.
std::string wrapped(const std::string& text, std::size_t margin) {
  std::string result, line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!line.empty() && margin + line.size() + 1 + word.size() > page_width) {
      result += std::string(margin, ' ') + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return line.empty() ? result : result + std::string(margin, ' ') + line + "\n";
}

std::string param_text(const ParamInfo& param, std::size_t column) {
  std::string facts = type_and_range(param);
  if (param.required)
    facts += "; required";
  else if (!param.default_text.empty())
    facts += "; default " + param.default_text;
  std::string lines = wrapped(facts, column) + wrapped(param.doc, column);
  lines.replace(2, param.name.size(), param.name);
  return lines;
}

std::string page(const ComponentInfo& component) {
  const std::vector<ParamInfo> params = component.describe();
  std::string result = fmt::format("{} {}\n{}", component.kind, component.name, wrapped(component.doc, 2));
  std::size_t longest = 0;
  for (const ParamInfo& param : params) longest = std::max(longest, param.name.size());
  if (params.empty()) result += "\n  No parameters.\n";
  for (const ParamInfo& param : params) result += "\n" + param_text(param, longest + 4);
  return result;
}

std::string overview(const Catalogue& catalogue) {
  std::size_t longest = 0;
  for (const ComponentInfo& c : catalogue.components) longest = std::max(longest, c.name.size());
  std::string result;
  for (const std::string& kind : catalogue.kinds()) {
    const KindPage about = page_of(kind);
    result += fmt::format("{}{} ({})\n{}", result.empty() ? "" : "\n", about.title, kind, wrapped(about.place, 2));
    for (const ComponentInfo* c : catalogue.of_kind(kind)) {
      std::string lines = wrapped(c->doc.empty() ? "-" : c->doc, longest + 6);
      result += lines.replace(4, c->name.size(), c->name);
    }
  }
  return result;
}

std::string table_cell(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("|\n", at)) != std::string::npos; at += 2)
    text.replace(at, 1, text[at] == '|' ? "\\|" : "  ");
  return text;
}

std::string code_cell(const std::string& text) { return text.empty() ? "" : "`" + table_cell(text) + "`"; }

std::string markdown_component(const ComponentInfo& component) {
  std::string result = fmt::format("### {}\n\n{}\n\n", component.name, component.doc);
  const std::vector<ParamInfo> params = component.describe();
  if (params.empty()) return result + "No parameters.\n\n";
  result += "| parameter | type and range | default | meaning |\n|---|---|---|---|\n";
  for (const ParamInfo& param : params)
    result += fmt::format("| `{}` | {} | {} | {} |\n", param.name, table_cell(type_and_range(param)),
                          param.required ? "required" : code_cell(param.default_text), table_cell(param.doc));
  return result + "\n";
}

}  // namespace

std::string describe(const Catalogue& catalogue, const std::string& name) {
  if (name.empty()) return overview(catalogue);
  std::string result;
  for (const ComponentInfo& c : catalogue.components) {
    if (name != c.kind && name != c.name && name != c.kind + "." + c.name) continue;
    result += (result.empty() ? "" : "\n") + page(c);
  }
  return result;
}

std::vector<std::string> described_names(const Catalogue& catalogue) {
  std::set<std::string> names;
  for (const ComponentInfo& c : catalogue.components) names.insert({c.kind, c.name});
  return {names.begin(), names.end()};
}

std::string markdown(const Catalogue& catalogue) {
  std::string result =
      "# Components\n\nGenerated from the components themselves (`meristem describe --markdown`): every kind, every "
      "component, every "
      "parameter.\nAn *expression* is a number or a formula as text; a *vector expression* also `[x, y, z]` of these; "
      "a *colour* is "
      "`[red, green, blue]`\nin scene-linear Rec.709, or one number for grey.\n\n";
  for (const std::string& kind : catalogue.kinds()) {
    const KindPage about = page_of(kind);
    result += fmt::format("## {}\n\n{}\n\n", about.title, about.place);
    for (const ComponentInfo* c : catalogue.of_kind(kind)) result += markdown_component(*c);
  }
  return result;
}

}  // namespace meristem
