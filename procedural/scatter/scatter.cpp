#include "procedural/scatter/scatter.h"

#include "geometry/cells/expansion.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace meristem {

namespace {

constexpr int most_variants_measured = 64;

enum Slot { slot_p, slot_n, slot_u, slot_v, slot_count };
enum What : Key { what_count = 1, what_place, what_turn, what_kind, what_variant, what_part };

// Points on the ground as columns, the inputs of an expression.
class GroundPoints {
 public:
  void add(Vec3d p, Vec3d n, Vec2d uv, Key key) {
    const std::array<double, 8> row{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y};
    for (std::size_t i = 0; i < row.size(); ++i) columns_[i].push_back(float(row[i]));
    keys_.push_back(key);
  }
  std::vector<float> evaluate(const Expression& expression, Key salt) const {
    const auto column = [&](std::size_t i) { return columns_[i].data(); };
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
  Vec3d position(std::size_t i) const { return {columns_[0][i], columns_[1][i], columns_[2][i]}; }
  Vec3d normal(std::size_t i) const { return {columns_[3][i], columns_[4][i], columns_[5][i]}; }

 private:
  std::array<std::vector<float>, 8> columns_;
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

// Of one individual, from its first expansion: far closer than what holds for all that a model could grow to. Seen
// small it stays on a level before that, whose vertices stand out from the surface they are smoothed to; those of the
// levels after it may do so a little.
Bounds3f individual_bounds(const Part& part, Key individual) {
  if (!part.model || part.placer) return part.bounds;
  const Model& model = *part.model;
  CellMesh cell = root_cell(model, nullptr, individual);
  const Expansion first = expand(model, cell, 0);
  if (first.leaf) return part.bounds;
  Bounds3f bounds;
  for (const Bounds3f& child : first.inner->child_bounds) bounds.extend(child);
  for (int level = 0; level < first.inner->level; ++level) {
    extend_by_vertices(cell, bounds);
    CellMesh next;
    model.step(level).apply(cell, model.halo_rings(level + 1), next);
    cell = std::move(next);
  }
  extend_by_vertices(cell, bounds);
  constexpr float margin = 0.05f;
  return bounds.inflated(Vec3f(margin * bounds.diagonal()));
}

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
  std::array<IntervalValue, slot_count> anywhere{};
  constexpr float inf = std::numeric_limits<float>::infinity();
  anywhere[slot_p] = {{-inf, inf}, {-inf, inf}, {-inf, inf}, inf};
  anywhere[slot_n] = IntervalValue::unit_vector();
  anywhere[slot_u] = anywhere[slot_v] = IntervalValue::scalar(-inf, inf);
  const Interval scale = settings_.scale->evaluate_bounds(anywhere).x;
  const double largest = farthest(double(scale.lower), double(scale.upper));
  const bool is_upright = settings_.align == 0 && scale.lower >= 0;
  constexpr double most_scale = 1e6;
  if (!(largest <= most_scale)) throw std::runtime_error("the scale has no upper bound: wrap it in clamp(..., lo, hi)");
  measure_variants();
  for (const Choice& c : choices_) {
    total_weight_ += c.weight;
    if (known_bounds_.empty())
      reach_.extend(reach_of(bounds_of_moments(*c.part, c.moments.get()), largest, is_upright));
  }
  for (const Bounds3f& b : known_bounds_) reach_.extend(reach_of(b, largest, is_upright));
}

// Where a part with those bounds may lie around the place where it stands: turned about the vertical, or any way.
Bounds3f Scatter::reach_of(const Bounds3f& b, double largest, bool is_upright) const {
  const double sink = std::abs(settings_.sink);
  const double aside =
      std::hypot(farthest(double(b.lower.x), double(b.upper.x)), farthest(double(b.lower.z), double(b.upper.z)));
  const double any = std::hypot(aside, farthest(double(b.lower.y), double(b.upper.y))) + sink;
  Bounds3d reach{Vec3d{-aside, double(b.lower.y) - sink, -aside}, Vec3d{aside, double(b.upper.y) + sink, aside}};
  if (!is_upright) reach = {Vec3d(-any), Vec3d(any)};
  reach.extend(Vec3d{});
  return round_outwards(Bounds3d{reach.lower * largest, reach.upper * largest});
}

void Scatter::measure_variants() {
  const bool are_known_otherwise =
      std::any_of(choices_.begin(), choices_.end(), [](const Choice& c) { return c.part->derives || c.moments; });
  if (settings_.variants > most_variants_measured || are_known_otherwise) return;
  for (const Choice& c : choices_)
    for (int i = 0; i < settings_.variants; ++i) known_bounds_.push_back(individual_bounds(*c.part, variant(i)));
}

Key Scatter::variant(int index) const { return hash_keys(seed_, what_variant, Key(index)); }

void Scatter::place(const CellMesh& ground, Key individual, std::vector<Placement>& placements) const {
  const Mesh& mesh = ground.mesh;
  const std::vector<Vec2d> uv = vertex_uv(mesh);
  GroundPoints centroids, points;
  for (std::uint32_t f = 0; f < ground.owned_faces; ++f)
    GroundFace(mesh, uv, f).add_centroid(hash_keys(mesh.face_keys[f], seed_, individual), centroids);
  const std::vector<float> density = centroids.evaluate(*settings_.density, seed_);
  for (std::uint32_t f = 0; f < ground.owned_faces; ++f) {
    const GroundFace face(mesh, uv, f);
    const double expected = std::clamp(double(density[f]) * face.area(), 0.0, 1e6);  // of NaN: 0
    const Key key = centroids.key(f);
    const auto count = std::uint64_t(expected + uniform_double(hash_keys(key, what_count)));
    for (std::uint64_t i = 0; i < count; ++i) face.add_random(hash_keys(key, what_part, i), points);
  }
  const std::vector<float> scale = points.evaluate(*settings_.scale, seed_);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (std::isfinite(scale[i]) && scale[i] != 0)
      placements.push_back(placement(points.position(i), points.normal(i), double(scale[i]), points.key(i)));
}

const Scatter::Choice& Scatter::choose(double random) const {
  double left = random * total_weight_;
  for (const Choice& c : choices_)
    if ((left -= c.weight) < 0) return c;
  return choices_.back();
}

Placement Scatter::placement(Vec3d position, Vec3d normal, double scale, Key key) const {
  const Vec3d up{0, 1, 0};
  const Vec3d axis = normalize(up * (1 - settings_.align) + normal * settings_.align);
  const double turn = settings_.turn * pi / 180 * uniform_double(hash_keys(key, what_turn));
  const Choice& choice = choose(uniform_double(hash_keys(key, what_kind)));
  Placement p;
  p.part = choice.part;
  p.moments = choice.moments;
  p.to_parent = Affine3d::translation(position - axis * (settings_.sink * scale)) *
                standing(axis == Vec3d{} ? up : axis) * Affine3d::rotation(up, turn) * Affine3d::scaling(Vec3d(scale));
  p.individual = key;
  if (settings_.variants == 0) return p;
  const int index = int(uniform_double(hash_keys(key, what_variant)) * settings_.variants);
  if (settings_.distinct > 0) {
    p.stand_in = variant(index);
    p.stand_in_below = settings_.distinct;
    return p;
  }
  p.is_shared = true;
  p.is_one_of_many = true;
  p.individual = variant(index);
  if (!known_bounds_.empty())
    p.known_bounds =
        known_bounds_[std::size_t(&choice - choices_.data()) * std::size_t(settings_.variants) + std::size_t(index)];
  return p;
}

}  // namespace meristem
