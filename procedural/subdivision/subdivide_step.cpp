#include "procedural/subdivision/subdivide_step.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

namespace meristem {

namespace {

// Slots of placement_symbols(), in order.
enum Slot {
  slot_p,
  slot_n,
  slot_scale,
  slot_t,
  slot_b,
  slot_u,
  slot_v,
  slot_level,
  slot_kind,
  slot_parameter,  // the first of several
  slot_count = slot_parameter + max_growth_parameters
};

// Structure-of-arrays inputs of the placement of some vertices.
class PlacementInputs {
 public:
  explicit PlacementInputs(std::size_t count) : count_(count), columns_(most_columns * count) {}

  template <class Get>
  void vector(Slot slot, Get get) {
    float *x = column(), *y = column(), *z = column();
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3d v = get(i);
      x[i] = float(v.x);
      y[i] = float(v.y);
      z[i] = float(v.z);
    }
    inputs_[slot] = {x, y, z, 1};
  }
  template <class Get>
  void scalar(Slot slot, Get get) {
    float* x = column();
    for (std::size_t i = 0; i < count_; ++i) x[i] = float(get(i));
    inputs_[slot] = {x, nullptr, nullptr, 1};
  }
  void uniform(Slot slot, const float& value) { inputs_[slot] = {&value, nullptr, nullptr, 0}; }
  std::span<const Input> inputs() const { return inputs_; }

 private:
  static constexpr std::size_t most_columns = 4 * 3 + 4 + max_growth_parameters;  // P N T B; scale u v kind; p0 ...
  float* column() { return columns_.data() + count_ * used_columns_++; }

  const std::size_t count_;
  std::size_t used_columns_ = 0;
  Scratch<float> columns_;
  std::array<Input, slot_count> inputs_;
};

// Of every vertex the smallest value that the faces around its parent have of a symbol's parameter.
std::vector<float> least_parameter(const Mesh& before, const RefinePlan& plan, std::size_t index) {
  const auto of_face = [&](std::uint32_t f) { return before.origins[before.face_origins[f]].parameters[index]; };
  std::vector<float> least(plan.kept_vertices);
  const auto set = [&](std::uint32_t v, float value) {
    if (v < plan.kept_vertices) least[v] = value;
  };
  for (const auto& v : plan.face_vertices) set(v.out, of_face(v.face));
  for (const auto& v : plan.edge_vertices)
    set(v.out,
        v.faces[1] == RefinePlan::none ? of_face(v.faces[0]) : std::min(of_face(v.faces[0]), of_face(v.faces[1])));
  for (const auto& v : plan.vertex_vertices) {
    float value = of_face(plan.vertex_faces[v.first_face]);
    for (std::uint32_t k = 1; k < v.face_count; ++k)
      value = std::min(value, of_face(plan.vertex_faces[v.first_face + k]));
    set(v.out, value);
  }
  return least;
}

double largest(const Interval& i) { return std::max(std::abs(double(i.lower)), std::abs(double(i.upper))); }

double largest_length(const IntervalValue& v) {
  return std::min(length(Vec3d{largest(v.x), largest(v.y), largest(v.z)}), double(v.max_length));
}

}  // namespace

const Symbols& placement_symbols() {
  static const Symbols symbols = [] {
    Symbols s;
    s.add("P", ValueType::Vector, "smooth position in the model's space, in metres");
    s.add("N", ValueType::Vector, "local normal: mean normal of the faces that meet here, of unit length");
    s.add("scale", ValueType::Scalar, "local scale: mean diagonal of the faces that meet here, in metres");
    s.add("T", ValueType::Vector, "unit tangent along growing u");
    s.add("B", ValueType::Vector, "unit tangent at right angles to N and T");
    s.add("u", ValueType::Scalar, "texture coordinate around a stem");
    s.add("v", ValueType::Scalar, "texture coordinate along a stem");
    s.add("level", ValueType::Scalar, "level of subdivision, from 1 over the whole model");
    s.add("kind", ValueType::Scalar, "what the vertex comes from: 0 a vertex, 1 an edge, 2 a face");
    for (int i = 0; i < max_growth_parameters; ++i)
      s.add(fmt::format("p{}", i), ValueType::Scalar,
            "parameter of the symbol that growth gave the faces here (the least)");
    return s;
  }();
  return symbols;
}

std::string SubdivideStep::name() const {
  return fmt::format("subdivide {}{}", settings_.level, settings_.place ? " (placed)" : "");
}

std::uint32_t SubdivideStep::max_children(std::uint32_t corners) const {
  return settings_.refine.scheme == Scheme::Loop ? 4 : corners;
}

void SubdivideStep::apply(const CellMesh& in, int rings_after, CellMesh& out) const {
  const auto plan = shared_refine_plan(in.mesh, in.owned_faces, rings_after, settings_.refine);
  RefinedMesh refined = refine(in.mesh, *plan, settings_.quantum, settings_.step_key);
  out.owned_faces = plan->owned_faces;
  out.rings = plan->rings;
  out.labels.clear();
  if (!in.labels.empty())
    for (std::uint32_t f = 0; f < plan->owned_faces; ++f) out.labels.push_back(in.labels[plan->face_parents[f]]);
  out.mesh = std::move(refined.mesh);
  if (settings_.place) place_vertices(in.mesh, *plan, refined, out.mesh);
}

void SubdivideStep::place_vertices(const Mesh& before, const RefinePlan& plan, const RefinedMesh& refined,
                                   Mesh& mesh) const {
  const Expression& place = *settings_.place;
  const bool with_tangents = place.uses(slot_t) || place.uses(slot_b);
  const LocalGeometry local = local_geometry(plan, refined, settings_.quantum, with_tangents);
  const std::size_t count = mesh.vertex_count();

  PlacementInputs inputs(count);
  if (place.uses(slot_p)) inputs.vector(slot_p, [&](std::size_t i) { return mesh.positions[i]; });
  if (place.uses(slot_n)) inputs.vector(slot_n, [&](std::size_t i) { return local.normals[i]; });
  if (place.uses(slot_scale)) inputs.scalar(slot_scale, [&](std::size_t i) { return local.scales[i]; });
  if (place.uses(slot_t)) inputs.vector(slot_t, [&](std::size_t i) { return local.tangents[i]; });
  if (place.uses(slot_b))
    inputs.vector(slot_b, [&](std::size_t i) { return cross(local.normals[i], local.tangents[i]); });
  if (place.uses(slot_u)) inputs.scalar(slot_u, [&](std::size_t i) { return mesh.uv[i].x; });
  if (place.uses(slot_v)) inputs.scalar(slot_v, [&](std::size_t i) { return mesh.uv[i].y; });
  if (place.uses(slot_kind)) inputs.scalar(slot_kind, [&](std::size_t i) { return double(int(plan.kinds[i])); });
  const float level = float(settings_.level);
  inputs.uniform(slot_level, level);
  for (int i = 0; i < max_growth_parameters; ++i) {
    const Slot slot = Slot(slot_parameter + i);
    if (!place.uses(slot)) continue;
    const std::vector<float> least = least_parameter(before, plan, std::size_t(i));
    inputs.scalar(slot, [&](std::size_t v) { return double(least[v]); });
  }

  Scratch<float> x(count), y(count), z(count);
  place.evaluate({int(count), inputs.inputs(), mesh.vertex_keys.data(), settings_.step_key}, x.data(), y.data(),
                 z.data());
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d offset{x[i], y[i], z[i]};
    if (!is_finite(offset))
      throw std::runtime_error(fmt::format("{}: the placement \"{}\" is not finite", name(), place.text()));
    mesh.positions[i] = settings_.quantum.round(mesh.positions[i] + offset);
  }
}

IntervalValue SubdivideStep::placement_bounds(const Extent& e, double scale) const {
  std::array<IntervalValue, slot_count> inputs{};
  auto interval = [](double lower, double upper) {
    return Interval{std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
  };
  const Bounds3d& box = e.smooth_box();
  inputs[slot_p] = {interval(box.lower.x, box.upper.x), interval(box.lower.y, box.upper.y),
                    interval(box.lower.z, box.upper.z), std::numeric_limits<float>::infinity()};
  for (Slot s : {slot_n, slot_t, slot_b}) {
    constexpr float one = 1.0f + 1e-6f;
    inputs[s] = {{-one, one}, {-one, one}, {-one, one}, one};
  }
  inputs[slot_scale] = IntervalValue::scalar(0, interval(0, scale).upper);
  inputs[slot_u].x = e.u;
  inputs[slot_v].x = e.v;
  inputs[slot_level] = IntervalValue::scalar(float(settings_.level), float(settings_.level));
  inputs[slot_kind] = IntervalValue::scalar(0, 2);
  for (int i = 0; i < max_growth_parameters; ++i)
    inputs[std::size_t(slot_parameter + i)] = IntervalValue::scalar(-INFINITY, INFINITY);
  return settings_.place->evaluate_bounds(inputs);
}

Extent SubdivideStep::bound(const Extent& e) const {
  Extent after = e;
  if (!settings_.place) {
    after.refine({}, {}, 0);
    return after;
  }
  const IntervalValue offset = placement_bounds(e, e.refined_scale());
  after.refine(min(Vec3d{offset.x.lower, offset.y.lower, offset.z.lower}, Vec3d{}),
               max(Vec3d{offset.x.upper, offset.y.upper, offset.z.upper}, Vec3d{}), largest_length(offset));
  return after;
}

double SubdivideStep::offset_bound(const Extent& before, double scale) const {
  return settings_.place ? largest_length(placement_bounds(before, scale)) : 0;
}

}  // namespace meristem
