#include "procedural/growth/production.h"

#include <fmt/format.h>

#include <algorithm>

namespace meristem {

namespace {

constexpr const char* faces_schema = R"({"type":"object","additionalProperties":{"type":"string"}})";

// Every expression of a production draws its own random numbers.
constexpr Key condition_salt = hash_text("if"), weight_salt = hash_text("weight"),
              template_salt = hash_text("template"), successor_salt = hash_text("faces");

std::vector<std::string> written_names(const std::vector<FaceName>& names) {
  std::vector<std::string> result;
  for (const FaceName& n : names) result.push_back(n.name);
  return result;
}

std::string suggestion(std::string_view word, const std::vector<std::string>& known) {
  const std::string_view near = nearest_name(word, known);
  return near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near);
}

// What a rule may say whatever its template, in the order of the manual.
struct CommonParams {
  std::shared_ptr<const Expression> weight, condition;
  std::string template_name, material;
  const Value* faces;
  float crease;

  CommonParams(Params& params, const Symbols& variables) {
    weight = params.scalar_expression(
        "weight", "1", variables,
        "chance of this rule among those of the symbol whose condition holds; at most 0: never");
    condition = params.scalar_expression("if", "1", variables, "the rule applies where this is not 0");
    template_name = params.required_text("template", "name of the mesh that takes the face's place");
    faces = params.raw("faces", false, faces_schema,
                       "symbols of the template's faces by their names, such as { \"cap\": \"shoot(len*0.9)\" }");
    material = params.text("material", "", "material of the new faces; none: that of the replaced face");
    crease = float(params.real("crease", 0, {0, 10, ""}, "sharpness of the new edges"));
  }
};

}  // namespace

Production::Production(const Value& rule, const std::string& head, std::uint16_t number, const Symbols& variables,
                       GrowContext& context, Diagnostics& diagnostics)
    : location_(rule.location), number_(number) {
  if (rule.kind != Value::Kind::Object) {
    diagnostics.error(rule.location, fmt::format("expected a rule as an object, found {}", rule.kind_name()));
    return;
  }
  Params params(rule, fmt::format("rule of \"{}\"", head), diagnostics);
  const CommonParams common(params, variables);
  weight_ = common.weight;
  condition_ = common.condition;
  crease_ = common.crease;
  if (!common.material.empty() && context.material_index)
    material_ = context.material_index(common.material, params.location_of("material"));

  const std::vector<std::string> known = context.templates.names();
  if (std::find(known.begin(), known.end(), common.template_name) == known.end()) {
    if (params.has("template"))
      params.error("template", fmt::format("no template named \"{}\"{}; known: {}", common.template_name,
                                           suggestion(common.template_name, known), fmt::join(known, ", ")));
    return;  // which other keys are right depends on the template
  }
  part_ = context.templates.create(common.template_name, params, variables, {context.folder});
  params.finish();
  successors_.resize(part_.shape->face_names().size());
  read_faces(common.faces, variables, context, diagnostics);
  valid_ = weight_ && condition_ &&
           std::all_of(part_.parameters.begin(), part_.parameters.end(),
                       [](const TemplateParameter& p) { return p.expression != nullptr; });
  uses_neighbors_ = valid_ && uses(variables.find(neighbors_variable));
}

bool Production::uses(int slot) const {
  return weight_->uses(slot) || condition_->uses(slot) ||
         std::any_of(part_.parameters.begin(), part_.parameters.end(),
                     [&](const TemplateParameter& p) { return p.expression->uses(slot); }) ||
         std::any_of(successors_.begin(), successors_.end(), [&](const Successor& s) { return s.uses(slot); });
}

void Production::read_faces(const Value* faces, const Symbols& variables, GrowContext& context,
                            Diagnostics& diagnostics) {
  if (!faces) return;
  if (faces->kind != Value::Kind::Object)
    return diagnostics.error(
        faces->location,
        fmt::format("expected an object: names of faces and their symbols; found {}", faces->kind_name()));
  const std::vector<FaceName>& names = part_.shape->face_names();
  const std::vector<std::string> known = written_names(names);
  std::vector<bool> written(names.size());
  for (const Member& m : faces->members) {
    const auto found = std::find(known.begin(), known.end(), m.key);
    if (found == known.end()) {
      diagnostics.error(m.key_location, fmt::format("the template has no face named \"{}\"{}; known: {}", m.key,
                                                    suggestion(m.key, known), fmt::join(known, ", ")));
    } else if (m.value.kind != Value::Kind::Text) {
      diagnostics.error(m.value.location,
                        fmt::format("expected a symbol as text, such as \"shoot(1)\", found {}", m.value.kind_name()));
    } else {
      const auto index = std::size_t(found - known.begin());
      successors_[index] = Successor(m.value.text, m.value.location, variables, *context.symbols, diagnostics);
      written[index] = true;
    }
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!written[i] && names[i].group >= 0) successors_[i] = successors_[std::size_t(names[i].group)];
}

ComponentInfo Production::info() {
  return {"production", "production", "A rule of a grow step; further keys are those of its template", [] {
            std::vector<ParamInfo> infos;
            Params params(infos);
            const Symbols variables;
            CommonParams{params, variables};
            return infos;
          }};
}

bool Production::condition(std::span<const Vec3f> values, Key key, Key salt) const {
  const float c = condition_->evaluate_scalar(values, key, hash_keys(salt, condition_salt));
  return c != 0 && !std::isnan(c);
}

double Production::weight(std::span<const Vec3f> values, Key key, Key salt) const {
  const double w = weight_->evaluate_scalar(values, key, hash_keys(salt, weight_salt));
  return w > 0 ? std::min(w, 1e30) : 0;
}

void Production::template_values(std::span<const Vec3f> values, Key key, Key salt, std::vector<Vec3d>& out) const {
  out.clear();
  for (std::size_t i = 0; i < part_.parameters.size(); ++i)
    out.push_back(part_.parameters[i].evaluate(values, key, hash_keys(salt, template_salt, i)));
}

FaceOrigin Production::origin(int name, const FaceOrigin& parent, std::span<const Vec3f> values, Key parent_key,
                              Key salt, Key new_key) const {
  FaceOrigin origin;
  origin.key = new_key;
  origin.material = material_ >= 0 ? material_ : parent.material;
  origin.production = number_;
  // Keyed by the parent and the face's own key: faces of one name draw apart
  successor(name).evaluate(values, hash_keys(parent_key, new_key), hash_keys(salt, successor_salt), origin);
  return origin;
}

Production::Applies Production::applies(std::span<const IntervalValue> values) const {
  const Interval c = condition_->evaluate_bounds(values).x, w = weight_bounds(values);
  if ((c.lower == 0 && c.upper == 0) || w.upper <= 0) return Applies::Never;
  return (c.lower > 0 || c.upper < 0) && w.lower > 0 ? Applies::Always : Applies::Maybe;
}

Interval Production::weight_bounds(std::span<const IntervalValue> values) const {
  return weight_->evaluate_bounds(values).x;
}

std::vector<Bounds3d> Production::template_bounds(std::span<const IntervalValue> values) const {
  std::vector<Bounds3d> result;
  for (const TemplateParameter& p : part_.parameters) result.push_back(p.bounds(values));
  return result;
}

GrowthRules::GrowthRules(const Value& rules, Vec3f light, int last_step, GrowContext& context, Diagnostics& diagnostics)
    : light_(light) {
  if (rules.kind != Value::Kind::Object)
    diagnostics.error(rules.location,
                      fmt::format("expected an object: symbols and their rules; found {}", rules.kind_name()));
  for (const Member& rule : rules.members) read_rule(rule, last_step, context, diagnostics);
}

bool GrowthRules::uses_neighbors() const {
  bool uses = false;
  for_each([&](const Production& p) { uses = uses || p.uses_neighbors(); });
  return uses;
}

void GrowthRules::read_thinning(const Value& thinning, const GrowthSymbols& symbols, Diagnostics& diagnostics) {
  constexpr double largest = 64;
  if (thinning.kind != Value::Kind::Object)
    return diagnostics.error(
        thinning.location,
        fmt::format("expected an object: symbols and sizes in pixels, such as {{ \"leaf\": 4 }}; found {}",
                    thinning.kind_name()));
  std::vector<std::string> known;
  for (int s = 0; s < symbols.size(); ++s)
    if (!of(s).empty()) known.push_back(symbols.entry(s).name);
  thinning_.assign(std::size_t(symbols.size()), 0);
  for (const Member& m : thinning.members) {
    const int symbol = symbols.find(m.key);
    if (symbol < 0 || of(symbol).empty())
      diagnostics.error(m.key_location, fmt::format("this step has no rule for a symbol \"{}\"{}; known: {}", m.key,
                                                    suggestion(m.key, known), fmt::join(known, ", ")));
    else if (m.value.kind != Value::Kind::Number || !(m.value.number > 0 && m.value.number <= largest))
      diagnostics.error(m.value.location,
                        fmt::format("\"{}\" thins below a size in pixels above 0 and at most {}", m.key, largest));
    else
      thinning_[std::size_t(symbol)] = m.value.number;
  }
}

std::span<const Production> GrowthRules::of(std::int32_t symbol) const {
  if (symbol < 0 || std::size_t(symbol) >= by_symbol_.size()) return {};
  return by_symbol_[std::size_t(symbol)];
}

void GrowthRules::read_rule(const Member& rule, int last_step, GrowContext& context, Diagnostics& diagnostics) {
  const Location start = rule.key_location.advanced(1);
  const auto head = parse_symbol_text(rule.key, start, diagnostics);
  if (!head) return;
  std::vector<std::string> parameters;
  for (const SymbolText::Argument& a : head->arguments) {
    const auto name = parse_symbol_text(a.text, start.advanced(a.offset), diagnostics);
    if (!name) return;
    const auto fail = [&](const char* message) {
      diagnostics.error(start.advanced(a.offset), fmt::format("{}: \"{}\"", message, name->name));
    };
    if (!name->arguments.empty()) return fail("a rule's head holds names of parameters only");
    if (is_frame_variable(name->name)) return fail("every rule has a variable of that name already");
    if (std::find(parameters.begin(), parameters.end(), name->name) != parameters.end())
      return fail("a parameter's name stands twice");
    parameters.push_back(name->name);
  }
  const int symbol = context.symbols->use(head->name, int(parameters.size()), start, diagnostics);
  if (symbol < 0) return;
  context.symbols->add_rule(symbol, last_step);
  if (by_symbol_.size() <= std::size_t(symbol)) by_symbol_.resize(std::size_t(symbol) + 1);
  if (!by_symbol_[std::size_t(symbol)].empty())
    return diagnostics.error(start, fmt::format("symbol \"{}\" has rules in this step already", head->name));

  const Symbols variables = rule_variables(parameters);
  std::vector<Production>& list = by_symbol_[std::size_t(symbol)];
  const auto add = [&](const Value& v) {
    const std::string name = fmt::format("{}[{}]", head->name, context.symbols->number_production(symbol));
    Production p(v, rule.key, context.production_number(name), variables, context, diagnostics);
    for (const Successor& successor : p.successors())
      if (successor.symbol() >= 0) context.symbols->add_successor(symbol, successor.symbol());
    if (p.valid()) list.push_back(std::move(p));
  };
  if (rule.value.kind != Value::Kind::Array) return add(rule.value);
  for (const Value& v : rule.value.items) add(v);
  if (rule.value.items.empty()) diagnostics.error(rule.value.location, "a symbol needs at least one rule");
}

}  // namespace meristem
