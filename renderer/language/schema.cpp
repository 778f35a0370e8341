#include "renderer/language/schema.h"

#include "geometry/base/check.h"
#include "renderer/language/json_writer.h"
#include "renderer/language/jsonc_reader.h"
#include "renderer/language/scene_file.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <utility>

namespace meristem {

namespace {

// Short ways to write a tree of Values

Value text(std::string s) {
  Value v;
  v.kind = Value::Kind::Text;
  v.text = std::move(s);
  return v;
}

Value number(double x) {
  Value v;
  v.kind = Value::Kind::Number;
  v.number = x;
  return v;
}

Value boolean(bool b) {
  Value v;
  v.kind = Value::Kind::Bool;
  v.boolean = b;
  return v;
}

Value array(std::vector<Value> items) {
  Value v;
  v.kind = Value::Kind::Array;
  v.items = std::move(items);
  return v;
}

Value texts(const std::vector<std::string>& list) {
  Value v = array({});
  for (const std::string& s : list) v.items.push_back(text(s));
  return v;
}

void set(Value& object, std::string key, Value value) {
  object.members.push_back({std::move(key), {}, std::move(value)});
}

Value object(std::initializer_list<std::pair<const char*, Value>> members) {
  Value v;
  v.kind = Value::Kind::Object;
  for (const auto& [key, value] : members) set(v, key, value);
  return v;
}

Value parsed(const std::string& json, Diagnostics& diagnostics) {
  return read_jsonc(std::make_shared<const SourceText>(SourceText{"", json}), diagnostics);
}

// The pieces of the schema

Value reference(const std::string& definition) { return object({{"$ref", text("#/definitions/" + definition)}}); }

// Draft 7 ignores what stands beside "$ref", so a reference that is to carry a description stands in "allOf".
Value reference_to_describe(const std::string& definition) {
  return object({{"allOf", array({reference(definition)})}});
}

Value type(const char* name) { return object({{"type", text(name)}}); }

Value number_schema(const char* type_name, const Range& range) {
  Value schema = type(type_name);
  if (std::isfinite(range.min)) set(schema, "minimum", number(range.min));
  if (std::isfinite(range.max)) set(schema, "maximum", number(range.max));
  return schema;
}

Value triple(Value item) {
  return object(
      {{"type", text("array")}, {"items", std::move(item)}, {"minItems", number(3)}, {"maxItems", number(3)}});
}

Value raw_schema(const ParamInfo& param) {
  if (param.schema.empty()) return object({});
  Diagnostics diagnostics;
  Value schema = parsed(param.schema, diagnostics);
  CHECK(!diagnostics.has_errors() && schema.kind == Value::Kind::Object,
        "the schema of parameter \"{}\" is no JSON object: {}", param.name, param.schema);
  return schema.find("$ref") ? object({{"allOf", array({std::move(schema)})}}) : schema;
}

Value type_schema(const ParamInfo& param) {
  using Type = ParamInfo::Type;
  switch (param.type) {
    case Type::Real: return number_schema("number", param.range);
    case Type::Integer: return number_schema("integer", param.range);
    case Type::Boolean: return type("boolean");
    case Type::Text: return type("string");
    case Type::Choice: return object({{"enum", texts(param.choices)}});
    case Type::Vector: return triple(number_schema("number", param.range));
    case Type::Color: {
      const Value channel = number_schema("number", not_negative);
      return object({{"anyOf", array({channel, triple(channel)})}});
    }
    case Type::ScalarExpression: return reference_to_describe("expression");
    case Type::VectorExpression: return reference_to_describe("vector_expression");
    case Type::Component: return reference_to_describe(param.component_kind);
    case Type::Raw: return raw_schema(param);
  }
  return object({});
}

// With expressions of time as texts: for the whole, and for each component.
Value timed_schema(const ParamInfo& param) {
  using Type = ParamInfo::Type;
  Value either = array({type("string")});
  if (param.type != Type::Vector) either.items.push_back(number_schema("number", param.range));
  if (param.type != Type::Real)
    either.items.push_back(triple(object({{"anyOf", array({type("string"), number_schema("number", param.range)})}})));
  return object({{"anyOf", std::move(either)}});
}

Value param_schema(const ParamInfo& param) {
  Value schema = param.takes_time ? timed_schema(param) : type_schema(param);
  const std::string unit = *param.range.unit ? fmt::format(" ({})", param.range.unit) : "";
  if (!schema.find("description") && !(param.doc + unit).empty()) set(schema, "description", text(param.doc + unit));
  if (param.default_text.empty()) return schema;
  Diagnostics diagnostics;
  Value fallback = parsed(param.default_text, diagnostics);
  CHECK(!diagnostics.has_errors(), "the default of parameter \"{}\" is no JSON: {}", param.name, param.default_text);
  set(schema, "default", std::move(fallback));
  return schema;
}

// The object of one component. `name_key` is the member that names it, or empty.
Value component_schema(const ComponentInfo& component, const std::string& name_key, bool closed) {
  Value properties = object({});
  std::vector<std::string> required;
  if (!name_key.empty()) set(properties, name_key, object({{"const", text(component.name)}}));
  for (const ParamInfo& param : component.describe()) {
    if (param.name == name_key) continue;
    set(properties, param.name, param_schema(param));
    if (param.required) required.push_back(param.name);
  }
  Value schema =
      object({{"type", text("object")}, {"description", text(component.doc)}, {"properties", std::move(properties)}});
  if (!required.empty()) set(schema, "required", texts(required));
  if (closed) set(schema, "additionalProperties", boolean(false));
  return schema;
}

class SchemaMaker {
 public:
  explicit SchemaMaker(const Catalogue& catalogue) : catalogue_(catalogue), definitions_(object({})) {}

  Value scene() {
    add_expressions();
    for (const std::string& kind : catalogue_.kinds()) add_kind(kind);
    for (const char* needed : {"material", "light", "camera", "base", "step", "template", "production", "model", "grid",
                               "object", "medium", "render"})
      if (!definitions_.find(needed)) define(needed, type("object"));
    Value schema = object(
        {{"$schema", text("http://json-schema.org/draft-07/schema#")},
         {"title", text("Meristem scene")},
         {"description", text("A scene: models that grow, the materials they wear, and how they are lit and seen. "
                              "JSON with comments and trailing commas.")},
         {"type", text("object")},
         {"properties", sections()},
         {"additionalProperties", boolean(false)}});
    set(schema, "definitions", std::move(definitions_));
    return schema;
  }

 private:
  void define(const std::string& name, Value schema) { set(definitions_, name, std::move(schema)); }

  void add_expressions() {
    define("expression", object({{"description", text("a number, or an expression that gives one")},
                                 {"type", array({text("number"), text("string")})}}));
    define("vector_expression",
           object({{"description",
                    text("an expression that gives a vector or a colour; a number stands for three equal components")},
                   {"anyOf", array({reference("expression"), triple(reference("expression"))})}}));
  }

  void add_kind(const std::string& kind) {
    if (kind == "section")
      add_sections();
    else if (kind == "step" || kind == "model" || kind == "grid")
      add_by_member(kind);
    else if (kind == "production")
      add_production();
    else if (kind == "template")
      add_named_kind(kind, "template", false);
    else
      add_named_kind(kind, "type", true);
  }

  void add_sections() {
    for (const ComponentInfo* section : catalogue_.of_kind("section"))
      define(section->name, component_schema(*section, "", true));
  }

  // Told apart by "if" rather than "oneOf", so that an error names the member that is wrong.
  void add_by_member(const std::string& kind) {
    Value keys = array({}), branches = array({});
    for (const ComponentInfo* component : catalogue_.of_kind(kind)) {
      Value schema = component_schema(*component, "", true);
      if (!is_required(schema, component->name)) require(schema, component->name);
      define(kind + "." + component->name, std::move(schema));
      const Value has_key = object({{"required", texts({component->name})}});
      keys.items.push_back(has_key);
      branches.items.push_back(object({{"if", has_key}, {"then", reference(kind + "." + component->name)}}));
    }
    if (keys.items.empty()) return;
    define(kind, object({{"description", text("a " + kind + ", recognised by the member of its name")},
                         {"type", text("object")},
                         {"anyOf", std::move(keys)},
                         {"allOf", std::move(branches)}}));
  }

  static bool is_required(const Value& schema, const std::string& key) {
    const Value* const required = schema.find("required");
    if (!required) return false;
    for (const Value& item : required->items)
      if (item.text == key) return true;
    return false;
  }

  static void require(Value& schema, const std::string& key) {
    for (Member& member : schema.members)
      if (member.key == "required") return member.value.items.push_back(text(key));
    set(schema, "required", texts({key}));
  }

  // The members of a production and those of its template stand in one object, so neither closes it.
  void add_production() {
    Value all = array({});
    for (const ComponentInfo* part : catalogue_.of_kind("production"))
      all.items.push_back(component_schema(*part, "", false));
    if (!catalogue_.of_kind("template").empty()) all.items.push_back(reference("template"));
    define("production", object({{"description", text("what a face with the rule's symbol is replaced by")},
                                 {"allOf", std::move(all)}}));
  }

  // A kind whose components are told apart by the member `name_key`.
  void add_named_kind(const std::string& kind, const std::string& name_key, bool closed) {
    std::vector<std::string> names;
    Value branches = array({});
    const auto fallback = catalogue_.default_types.find(kind);
    const bool has_fallback = fallback != catalogue_.default_types.end();
    for (const ComponentInfo* component : catalogue_.of_kind(kind)) {
      names.push_back(component->name);
      define(kind + "." + component->name, component_schema(*component, name_key, closed));
      // An object without the member meets the condition "properties" of every type, so all but the fallback ask for it
      Value condition = object({{"properties", named(name_key, object({{"const", text(component->name)}}))}});
      if (!has_fallback || fallback->second != component->name) set(condition, "required", texts({name_key}));
      branches.items.push_back(
          object({{"if", std::move(condition)}, {"then", reference(kind + "." + component->name)}}));
    }
    Value name_schema = object({{"description", text("which " + kind)}, {"enum", texts(names)}});
    if (has_fallback) set(name_schema, "default", text(fallback->second));
    Value schema = object({{"type", text("object")}, {"properties", named(name_key, std::move(name_schema))}});
    if (!has_fallback && closed) set(schema, "required", texts({name_key}));
    set(schema, "allOf", std::move(branches));
    define(kind, std::move(schema));
  }

  static Value named(const std::string& key, Value value) {
    Value v = object({});
    set(v, key, std::move(value));
    return v;
  }

  static Value described(const char* description, Value schema) {
    set(schema, "description", text(description));
    return schema;
  }

  static Value map_of(const std::string& definition) {
    return object({{"type", text("object")}, {"additionalProperties", reference(definition)}});
  }

  static Value list_of(const std::string& definition) {
    return object({{"type", text("array")}, {"items", reference(definition)}});
  }

  Value sections() const {
    const Value names = object({{"type", text("array")}, {"items", type("string")}});
    return object({
        {"format", described("the version of the scene language", object({{"const", number(scene_format)}}))},
        {"include", described("files of this folder whose materials and models are taken over",
                              object({{"anyOf", array({type("string"), names})}}))},
        {"materials", described("materials by name", map_of("material"))},
        {"models",
         described("models by name: a base mesh and the steps that refine and grow it, or other models placed",
                   map_of("model"))},
        {"grids", described("fields of samples by name, for vdb() in expressions", map_of("grid"))},
        {"objects", described("where models stand", list_of("object"))},
        {"lights", described("what lights the scene", list_of("light"))},
        {"media", described("matter between surfaces", list_of("medium"))},
        {"camera", described("where the scene is seen from", reference_to_describe("camera"))},
        {"cameras", described("cameras by name, to choose from", map_of("camera"))},
        {"render", described("size and quality of the image", reference_to_describe("render"))},
    });
  }

  const Catalogue& catalogue_;
  Value definitions_;
};

}  // namespace

std::string json_schema(const Catalogue& catalogue) { return to_json(SchemaMaker(catalogue).scene()) + "\n"; }

}  // namespace meristem
