#include "procedural/scatter/scatter.h"

#include "geometry/base/parallel.h"
#include "geometry/cells/expansion.h"
#include "geometry/cells/look_ahead.h"
#include "geometry/cells/placed_footprint.h"
#include "geometry/cells/region_extent.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace meristem {

namespace {

constexpr int most_variants_measured = 64;

enum Slot { slot_p, slot_n, slot_u, slot_v, slot_count };
enum What : Key { what_count = 1, what_place, what_turn, what_kind, what_variant, what_part };

// Points on the ground as columns, the inputs of an expression.
class GroundPoints {
 public:
  explicit GroundPoints(std::size_t most) : most_(most), columns_(columns * most) { keys_.reserve(most); }

  void add(Vec3d p, Vec3d n, Vec2d uv, Key key) {
    const std::array<double, columns> row{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
    for (std::size_t i = 0; i < columns; ++i) columns_[i * most_ + keys_.size()] = float(row[i]);
    keys_.push_back(key);
  }
  std::vector<float> evaluate(const Expression& expression, Key salt) const {
    const std::array<Input, slot_count> inputs{
        Input{column(0), column(1), column(2), 1}, Input{column(3), column(4), column(5), 1},
        Input{column(6), nullptr, nullptr, 1}, Input{column(7), nullptr, nullptr, 1}};
    std::vector<float> result(keys_.size());
    if (!keys_.empty())
      expression.evaluate({int(keys_.size()), inputs, keys_.data(), salt}, result.data(), nullptr, nullptr);
    return result;
  }
  std::size_t size() const { return keys_.size(); }
  Key key(std::size_t i) const { return keys_[i]; }
  Vec3d position(std::size_t i) const { return {column(0)[i], column(1)[i], column(2)[i]}; }
  Vec3d normal(std::size_t i) const { return {column(3)[i], column(4)[i], column(5)[i]}; }

 private:
  static constexpr std::size_t columns = 8;
  const float* column(std::size_t i) const { return columns_.data() + i * most_; }

  std::size_t most_;
  std::vector<float> columns_;  // one after the other
  std::vector<Key> keys_;
};

// One face of the ground as a fan of triangles around its first corner.
class GroundFace {
 public:
  GroundFace(const Mesh& mesh, const std::vector<Vec2d>& uv, std::uint32_t f)
      : mesh_(mesh), uv_(uv), corners_(mesh.corners(f)), normal_(newell_normal(mesh, f)) {
    area_ = 0.5 * length(normal_);
    normal_ = normalize(normal_);
  }
  double area() const { return area_; }
  Vec3d normal() const { return normal_; }
  void add_centroid(Key key, GroundPoints& points) const {
    Vec3d p;
    Vec2d t;
    for (std::uint32_t v : corners_) {
      p += mesh_.positions[v] * (1.0 / double(corners_.size()));
      t = t + uv_[v] * (1.0 / double(corners_.size()));
    }
    points.add(p, normal_, t, key);
  }
  // Uniform over the face, as far as its triangles have equal areas.
  void add_random(Key key, GroundPoints& points) const {
    const double r = uniform_double(hash_keys(key, what_place, 0)) * double(corners_.size() - 2);
    const std::size_t k = std::min(std::size_t(r), corners_.size() - 3);
    double a = r - double(k), b = uniform_double(hash_keys(key, what_place, 1));
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const auto blend = [&](const auto& values) {
      return values[corners_[0]] * (1 - a - b) + values[corners_[k + 1]] * a + values[corners_[k + 2]] * b;
    };
    points.add(blend(mesh_.positions), normal_, blend(uv_), key);
  }

 private:
  const Mesh& mesh_;
  const std::vector<Vec2d>& uv_;
  const std::span<const std::uint32_t> corners_;
  Vec3d normal_;
  double area_;
};

Affine3d standing(Vec3d axis) {
  const Vec3d up{0, 1, 0};
  const Vec3d turn = cross(up, axis);
  const double sine = length(turn);
  if (sine < 1e-9) return {};
  return Affine3d::rotation(turn / sine, std::atan2(sine, dot(up, axis)));
}

void extend_by_vertices(const CellMesh& cell, Bounds3f& bounds) {
  for (std::uint32_t f = 0; f < cell.owned_faces; ++f)
    for (std::uint32_t v : cell.mesh.corners(f)) bounds.extend(Vec3f(cell.mesh.positions[v]));
}

// Of one individual, by looking ahead: far closer than what holds for all that a model could grow to. Seen small it
// stays on one of the first levels, whose vertices stand out from the surface they are smoothed to; those of the levels
// after them may do so a little. How the model is cut into cells has no part in it: footprints are decided by these.
Bounds3f individual_bounds(const Part& part, Key individual) {
  if (!part.model || part.placer) return part.typical;
  const Model& model = *part.model;
  constexpr double few_faces = 4096, most_faces = 1024;
  if (model.estimated_faces() <= few_faces) return part.typical;
  CellMesh cell = root_cell(model, nullptr, individual);
  const std::vector<std::uint32_t> whole(cell.owned_faces, 0);
  const auto outlook = look_ahead(model, cell, 0, whole, 1);
  if (!outlook) return part.typical;
  Bounds3f bounds = round_outwards(outlook->front().bounds);
  for (int level = 0; level < model.levels() && cell.owned_faces <= most_faces; ++level) {
    extend_by_vertices(cell, bounds);
    CellMesh next;
    model.step(level).apply(cell, model.halo_rings(level + 1), next);
    cell = std::move(next);
  }
  extend_by_vertices(cell, bounds);
  constexpr float margin = 0.05f;
  bounds = bounds.inflated(Vec3f(margin * bounds.diagonal()));
  return {max(bounds.lower, part.typical.lower), min(bounds.upper, part.typical.upper)};
}

// The variables of all points on ground in a box.
std::array<IntervalValue, slot_count> points_in(const Bounds3f& box) {
  std::array<IntervalValue, slot_count> points{};
  constexpr float inf = std::numeric_limits<float>::infinity();
  const auto [lower, upper] = box;
  points[slot_p] = {{lower.x, upper.x}, {lower.y, upper.y}, {lower.z, upper.z}, inf};
  points[slot_n] = IntervalValue::unit_vector();
  points[slot_u] = points[slot_v] = IntervalValue::scalar(-inf, inf);
  return points;
}

// Far from the origin sums with a place are rounded.
Bounds3f with_margin(const Bounds3f& reach) {
  constexpr float margin = 1e-3f;
  return reach.empty() ? reach : reach.inflated(Vec3f(margin * reach.diagonal()));
}

bool is_bounded_otherwise(const Scatter::Choice& c) { return c.part->derives || c.moments; }

double farthest(double lower, double upper) { return std::max(std::abs(lower), std::abs(upper)); }

}  // namespace

const Symbols& ground_symbols() {
  static const Symbols symbols = [] {
    Symbols s;
    s.add("P", ValueType::Vector, "position on the ground, in metres");
    s.add("N", ValueType::Vector, "unit normal of the ground's face");
    s.add("u", ValueType::Scalar, "texture coordinate of the ground");
    s.add("v", ValueType::Scalar, "texture coordinate of the ground");
    return s;
  }();
  return symbols;
}

ScatterSettings read_scatter_settings(Params& params) {
  ScatterSettings s;
  s.density = params.scalar_expression("density", "0.1", ground_symbols(), "how many for each square metre of ground");
  s.scale = params.scalar_expression("scale", "1", ground_symbols(), "size of each; rand() differs between them");
  s.align = params.real("align", 0, unit_range, "0: upright; 1: at right angles to the ground");
  s.turn = params.real("turn", 360, {0, 360, "deg"}, "each is turned about its axis by a random part of this");
  s.sink = params.real("sink", 0, {-1e6, 1e6, "m"}, "how far each stands below the ground, times its scale");
  s.variants = params.integer("variants", 0, {0, 1 << 20, ""},
                              "individuals of each kind; 0: no two are alike (then nothing of them is shared)");
  s.distinct = params.real("distinct", 0, {0, 1e6, "pixels"},
                           "no two that are seen larger than this are alike; smaller ones are variants; 0: all are");
  return s;
}

Scatter::Scatter(ScatterSettings settings, std::vector<Choice> choices, Key seed)
    : settings_(std::move(settings)), choices_(std::move(choices)), seed_(seed) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const Interval scale = settings_.scale->evaluate_bounds(points_in({Vec3f(-inf), Vec3f(inf)})).x;
  largest_scale_ = farthest(double(scale.lower), double(scale.upper));
  smallest_scale_ = std::max({0.0, double(scale.lower), -double(scale.upper)});
  is_upright_ = settings_.align == 0 && scale.lower >= 0;
  constexpr double most_scale = 1e6;
  if (!(largest_scale_ <= most_scale))
    throw std::runtime_error("the scale has no upper bound: wrap it in clamp(..., lo, hi)");
  measure_variants();
  enlarges_ = std::ranges::none_of(choices_, is_bounded_otherwise) &&
              std::ranges::any_of(choices_, [](const Choice& c) { return c.part->enlarges; });
  for (const Choice& c : choices_) {
    total_weight_ += c.weight;
    has_moments_ = has_moments_ || c.moments;
    typical_reach_.extend(reach_of(c.part->typical, largest_scale_));
    typical_size_ = std::max(typical_size_, double(max_component(c.part->typical.size())));
    reach_.all.extend(reach_of(bounds_of_moments(*c.part, c.moments.get()), largest_scale_));
  }
  for (const Bounds3f& b : known_bounds_) {
    known_reach_.all.extend(reach_of(b, largest_scale_));
    known_reach_.kinds.push_back(reach_of(b, 1));
  }
  reach_.all = with_margin(reach_.all);
  known_reach_.all = with_margin(known_reach_.all);
}

// Where a part with those bounds may lie around the place where it stands: turned about the vertical, or any way.
Bounds3f Scatter::reach_of(const Bounds3f& b, double scale) const {
  const double sink = std::abs(settings_.sink);
  const double aside =
      std::hypot(farthest(double(b.lower.x), double(b.upper.x)), farthest(double(b.lower.z), double(b.upper.z)));
  const double any = std::hypot(aside, farthest(double(b.lower.y), double(b.upper.y))) + sink;
  Bounds3d reach{Vec3d{-aside, double(b.lower.y) - sink, -aside}, Vec3d{aside, double(b.upper.y) + sink, aside}};
  if (!is_upright_) reach = {Vec3d(-any), Vec3d(any)};
  reach.extend(Vec3d{});
  return round_outwards(Bounds3d{reach.lower * scale, reach.upper * scale});
}

const std::vector<Bounds3f>& Scatter::variant_bounds(const SeenAs& seen_as) const {
  if (const auto known = variant_bounds_.find(seen_as); known != variant_bounds_.end()) return known->second;
  const ConstantFootprint footprint(size_of_step(seen_as.step), seen_as.fades);
  std::vector<Bounds3f> bounds(choices_.size() * std::size_t(settings_.variants));
  parallel_for_under_lock(bounds.size(), [&](std::size_t kind) {
    const Part& part = *choices_[kind / std::size_t(settings_.variants)].part;
    Placement p;
    p.individual = variant(int(kind % std::size_t(settings_.variants)));
    bounds[kind] = bounds_of_individual(part, &footprint, placed_individual(seen_as.individual, p), part.typical);
  });
  return variant_bounds_[seen_as] = std::move(bounds);
}

std::shared_ptr<const PlacedReach> Scatter::reach_on(const Bounds3f& ground, const Footprint* footprint,
                                                     Key individual) const {
  const bool is_known = individual == 0 && !known_bounds_.empty();
  const std::shared_ptr<const PlacedReach> general(std::shared_ptr<const PlacedReach>(),
                                                   is_known ? &known_reach_ : &reach_);
  if (enlarges_) return enlarged_reach(ground, footprint, is_known);
  if (!footprint || settings_.variants == 0 || has_moments_ || !known_bounds_.empty()) return general;
  const Bounds3f region = bounds_with_reach(ground, typical_reach_);
  const Footprint::Range range = footprint->range({Vec3d(region.lower), Vec3d(region.upper)});
  if (!is_about_constant(range) || !(smallest_scale_ > 0)) return general;
  constexpr double rounding = 1e-9;
  constexpr int most_steps = 8;
  const SeenAs first{footprint_step(range.least / largest_scale_ * (1 - rounding)), footprint->fades(), individual};
  const int last = footprint_step(range.most / smallest_scale_ * (1 + rounding));
  const bool all_are_small =
      settings_.distinct == 0 || typical_size_ < settings_.distinct * size_of_step(first.step) * (1 - rounding);
  if (!all_are_small || last - first.step >= most_steps) return general;
  const std::lock_guard lock(mutex_);
  forget_if_many();
  std::shared_ptr<const PlacedReach>& known = reaches_[{first, last}];
  if (known) return known;
  PlacedReach reach;
  reach.kinds.resize(choices_.size() * std::size_t(settings_.variants));
  for (SeenAs s = first; s.step <= last; ++s.step) {
    const std::vector<Bounds3f>& bounds = variant_bounds(s);
    for (std::size_t k = 0; k < bounds.size(); ++k) {
      reach.kinds[k].extend(reach_of(bounds[k], 1));
      reach.all.extend(reach_of(bounds[k], largest_scale_));
    }
  }
  reach.all = with_margin(reach.all);
  return known = std::make_shared<const PlacedReach>(std::move(reach));
}

// As bounds of what stands there (region_bounds()): from the footprints where anything may reach, again and again.
std::shared_ptr<const PlacedReach> Scatter::enlarged_reach(const Bounds3f& ground, const Footprint* footprint,
                                                           bool is_known) const {
  constexpr double rounding = 1e-9;
  constexpr double steps_per_octave = 8;  // so that neighbours ask for the same
  constexpr int in_full = std::numeric_limits<int>::min();
  if (!footprint) return reach_up_to(in_full, nullptr, is_known);
  std::shared_ptr<const PlacedReach> reach(std::shared_ptr<const PlacedReach>(), &reach_);
  for (int i = 0; i < footprint_passes; ++i) {
    const Bounds3f region = bounds_with_reach(ground, reach->all);
    const double most = footprint->range({Vec3d(region.lower), Vec3d(region.upper)}).most / smallest_scale_;
    if (!(most > 0 && most < std::numeric_limits<double>::max())) break;
    const int step = int(std::ceil(std::log2(most * (1 + rounding)) * steps_per_octave));
    const ConstantFootprint largest(std::exp2(step / steps_per_octave), footprint->fades());
    reach = reach_up_to(step, &largest, is_known);
  }
  return reach;
}

std::shared_ptr<const PlacedReach> Scatter::reach_up_to(int step, const Footprint* footprint, bool is_known) const {
  const std::lock_guard lock(mutex_);
  forget_if_many();
  const SeenAs seen_as{step, footprint && footprint->fades(), Key(is_known ? 0 : 1)};
  std::shared_ptr<const PlacedReach>& known = reaches_[{seen_as, step}];
  if (known) return known;
  PlacedReach reach;
  const int individuals = is_known ? settings_.variants : 1;
  for (const Choice& c : choices_)
    for (int i = 0; i < individuals; ++i) {
      const Bounds3f& in_full = is_known ? known_bounds_[kind(c, i)] : c.part->typical;
      const Bounds3f bounds = bounds_of_individual(*c.part, footprint, 0, in_full);
      if (is_known) reach.kinds.push_back(reach_of(bounds, 1));
      reach.all.extend(reach_of(bounds, largest_scale_));
    }
  reach.all = with_margin(reach.all);
  return known = std::make_shared<const PlacedReach>(std::move(reach));
}

// Individuals may be as many as the ground has placements.
void Scatter::forget_if_many() const {
  constexpr std::size_t most_known = 1 << 16;  // boxes, of 24 bytes
  const std::size_t kinds = choices_.size() * std::size_t(settings_.variants);
  if ((variant_bounds_.size() + reaches_.size()) * kinds <= most_known) return;
  variant_bounds_.clear();
  reaches_.clear();
}

bool Scatter::leaves_bare(const Bounds3f& ground) const {
  return settings_.density->evaluate_bounds(points_in(ground)).x.upper <= 0;
}

void Scatter::measure_variants() {
  if (settings_.variants > most_variants_measured || settings_.distinct > 0 ||
      std::ranges::any_of(choices_, is_bounded_otherwise))
    return;
  for (const Choice& c : choices_)
    for (int i = 0; i < settings_.variants; ++i) known_bounds_.push_back(individual_bounds(*c.part, variant(i)));
}

Key Scatter::variant(int index) const { return hash_keys(seed_, what_variant, Key(index)); }

int Scatter::variant_of(Key key) const {
  return int(uniform_double(hash_keys(key, what_variant)) * settings_.variants);
}

// Of the mesh no more than its owned faces, which are the first, and their vertices.
class Scatter::OnCell final : public Furnishing {
 public:
  OnCell(const Scatter& scatter, const CellMesh& ground, Key individual)
      : scatter_(scatter), is_known_(individual == 0 && !scatter.known_bounds_.empty()) {
    const Mesh& all = ground.mesh;
    const std::uint32_t faces = ground.owned_faces, corners = all.face_starts[faces];
    mesh_.face_starts.assign(all.face_starts.begin(), all.face_starts.begin() + faces + 1);
    mesh_.corner_vertices.assign(all.corner_vertices.begin(), all.corner_vertices.begin() + corners);
    std::uint32_t vertices = 0;
    for (std::uint32_t v : mesh_.corner_vertices) vertices = std::max(vertices, v + 1);
    mesh_.positions.assign(all.positions.begin(), all.positions.begin() + vertices);
    uv_ = vertex_uv(all);
    uv_.resize(vertices);
    uv_.shrink_to_fit();
    mesh_.face_keys.reserve(faces);
    for (std::uint32_t f = 0; f < faces; ++f)
      mesh_.face_keys.push_back(hash_keys(all.face_keys[f], scatter.seed_, individual));
    count();
  }

  std::uint32_t face_count() const override { return mesh_.face_count(); }
  std::uint32_t most_on(std::uint32_t face) const override { return counts_[face]; }
  Bounds3f ground_bounds() const override { return ground_of(0, face_count()); }
  Bounds3f bounds(std::uint32_t begin, std::uint32_t end, const PlacedReach& reach) const override {
    const auto counts = std::span(counts_).subspan(begin, end - begin);
    if (std::ranges::all_of(counts, [](std::uint32_t n) { return n == 0; })) return {};
    if (reach.kinds.empty()) return bounds_with_reach(ground_of(begin, end), reach.all);
    const GroundPoints points = points_on(begin, end);
    const std::vector<float> scale = points.evaluate(*scatter_.settings_.scale, scatter_.seed_);
    Bounds3d bounds;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!std::isfinite(scale[i])) continue;
      const Key key = points.key(i);
      const Choice& choice = scatter_.choose(uniform_double(hash_keys(key, what_kind)));
      const Bounds3f& of_kind = reach.kinds[scatter_.kind(choice, scatter_.variant_of(key))];
      const double size = std::abs(double(scale[i]));
      bounds.extend(
          {points.position(i) + Vec3d(of_kind.lower) * size, points.position(i) + Vec3d(of_kind.upper) * size});
    }
    return round_outwards(bounds.inflated(Vec3d(rounding * bounds.diagonal())));
  }
  void place(std::uint32_t begin, std::uint32_t end, std::vector<Placement>& placements) const override {
    const GroundPoints points = points_on(begin, end);
    const std::vector<float> scale = points.evaluate(*scatter_.settings_.scale, scatter_.seed_);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::isfinite(scale[i]) && scale[i] != 0)
        placements.push_back(
            scatter_.placement(points.position(i), points.normal(i), double(scale[i]), points.key(i), is_known_));
  }
  std::size_t bytes() const override {
    return sizeof(*this) + mesh_.bytes() + uv_.capacity() * sizeof(Vec2d) + counts_.capacity() * 4;
  }

 private:
  static constexpr double rounding = 1e-5;  // of boxes in float

  Bounds3f ground_of(std::uint32_t begin, std::uint32_t end) const {
    Bounds3d bounds;
    for (std::uint32_t c = mesh_.face_starts[begin]; c < mesh_.face_starts[end]; ++c)
      bounds.extend(mesh_.positions[mesh_.corner_vertices[c]]);
    return round_outwards(bounds);
  }
  GroundPoints points_on(std::uint32_t begin, std::uint32_t end) const {
    GroundPoints points(std::accumulate(counts_.begin() + begin, counts_.begin() + end, std::size_t(0)));
    for (std::uint32_t f = begin; f < end; ++f) {
      if (counts_[f] == 0) continue;
      const GroundFace face(mesh_, uv_, f);
      for (std::uint64_t i = 0; i < counts_[f]; ++i)
        face.add_random(hash_keys(mesh_.face_keys[f], what_part, i), points);
    }
    return points;
  }
  void count() {
    GroundPoints centroids(face_count());
    std::vector<double> areas;
    for (std::uint32_t f = 0; f < face_count(); ++f) {
      const GroundFace face(mesh_, uv_, f);
      face.add_centroid(mesh_.face_keys[f], centroids);
      areas.push_back(face.area());
    }
    const std::vector<float> density = centroids.evaluate(*scatter_.settings_.density, scatter_.seed_);
    for (std::uint32_t f = 0; f < face_count(); ++f) {
      const double expected = std::min(std::max(0.0, double(density[f]) * areas[f]), 1e6);  // of NaN: 0
      counts_.push_back(std::uint32_t(expected + uniform_double(hash_keys(mesh_.face_keys[f], what_count))));
    }
  }

  const Scatter& scatter_;
  const bool is_known_;
  Mesh mesh_;  // its face keys are those of what stands on them
  std::vector<Vec2d> uv_;
  std::vector<std::uint32_t> counts_;
};

std::unique_ptr<const Furnishing> Scatter::furnish(const CellMesh& ground, Key individual) const {
  return std::make_unique<const OnCell>(*this, ground, individual);
}

const Scatter::Choice& Scatter::choose(double random) const {
  double left = random * total_weight_;
  for (const Choice& c : choices_)
    if ((left -= c.weight) < 0) return c;
  return choices_.back();
}

Placement Scatter::placement(Vec3d position, Vec3d normal, double scale, Key key, bool is_known) const {
  const Vec3d up{0, 1, 0};
  const Vec3d axis = normalize(up * (1 - settings_.align) + normal * settings_.align);
  const double turn = settings_.turn * pi / 180 * uniform_double(hash_keys(key, what_turn));
  const Choice& choice = choose(uniform_double(hash_keys(key, what_kind)));
  Placement p;
  // No count of who holds it: the scatter does, and threads would pass the counter to and fro.
  p.part = std::shared_ptr<const Part>(std::shared_ptr<const Part>(), choice.part.get());
  p.moments = choice.moments;
  p.to_parent = Affine3d::translation(position - axis * (settings_.sink * scale)) *
                standing(axis == Vec3d{} ? up : axis) * Affine3d::rotation(up, turn) * Affine3d::scaling(Vec3d(scale));
  p.individual = key;
  if (settings_.variants == 0) return p;
  const int index = variant_of(key);
  if (settings_.distinct > 0) {
    p.stand_in = variant(index);
    p.stand_in_below = settings_.distinct;
    return p;
  }
  p.is_shared = true;
  p.is_one_of_many = true;
  p.individual = variant(index);
  if (is_known) p.known_bounds = known_bounds_[kind(choice, index)];
  return p;
}

}  // namespace meristem
