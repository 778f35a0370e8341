#include "procedural/plants/weber_penn_step.h"

#include "geometry/base/check.h"
#include "procedural/plants/leaf_shape.h"

#include <fmt/format.h>

#include <cmath>

namespace meristem {

namespace {

constexpr double bud_radius = 0.004;  // metres; of the triangle, whatever grows on it
constexpr Key step_tag = hash_text("weber penn"), shown = hash_text("shown"),
              drawn_in_full = hash_text("drawn in full");

enum BudParameter { bud_length, bud_base_radius, bud_children, bud_inset, bud_scale };

void parameters_of(const StemBud& bud, FaceOrigin& origin) {
  origin.parameters = {float(bud.length), float(bud.radius), float(bud.children), float(bud.inset), float(bud.scale)};
}

// Turns a leaf towards the light: outwards and upwards (section 4.9 of the paper).
void turn_to_light(Affine3d& frame, double bend) {
  const Vec3d o = frame.origin, n = frame.y;
  turn_about_up(frame, bend * std::atan2(n.z * o.x - n.x * o.z, n.x * o.x + n.z * o.z));
  const double tilt = std::acos(std::clamp(dot(frame.y, plant_up), -1.0, 1.0));
  turn_about_x(frame, dot(frame.z, plant_up) < 0 ? -bend * tilt : bend * tilt);
}

Interval outwards(double lower, double upper) {
  return {std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
}

}  // namespace

std::array<Vec3d, 3> bud_corners(const Affine3d& frame) {
  const Vec3d along = frame.x * (0.5 * bud_radius), across = frame.y * (std::sqrt(0.75) * bud_radius);
  return {frame.origin + along - across, frame.origin + along + across, frame.origin - frame.x * bud_radius};
}

WeberPennStep::WeberPennStep(std::shared_ptr<const WeberPennPlant> plant, int level)
    : plant_(std::move(plant)), level_(level) {}

std::string WeberPennStep::name() const {
  static constexpr const char* names[] = {"trunk", "branches", "twigs"};
  return level_ < 3 ? names[level_] : fmt::format("twigs {}", level_ - 1);
}

std::uint32_t WeberPennStep::max_children(std::uint32_t) const {
  const WeberPennParameters& p = plant_->parameters;
  const StemDetail detail = plant_detail(p, level_, 1, 1, 0, plant_->is_smoothed).stem;
  const double faces_of_child = is_last() ? leaf_shape(p.leaf_shape).face_count() : 1;
  const double faces =
      expected_segments(p, level_) * faces_of_segment(detail) + expected_children(p, level_) * faces_of_child + 2;
  return std::uint32_t(std::min(faces, 1e9));
}

double WeberPennStep::thinned_children(const FaceOrigin& bud, double footprint) const {
  const WeberPennParameters& p = plant_->parameters;
  if (!is_last() || level_ == 0) return max_children(3);
  const double segment = double(bud.parameters[bud_length]) / p.at(level_).curve_res;
  const PlantDetail detail =
      plant_detail(p, level_, double(bud.parameters[bud_base_radius]), segment, footprint, plant_->is_smoothed);
  const double leaves = std::abs(double(bud.parameters[bud_children])) * detail.leaf_share;
  return detail.stem_share * expected_segments(p, level_) * faces_of_segment(detail.stem) +
         leaves * leaf_shape(p.leaf_shape).face_count() + 1;
}

// One run of apply().
class WeberPennStep::Application {
 public:
  Application(const WeberPennStep& step, const CellMesh& in, CellMesh& out)
      : step_(step),
        plant_(*step.plant_),
        in_(in),
        out_(out),
        grown_(out.mesh, step.quantum_, !in.mesh.corner_uv.empty() || in.mesh.uv.empty(),
               hash_keys(step_tag, Key(step.level_))),
        kept_vertices_(in.mesh.vertex_count(), none),
        kept_origins_(in.mesh.origins.size(), none) {
    out.mesh = {};
  }

  void run() {
    reserve();
    out_.owned_faces = 0;
    out_.rings.clear();
    for (std::uint32_t f = 0; f < in_.mesh.face_count(); ++f) {
      const FaceOrigin& origin = in_.mesh.origins[in_.mesh.face_origins[f]];
      if (step_.grows(origin.symbol))
        grow(f, origin);
      else
        keep(f);
      if (f < in_.owned_faces) out_.owned_faces = out_.mesh.face_count();
      out_.rings.resize(out_.mesh.face_count(), f < in_.rings.size() ? in_.rings[f] : std::uint8_t(0));
    }
    Mesh& o = out_.mesh;
    if (!in_.mesh.corner_sharpness.empty()) o.corner_sharpness.resize(o.corner_vertices.size(), 0);
    if (!in_.mesh.vertex_sharpness.empty()) o.vertex_sharpness.resize(o.positions.size(), 0);
    if (!in_.mesh.nominal_scale.empty()) o.nominal_scale.resize(o.positions.size());
    if (!in_.mesh.frozen.empty()) o.frozen.resize(o.positions.size());
  }

 private:
  static constexpr std::uint32_t none = ~0u;

  // Room for what many buds become, by their expected size.
  void reserve() {
    const auto is_bud = [&](std::uint32_t origin) { return step_.grows(in_.mesh.origins[origin].symbol); };
    const auto buds = std::count_if(in_.mesh.face_origins.begin(), in_.mesh.face_origins.end(), is_bud);
    constexpr std::ptrdiff_t many = 16;
    if (buds < many) return;
    const auto faces = in_.mesh.face_count() + std::size_t(buds) * step_.max_children(3);
    Mesh& o = out_.mesh;
    o.face_starts.reserve(faces);
    o.face_keys.reserve(faces);
    o.face_origins.reserve(faces);
    o.corner_vertices.reserve(4 * faces);
    if (grown_.has_uv_by_corner()) o.corner_uv.reserve(4 * faces);
    o.positions.reserve(2 * faces);
    o.vertex_keys.reserve(2 * faces);
    o.origins.reserve(faces / 2);
  }

  std::uint32_t kept_vertex(std::uint32_t v) {
    const Mesh& m = in_.mesh;
    Mesh& o = out_.mesh;
    std::uint32_t& kept = kept_vertices_[v];
    if (kept != none) return kept;
    if (!m.uv.empty()) o.uv.push_back(m.uv[v]);
    if (!m.vertex_sharpness.empty()) {
      o.vertex_sharpness.resize(o.positions.size(), 0);
      o.vertex_sharpness.push_back(m.vertex_sharpness[v]);
    }
    o.add_vertex(m.positions[v], m.vertex_keys[v]);
    keep_detail(m.nominal_scale, v, o.nominal_scale);
    keep_detail(m.frozen, v, o.frozen);
    return kept = o.vertex_count() - 1;
  }

  // New vertices have none yet.
  template <class T>
  void keep_detail(const std::vector<T>& from, std::uint32_t v, std::vector<T>& to) {
    if (from.empty()) return;
    to.resize(out_.mesh.positions.size());
    to.back() = from[v];
  }

  void keep(std::uint32_t f) {
    const Mesh& m = in_.mesh;
    Mesh& o = out_.mesh;
    std::uint32_t& origin = kept_origins_[m.face_origins[f]];
    if (origin == none) {
      origin = std::uint32_t(o.origins.size());
      o.origins.push_back(m.origins[m.face_origins[f]]);
    }
    face_.clear();
    for (std::uint32_t v : m.corners(f)) face_.push_back(kept_vertex(v));
    if (!m.corner_sharpness.empty()) o.corner_sharpness.resize(o.corner_vertices.size(), 0);
    for (std::uint32_t c = m.face_starts[f]; c < m.face_starts[f + 1]; ++c) {
      if (!m.corner_uv.empty()) o.corner_uv.push_back(m.corner_uv[c]);
      if (!m.corner_sharpness.empty()) o.corner_sharpness.push_back(m.corner_sharpness[c]);
    }
    o.add_face(face_, m.face_keys[f], origin);
  }

  StemBud bud_of(std::uint32_t f, const FaceOrigin& origin) const {
    const FaceFrame frame = face_frame(in_.mesh, f);
    const Affine3d axes{frame.x, frame.y, frame.z, frame.origin};
    const Key key = hash_keys(in_.mesh.face_keys[f], plant_.seed);
    if (step_.level_ == 0) return trunk_bud(plant_.parameters, axes, key);
    const auto& q = origin.parameters;
    return {step_.level_, key, axes, q[bud_length], q[bud_base_radius], q[bud_children], q[bud_inset], q[bud_scale]};
  }

  double footprint_at(Vec3d root) const {
    return in_.footprint ? std::max(plant_.footprint, in_.footprint->at(root)) : plant_.footprint;
  }

  void grow(std::uint32_t f, const FaceOrigin& origin) {
    const Stem stem(plant_.parameters, bud_of(f, origin));
    const Draws draws(stem.bud().key);
    const PlantDetail detail = plant_detail(plant_.parameters, step_.level_, stem.bud().radius, stem.segment_length(),
                                            footprint_at(stem.bud().frame.origin), plant_.is_smoothed);
    const std::uint32_t before = out_.mesh.face_count();
    grown_.begin_bud(in_.mesh.face_keys[f]);
    if (draws.uniform(shown) < detail.stem_share) mesh_stem(stem, plant_.parameters, detail.stem, plant_.bark, grown_);
    stem.find_children(children_);
    for (const StemChild& child : children_)
      if (!stem.bears_leaves())
        add_bud(child.bud);
      else if (Draws(child.bud.key).uniform(shown) < detail.leaf_share)
        add_leaf(child, detail);
    if (out_.mesh.face_count() == before) leave_bud(f);
  }

  // Where nothing of it is drawn, the triangle stays, a speck that nothing grows on.
  void leave_bud(std::uint32_t f) {
    keep(f);
    FaceOrigin speck = in_.mesh.origins[in_.mesh.face_origins[f]];
    speck.symbol = -1;
    out_.mesh.face_origins.back() = std::uint32_t(out_.mesh.origins.size());
    out_.mesh.origins.push_back(speck);
  }

  void add_bud(const StemBud& bud) {
    FaceOrigin origin{0, plant_.bark.material, step_.bud_symbol(bud.level), {}};
    parameters_of(bud, origin);
    grown_.begin_bud(bud.key);
    grown_.set_origin(origin);
    const auto corners = bud_corners(bud.frame);
    grown_.add_face(
        {grown_.add_vertex(corners[0], {}), grown_.add_vertex(corners[1], {}), grown_.add_vertex(corners[2], {})});
  }

  void add_leaf(const StemChild& leaf, const PlantDetail& detail) {
    const WeberPennParameters& p = plant_.parameters;
    const bool in_full = Draws(leaf.bud.key).uniform(drawn_in_full) < detail.leaf_faces;
    const LeafShape& shape = in_full ? leaf_shape(p.leaf_shape) : simple_leaf_shape(p.leaf_shape);
    Affine3d frame = leaf.bud.frame;
    turn_to_light(frame, p.leaf_bend);
    const double size = leaf.bud.length * detail.leaf_growth;
    FaceOrigin origin{0, plant_.leaf_material, plant_.leaf_symbol, {float(leaf.place), float(size)}};
    grown_.begin_bud(leaf.bud.key);
    grown_.set_origin(origin);
    vertices_.clear();
    for (std::size_t i = 0; i < shape.vertices.size(); ++i) {
      const Vec3d v = shape.vertices[i];
      const Vec3d at = frame.z * (v.y * size) + frame.y * (v.z * size) - frame.x * (v.x * size * p.leaf_scale_x);
      vertices_.push_back(grown_.add_vertex(frame.origin + at, shape.uv[i]));
    }
    for (std::uint32_t f = 0; f < shape.face_count(); ++f) {
      face_.clear();
      for (std::uint32_t v : shape.face(f)) face_.push_back(vertices_[v]);
      grown_.add_face(face_);
    }
  }

  const WeberPennStep& step_;
  const WeberPennPlant& plant_;
  const CellMesh& in_;
  CellMesh& out_;
  PlantMesh grown_;
  std::vector<std::uint32_t> kept_vertices_, kept_origins_;  // by index before: index after
  std::vector<std::uint32_t> face_, vertices_;
  std::vector<StemChild> children_;
};

void WeberPennStep::apply(const CellMesh& in, int rings_after, CellMesh& out) const {
  Application(*this, in, out).run();
  if (out.owned_faces < out.mesh.face_count()) trim_halo(out, rings_after);
}

Extent WeberPennStep::bound(const Extent& e) const {
  Extent after = e;
  after.symbols.clear();
  for (const SymbolRange& range : e.symbols) {
    if (!grows(range.symbol)) {
      after.symbols.push_back(range);
      continue;
    }
    const WeberPennParameters& p = plant_->parameters;
    const double length = level_ == 0 ? longest_trunk(p) : double(range.parameters[bud_length].upper);
    const double radius = level_ == 0 ? thickest_trunk(p) : double(range.parameters[bud_base_radius].upper);
    const StemReach reach = stem_reach(p, level_, length, radius);
    const double section = cage_radius(4) * reach.radius * (1 + (level_ == 0 ? p.lobe_depth : 0));
    const double segment = length / p.at(level_).curve_res;
    // A control point may lie beyond the axis by half the distance of rings, over 6; a tip by a fifth of it
    const double child = is_last() ? reach.child_length * most_leaf_growth * leaf_shape(p.leaf_shape).reach *
                                         std::max(p.leaf_scale_x, 1.0)
                                   : bud_radius;
    const double distance = reach.axis + 0.2 * segment + std::max(2 * section, child);
    const double slack = 2 * quantum_.step() + 1e-9 * (distance + e.box.diagonal());
    after.box.extend(e.box.inflated(Vec3d(distance + slack)));
    after.edge = std::max({after.edge, 2 * segment + 4 * section + (reach.axis - length), 2 * child});
    after.u = outwards(std::min(after.u.lower, -0.5f), std::max(after.u.upper, 1.5f));
    after.v = outwards(std::min(double(after.v.lower), -section), std::max(double(after.v.upper), length + 1));
    if (is_last()) continue;
    SymbolRange next{bud_symbol(level_ + 1), {}, std::nextafterf(float(1.001 * bud_radius), INFINITY)};
    next.parameters[bud_length] = outwards(0, reach.child_length);
    next.parameters[bud_base_radius] = outwards(0, radius);
    after.symbols.push_back(next);
  }
  after.forget_shape();
  return after;
}

}  // namespace meristem
