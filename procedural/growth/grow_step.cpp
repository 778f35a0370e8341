#include "procedural/growth/grow_step.h"

#include "geometry/base/check.h"
#include "geometry/cells/level_of_detail.h"
#include "geometry/cells/thinning.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

constexpr int max_steps = 64;
constexpr const char* rules_schema = R"({"type":"object","additionalProperties":
{"anyOf":[{"type":"object"},{"type":"array","items":{"type":"object"}}]}})";
constexpr const char* thinning_schema = R"({"type":"object","additionalProperties":
{"type":"number","exclusiveMinimum":0,"maximum":64}})";

constexpr Key vertex_tag = hash_text("grown vertex"), face_tag = hash_text("grown face"),
              choice_tag = hash_text("choice");

Vec2d rounded_uv(Vec2d uv) { return {unit_quantum.round(uv.x), unit_quantum.round(uv.y)}; }

Interval hull(Interval a, Interval b) { return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)}; }

// Room for rounding to float and to the grid of u, v.
Interval with_margin(Interval i) {
  const float margin = 1e-6f * (std::max(std::abs(i.lower), std::abs(i.upper)) + 1e-3f);
  return {i.lower - margin, i.upper + margin};
}

void merge(const SymbolRange& range, std::vector<SymbolRange>& list) {
  for (SymbolRange& known : list) {
    if (known.symbol != range.symbol) continue;
    for (std::size_t i = 0; i < known.parameters.size(); ++i)
      known.parameters[i] = hull(known.parameters[i], range.parameters[i]);
    known.radius = std::max(known.radius, range.radius);
    known.enlargement = hull(known.enlargement, range.enlargement);
    known.enlarged_reach = std::max(known.enlarged_reach, range.enlarged_reach);
    return;
  }
  list.push_back(range);
}

}  // namespace

GrowStep::GrowStep(std::shared_ptr<const GrowthRules> rules, std::shared_ptr<const GrowthSymbols> symbols, int index,
                   int level, Key seed, const GrowStep* before)
    : rules_(std::move(rules)),
      symbols_(std::move(symbols)),
      index_(index),
      level_(level),
      key_salt_(hash_keys(hash_text("grow"), std::uint64_t(index))),
      random_salt_(hash_keys(seed, key_salt_)) {
  if (before) most_children_ = before->most_children_;
  for (std::uint32_t corners = 3; !before && corners < most_children_.size(); ++corners)
    most_children_[corners] = count_children(corners);
}

std::string GrowStep::name() const { return fmt::format("grow {}", level_ + 1); }

std::uint32_t GrowStep::max_children(std::uint32_t corners) const {
  return corners < most_children_.size() ? most_children_[corners] : count_children(corners);
}

std::uint32_t GrowStep::count_children(std::uint32_t corners) const {
  std::uint32_t most = 1;
  rules_->for_each([&](const Production& p) {
    if (p.part().shape->refusal(corners).empty()) most = std::max(most, sample_growth(p.part(), corners).face_count());
  });
  return most;
}

Key GrowStep::production_salt(const Production& p, std::span<const Production> list) const {
  return hash_keys(random_salt_, std::uint64_t(&p - list.data()));
}

const Production* GrowStep::choose(std::span<const Production> candidates, std::span<const Vec3f> values,
                                   Key face_key) const {
  std::vector<double> weights(candidates.size(), 0);
  double total = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Production& p = candidates[i];
    const Key salt = production_salt(p, candidates);
    if (p.condition(values, face_key, salt)) total += weights[i] = p.weight(values, face_key, salt);
  }
  double left = uniform_double(hash_keys(face_key, random_salt_, choice_tag)) * total;
  const Production* chosen = nullptr;  // the last one possible, should rounding leave something over
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (weights[i] == 0) continue;
    chosen = &candidates[i];
    left -= weights[i];
    if (left < 0) break;
  }
  return chosen;
}

// One run of apply(): the output while it grows, and scratch memory.
class GrowStep::Application {
 public:
  Application(const GrowStep& step, const CellMesh& in, CellMesh& out) : step_(step), in_(in), out_(out) {
    const Mesh& m = in.mesh;
    Mesh& o = out.mesh;
    o = {};
    o.positions = m.positions;
    o.vertex_keys = m.vertex_keys;
    o.uv = m.uv;
    o.vertex_sharpness = m.vertex_sharpness;
    o.nominal_scale = m.nominal_scale;
    o.frozen = m.frozen;
    o.fading = m.fading;
    o.face_starts.reserve(m.face_starts.size());
    o.corner_vertices.reserve(m.corner_vertices.size());
    o.corner_uv.reserve(m.corner_uv.size());
    o.face_keys.reserve(m.face_keys.size());
    o.face_origins.reserve(m.face_origins.size());
    o.origins.reserve(m.origins.size());
    has_sharpness_ = !m.corner_sharpness.empty();
    step.rules_->for_each([&](const Production& p) { has_sharpness_ = has_sharpness_ || p.crease() > 0; });
    kept_origins_.assign(m.origins.size(), unused);
    if (step.rules_->uses_neighbors()) adjacency_.emplace(m);
  }

  void run() {
    out_.owned_faces = 0;
    out_.rings.clear();
    out_.labels.clear();
    for (std::uint32_t f = 0; f < in_.mesh.face_count(); ++f) {
      const std::uint32_t before = out_.mesh.face_count();
      if (!grow(f)) keep(f);
      if (f < in_.owned_faces) out_.owned_faces = out_.mesh.face_count();
      if (f < in_.labels.size()) out_.labels.resize(out_.owned_faces, in_.labels[f]);
      out_.rings.resize(out_.mesh.face_count(), f < in_.rings.size() ? in_.rings[f] : std::uint8_t(0));
      CHECK(out_.mesh.face_count() > before, "face {} vanished", f);
    }
  }

 private:
  static constexpr std::uint32_t unused = ~0u;

  const FaceOrigin& origin(std::uint32_t f) const { return in_.mesh.origins[in_.mesh.face_origins[f]]; }
  bool by_corners() const { return !in_.mesh.corner_uv.empty(); }

  void keep(std::uint32_t f) {
    const Mesh& m = in_.mesh;
    Mesh& o = out_.mesh;
    std::uint32_t& kept = kept_origins_[m.face_origins[f]];
    if (kept == unused) {
      kept = std::uint32_t(o.origins.size());
      o.origins.push_back(origin(f));
    }
    o.add_face(m.corners(f), m.face_keys[f], kept);
    if (!m.enlargements.empty()) {
      // What no rule has grown on is as it was before the step
      const Enlargement& e = m.enlargements[f];
      o.enlargements.push_back({e.of_face, e.of_face, step_.grows(origin(f).symbol) ? 1 : e.detail});
    }
    if (!m.seam_widths.empty()) o.seam_widths.push_back(m.seam_widths[f]);
    for (std::uint32_t c = m.face_starts[f]; c < m.face_starts[f + 1]; ++c) {
      if (by_corners()) o.corner_uv.push_back(m.corner_uv[c]);
      if (has_sharpness_) o.corner_sharpness.push_back(sharpness(c));
    }
  }

  void keep_without_symbol(std::uint32_t f) {
    keep(f);
    FaceOrigin terminal = origin(f);
    terminal.symbol = -1;
    terminal.parameters = {};
    out_.mesh.face_origins.back() = std::uint32_t(out_.mesh.origins.size());
    out_.mesh.origins.push_back(terminal);
  }

  float sharpness(std::uint32_t corner) const {
    return in_.mesh.corner_sharpness.empty() ? 0 : in_.mesh.corner_sharpness[corner];
  }

  bool grow(std::uint32_t f) {
    const FaceOrigin& parent = origin(f);
    const std::span<const Production> candidates = step_.rules_->of(parent.symbol);
    if (candidates.empty()) return false;
    gather(f);
    const int parameter_count = step_.symbols_->entry(parent.symbol).parameter_count;
    const RuleValues values =
        rule_values(parent, parameter_count, step_.surroundings(neighbors(f)), frame_, center_uv());
    const Key key = in_.mesh.face_keys[f];
    const Production* p = step_.choose(candidates, values, key);
    if (!p) return false;
    if (!p->part().shape->refusal(std::uint32_t(corners_.size())).empty()) {
      keep_without_symbol(f);
      return true;
    }
    const Key salt = step_.production_salt(*p, candidates);
    p->template_values(values, key, salt, template_values_);
    grown_.clear(std::uint32_t(corners_.size()));
    p->part().shape->grow({corners_, uv_, frame_, template_values_}, grown_);
    if (p->crease() > 0) grown_.crease_inner_edges(p->crease());
    enlarge();
    add_vertices(key);
    add_faces(f, *p, parent, values, salt);
    return true;
  }

  // Behind how many edges of the face there is one that may grow, or would if it were seen.
  int neighbors(std::uint32_t f) const {
    if (!adjacency_) return 0;
    int count = 0;
    for (std::uint32_t c = in_.mesh.face_starts[f]; c < in_.mesh.face_starts[f + 1]; ++c) {
      const Adjacency::Edge& edge = adjacency_->edge(adjacency_->edge_of_corner(c));
      const std::uint32_t other = edge.faces[edge.faces[0] == f ? 1 : 0];
      count += other != Adjacency::none && step_.grows(symbol_before_omission(origin(other).symbol));
    }
    return count;
  }

  // The replaced face's own corners, in their order, as large as if nothing had been thinned.
  void gather(std::uint32_t f) {
    const Mesh& m = in_.mesh;
    frame_ = face_frame(m, f);
    enlargement_ = m.enlargements.empty() ? Enlargement{} : m.enlargements[f];
    frame_.radius /= double(enlargement_.of_face);
    corners_.clear();
    uv_.clear();
    for (std::uint32_t c = m.face_starts[f]; c < m.face_starts[f + 1]; ++c) {
      const std::uint32_t v = m.corner_vertices[c];
      corners_.push_back(scaled(m.positions[v], frame_.origin, 1 / double(enlargement_.of_face)));
      uv_.push_back(by_corners() ? m.corner_uv[c] : m.uv.empty() ? Vec2d{} : m.uv[v]);
    }
  }

  static Vec3d scaled(Vec3d p, Vec3d center, double factor) { return factor == 1 ? p : center + (p - center) * factor; }

  // Where a face thins, about the middle of what grows on it, so that outlines are blurred but stay.
  void enlarge() {
    const auto [of_face, of_growth, detail] = enlargement_;
    for (Vec3d& p : grown_.vertices) p = scaled(p, frame_.origin, double(of_face));
    if (of_growth == of_face || grown_.vertices.empty()) return;
    Vec3d middle;
    for (Vec3d p : grown_.vertices) middle += p * (1.0 / double(grown_.vertices.size()));
    for (Vec3d& p : grown_.vertices) p = scaled(p, middle, double(of_growth) / double(of_face));
  }

  Vec2d center_uv() const {
    Vec2d sum;
    for (Vec2d uv : uv_) sum = sum + uv;
    return sum * (1.0 / double(uv_.size()));
  }

  void add_vertices(Key face_key) {
    Mesh& o = out_.mesh;
    first_vertex_ = o.vertex_count();
    for (std::size_t i = 0; i < grown_.vertices.size(); ++i)
      o.add_vertex(step_.quantum_.round(grown_.vertices[i]), hash_keys(face_key, step_.key_salt_, vertex_tag, i));
    if (!o.vertex_sharpness.empty()) o.vertex_sharpness.resize(o.positions.size(), 0);
    if (!o.nominal_scale.empty()) o.nominal_scale.resize(o.positions.size(), 0);
    if (!o.frozen.empty()) o.frozen.resize(o.positions.size());
    if (!o.fading.empty()) o.fading.resize(o.positions.size());
    if (!o.uv.empty()) add_vertex_uv();
  }

  // The mean over the corners of the new faces, in the template's order.
  void add_vertex_uv() {
    std::vector<Vec2d> sum(grown_.vertices.size());
    std::vector<int> count(grown_.vertices.size(), 0);
    for (std::size_t c = 0; c < grown_.corners.size(); ++c) {
      if (grown_.corners[c] < grown_.border_count) continue;
      const std::size_t i = grown_.corners[c] - grown_.border_count;
      sum[i] = sum[i] + grown_.corner_uv[c];
      ++count[i];
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
      out_.mesh.uv.push_back(rounded_uv(sum[i] * (1.0 / std::max(count[i], 1))));
  }

  void add_faces(std::uint32_t f, const Production& p, const FaceOrigin& parent, const RuleValues& values, Key salt) {
    Mesh& o = out_.mesh;
    const std::span<const std::uint32_t> border = in_.mesh.corners(f);
    const Key parent_key = in_.mesh.face_keys[f];
    for (std::uint32_t i = 0; i < grown_.face_count(); ++i) {
      const std::span<const std::uint32_t> face = grown_.face(i);
      face_.clear();
      for (std::uint32_t v : face)
        face_.push_back(v < grown_.border_count ? border[v] : first_vertex_ + v - grown_.border_count);
      const Key key = hash_keys(parent_key, step_.key_salt_, face_tag, i);
      o.origins.push_back(p.origin(grown_.names[i], parent, values, parent_key, salt, key));
      o.add_face(face_, key, std::uint32_t(o.origins.size()) - 1);
      if (!in_.mesh.enlargements.empty())
        o.enlargements.push_back({enlargement_.of_growth, enlargement_.of_growth, enlargement_.detail});
      for (std::size_t c = 0; c < face.size(); ++c)
        add_corner(f, grown_.face_starts[i] + c, face[c], face[(c + 1) % face.size()]);
      if (!in_.mesh.seam_widths.empty()) o.seam_widths.push_back(seam_width(o, o.face_count() - 1));
    }
  }

  // Edges of the border belong to the neighbours as well, so they keep their sharpness.
  void add_corner(std::uint32_t f, std::size_t corner, std::uint32_t from, std::uint32_t to) {
    Mesh& o = out_.mesh;
    if (by_corners()) o.corner_uv.push_back(rounded_uv(grown_.corner_uv[corner]));
    if (!has_sharpness_) return;
    o.corner_sharpness.push_back(grown_.is_border_edge(from, to) ? sharpness(in_.mesh.face_starts[f] + from)
                                                                 : grown_.corner_sharpness[corner]);
  }

  const GrowStep& step_;
  const CellMesh& in_;
  CellMesh& out_;
  bool has_sharpness_ = false;
  std::optional<Adjacency> adjacency_;       // where a rule counts neighbours
  std::vector<std::uint32_t> kept_origins_;  // by index before: index after
  std::uint32_t first_vertex_ = 0;
  FaceFrame frame_;
  Enlargement enlargement_;
  std::vector<Vec3d> corners_;
  std::vector<Vec2d> uv_;
  std::vector<Vec3d> template_values_;
  NamedFaces grown_;
  std::vector<std::uint32_t> face_;
};

void GrowStep::apply(const CellMesh& in, int rings_after, CellMesh& out) const {
  Application(*this, in, out).run();
  trim_halo(out, rings_after);
}

bool GrowStep::grows_later(std::int32_t symbol) const {
  return symbol >= 0 && symbols_->entry(symbol).last_rule > index_;
}

Extent GrowStep::bound(const Extent& e) const {
  Extent after = e;
  after.symbols.clear();
  for (const SymbolRange& range : e.symbols) {
    const std::span<const Production> productions = rules_->of(range.symbol);
    bool surely_replaced = false;
    if (!productions.empty()) {
      const RuleIntervals values =
          rule_intervals(range, symbols_->entry(range.symbol).parameter_count, surroundings(), e);
      for (const Production& p : productions) {
        const Production::Applies applies = p.applies(values);
        if (applies != Production::Applies::Never) add_growth(p, range, e, values, after);
        surely_replaced = surely_replaced || applies == Production::Applies::Always;
      }
    }
    if (!surely_replaced && grows_later(range.symbol)) merge(range, after.symbols);
  }
  return after;
}

namespace {

// How large what grows on a face may be, enlargements included (thinning.h): its own and those of faces before it.
struct GrownSize {
  Interval enlargement;
  double enlarged_reach;  // as SymbolRange has it
  double radius;          // of the face
  double distance;        // of what grows, from the face
  double edge;
  double across = 0;  // of faces between the border and what is enlarged, as far apart as they may be, in units of
                      // their enlargement

  // `wanted`: what is enlarged as it thins is, with all that grows on it, no larger than so; 0: nothing thins.
  GrownSize(const Reach& reach, const SymbolRange& parent, double wanted)
      : enlargement(wanted > 0 ? Interval{float(smallest_enlargement), float(largest_enlargement)}
                               : parent.enlargement),
        enlarged_reach(std::max(parent.enlarged_reach, wanted)) {
    const double largest = double(enlargement.upper), of_parent = double(parent.enlargement.upper);
    const auto on_parent = [&](double length, double most) {
      return std::min(length * of_parent, std::max(length, most));
    };
    radius = on_parent(double(parent.radius), 2 * parent.enlarged_reach);
    distance = on_parent(reach.distance, parent.enlarged_reach);
    edge = std::min(largest * reach.edge, std::max(reach.edge, 2 * enlarged_reach));
    if (!(wanted > 0)) return;
    // About a middle that may be as far away: (distance of the middle) + enlargement * (twice the distance)
    distance += 2 * std::min(largest * reach.distance, wanted);
    edge = std::max(edge, distance + radius);
    across = reach.distance * (of_parent / smallest_enlargement + 2) + radius / smallest_enlargement;
  }
};

}  // namespace

void GrowStep::add_growth(const Production& p, const SymbolRange& parent, const Extent& before,
                          std::span<const IntervalValue> values, Extent& after) const {
  const std::vector<Bounds3d> template_values = p.template_bounds(values);
  const Reach reach = p.part().shape->bound({parent.radius, before.u, before.v, template_values});
  const double pixels = thinning(parent.symbol);
  const GrownSize grown(reach, parent, pixels > 0 ? pixels * before.footprint : 0);
  // Each coordinate is rounded by up to half a step, and computed with a relative error far below 1e-12 of the region's
  // size
  const double size = max_component(max(abs(before.box.lower), abs(before.box.upper))) + grown.distance;
  const double slack = 2 * quantum_.step() + 1e-12 * size;
  after.box.extend(before.box.inflated(Vec3d(grown.distance + slack)));
  after.edge = std::max(after.edge, grown.edge + 2 * slack);
  after.forget_shape();
  after.u = hull(after.u, with_margin(reach.u));
  after.v = hull(after.v, with_margin(reach.v));
  for (std::size_t name = 0; name < reach.face_radius.size(); ++name) {
    const Successor& s = p.successor(int(name));
    if (!grows_later(s.symbol())) continue;
    const double face_radius =
        std::max(reach.face_radius[name], grown.across) + 2 * slack / double(grown.enlargement.lower);
    merge({s.symbol(), s.bounds(values), std::nextafterf(float(face_radius), INFINITY), grown.enlargement,
           grown.enlarged_reach},
          after.symbols);
  }
}

namespace {

FaceCensus children_of(const Production& p, std::uint32_t corners) {
  if (!p.part().shape->refusal(corners).empty()) return {{{-1, corners}, 1}};
  const NamedFaces grown = sample_growth(p.part(), corners);
  FaceCensus census;
  for (std::uint32_t f = 0; f < grown.face_count(); ++f)
    ++census[{p.successor(grown.names[f]).symbol(), std::uint32_t(grown.face(f).size())}];
  return census;
}

// What may become of one face with productions: sums by weight, and the largest number of each kind.
struct Prospects {
  FaceCensus weighted, largest;
  double total_weight = 0;
  bool certain = true;    // every possible production is always a candidate, and its weight is known
  bool replaced = false;  // the face does not stay
};

void add_scaled(const FaceCensus& from, double factor, FaceCensus& to) {
  for (const auto& [kind, count] : from) to[kind] += factor * count;
}

void take_larger(const FaceCensus& from, FaceCensus& to) {
  for (const auto& [kind, count] : from) to[kind] = std::max(to[kind], count);
}

Prospects prospects_of(std::span<const Production> productions, std::uint32_t corners,
                       std::span<const IntervalValue> values) {
  Prospects result;
  for (const Production& p : productions) {
    const Production::Applies applies = p.applies(values);
    if (applies == Production::Applies::Never) continue;
    const Interval weight = p.weight_bounds(values);
    const FaceCensus children = children_of(p, corners);
    add_scaled(children, weight.upper, result.weighted);
    take_larger(children, result.largest);
    result.total_weight += weight.upper;
    result.replaced = result.replaced || applies == Production::Applies::Always;
    result.certain = result.certain && applies == Production::Applies::Always && weight.lower == weight.upper;
  }
  return result;
}

}  // namespace

FaceCensus GrowStep::forecast(const FaceCensus& faces, const Extent& extent) const {
  FaceCensus result;
  for (const auto& [kind, count] : faces) {
    const std::int32_t symbol = kind.first;
    const auto range = std::find_if(extent.symbols.begin(), extent.symbols.end(),
                                    [&](const SymbolRange& r) { return r.symbol == symbol; });
    if (!grows(symbol) || range == extent.symbols.end()) {
      result[kind] += count;
      continue;
    }
    const RuleIntervals values =
        rule_intervals(*range, symbols_->entry(symbol).parameter_count, surroundings(), extent);
    Prospects one = prospects_of(rules_->of(symbol), kind.second, values);
    if (!one.replaced) take_larger({{kind, 1}}, one.largest);
    if (one.replaced && one.certain)
      add_scaled(one.weighted, count / one.total_weight, result);
    else
      add_scaled(one.largest, count, result);
  }
  return result;
}

namespace {

struct GrowParams {
  int count;
  const Value *rules, *thinning;
  Vec3d light;
  explicit GrowParams(Params& params) {
    count = params.integer("grow", 1, {0, max_steps, ""}, "how many times the rules are applied");
    rules = params.raw("rules", true, rules_schema, "for each symbol its rule, or several to choose from");
    thinning = params.raw("thinning", false, thinning_schema,
                          "symbols of which fewer grow, and those larger, where all that grows on a face is smaller "
                          "than so many pixels, such as { \"leaf\": 4 }");
    light = params.vector("light", {0, 1, 0}, any_range,
                          "direction towards the light, in model space; the rules see it as \"light\", of unit length");
  }
};

}  // namespace

std::vector<std::unique_ptr<GrowStep>> make_grow_steps(const Value& step_object, GrowContext& context,
                                                       Diagnostics& diagnostics) {
  Params params(step_object, "step \"grow\"", diagnostics);
  const GrowParams grow(params);
  if (!(length(grow.light) > 0)) params.error("light", "a direction of light has a length");
  params.finish();
  std::vector<std::unique_ptr<GrowStep>> steps;
  if (!grow.rules) return steps;
  const int last_step = context.next_step + grow.count - 1;
  const auto rules =
      std::make_shared<GrowthRules>(*grow.rules, Vec3f(normalize(grow.light)), last_step, context, diagnostics);
  if (grow.thinning) rules->read_thinning(*grow.thinning, *context.symbols, diagnostics);
  for (int level = 0; level < grow.count; ++level)
    steps.push_back(std::make_unique<GrowStep>(rules, context.symbols, context.next_step++, level, context.seed,
                                               steps.empty() ? nullptr : steps.back().get()));
  return steps;
}

ComponentInfo grow_step_info() {
  return {"step", "grow", "Rule based mesh growing: faces with symbols are replaced by templates", [] {
            std::vector<ParamInfo> infos;
            Params params(infos);
            GrowParams{params};
            return infos;
          }};
}

}  // namespace meristem
