#include "procedural/plants/weber_penn_step.h"

#include "geometry/base/check.h"
#include "geometry/mesh/refine.h"
#include "procedural/plants/child_kernels.h"
#include "procedural/plants/sized_leaf.h"

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

// A bound on the angle between a trunk and the vertical, radians.
double trunk_lean(const WeberPennParameters& p) {
  const PlantLevel& level = p.level[0];
  if (level.curve_v < 0 || p.base_splits > 0 || level.seg_splits > 0) return pi;
  const double bend =
      level.curve_back != 0 ? std::abs(level.curve) + std::abs(level.curve_back) : std::abs(level.curve);
  return to_radians(bend + level.curve_v + level.bend_v);
}

// How far the surface of a stem may lie from its axis, whatever the footprint.
double most_section(const WeberPennParameters& p, int level, double length, double radius) {
  const double tube = cage_radius(4) * (1 + (level == 0 ? p.lobe_depth : 0)) * radius;
  return std::max(tube, widest_ribbon * length);
}

Interval outwards(double lower, double upper) {
  return {std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
}

}  // namespace

std::array<Vec3d, 3> bud_corners(const Affine3d& frame) {
  const Vec3d along = frame.x * (0.5 * bud_radius), across = frame.y * (std::sqrt(0.75) * bud_radius);
  return {frame.origin + along - across, frame.origin + along + across, frame.origin - frame.x * bud_radius};
}

std::string stems_name(int level) {
  static constexpr const char* names[] = {"trunk", "branches", "twigs"};
  return level < 3 ? names[level] : fmt::format("twigs {}", level - 1);
}

WeberPennStep::WeberPennStep(std::shared_ptr<const WeberPennPlant> plant, int level)
    : plant_(std::move(plant)), level_(level) {}

std::string WeberPennStep::name() const { return stems_name(level_); }

std::uint32_t WeberPennStep::max_children(std::uint32_t) const {
  const WeberPennParameters& p = plant_->parameters;
  const StemDetail detail = plant_detail(p, level_, 1, 1, 0, plant_->is_smoothed).stem;
  const double faces_of_child = is_last() ? leaf_shape(p.leaf_shape).face_count() : 1;
  const double faces =
      expected_segments(p, level_) * faces_of_segment(detail) + expected_children(p, level_) * faces_of_child + 2;
  return std::uint32_t(std::min(faces, 1e9));
}

double WeberPennStep::thinned_faces(const FaceOrigin& bud, double footprint, double refined) const {
  const auto& q = bud.parameters;
  const WeberPennParameters& p = plant_->parameters;
  const double length = level_ == 0 ? longest_trunk(p) : double(q[bud_length]);
  const double radius = level_ == 0 ? thickest_trunk(p) : double(q[bud_base_radius]);
  return expected_faces(level_, length, radius, std::max(footprint, plant_->footprint), refined);
}

// About how many faces a stem becomes with all that grows on it.
double WeberPennStep::expected_faces(int level, double length, double radius, double footprint, double refined) const {
  const WeberPennParameters& p = plant_->parameters;
  const PlantDetail d = plant_detail(p, level, radius, length / p.at(level).curve_res, footprint, plant_->is_smoothed);
  const double stem = d.stem.is_ribbon ? 1 : expected_segments(p, level) * faces_of_segment(d.stem);
  double child = d.are_cards ? 1 : leaf_shape(p.leaf_shape).face_count() * refined;
  if (level + 1 < p.levels) {
    const double share = std::max(p.at(level + 1).length, 0.05);  // of the length and, by a power, of the radius
    child = expected_faces(level + 1, length * share, radius * std::pow(share, p.ratio_power), footprint, refined);
  }
  return d.stem_share * stem * (d.stem.is_final ? 1 : refined) + expected_children(p, level) * d.child_share * child +
         1;
}

StemBud WeberPennStep::bud_of(const CellMesh& in, std::uint32_t f) const {
  const FaceFrame frame = face_frame(in.mesh, f);
  const Affine3d axes{frame.x, frame.y, frame.z, frame.origin};
  const Key key = plant_->key_of_stem(in.mesh.face_keys[f]);
  if (level_ == 0) return trunk_bud(plant_->parameters, axes, key);
  const auto& q = in.mesh.origins[in.mesh.face_origins[f]].parameters;
  return {level_, key, axes, q[bud_length], q[bud_base_radius], q[bud_children], q[bud_inset], q[bud_scale]};
}

// The skeleton of a stem and of what grows on it, down to a level, for its bounds.
class WeberPennStep::Derivation {
 public:
  Derivation(const WeberPennStep& step, const CellMesh& in, int last_level)
      : step_(step), p_(step.plant_->parameters), in_(in), last_level_(last_level) {}

  void add(const StemBud& bud) {
    const double footprint = step_.footprint_at(in_, bud.frame.origin);
    if (reaches_no_further(bud.frame.origin, reach_of_all(bud.level, bud.length, bud.radius, footprint))) return;
    const Stem stem(p_, bud);
    const Bounds3d own = bounds_of(stem, footprint);
    box.extend(own);
    if (stem.bears_leaves()) return;
    const double longest = (p_.at(bud.level + 1).length + p_.at(bud.level + 1).length_v) * bud.length;
    const Bounds3d with_children = own.inflated(Vec3d(reach_of_all(bud.level + 1, longest, bud.radius, footprint)));
    if (bud.level == last_level_) box.extend(with_children);
    if (box.contains(with_children)) return;
    std::vector<StemChild> children;
    stem.find_children(children);
    for (StemChild& child : children) {
      child.bud.key = step_.plant_->key_of_stem(child.bud.key);
      add(child.bud);
    }
  }

  Bounds3d box;

 private:
  bool reaches_no_further(Vec3d root, double reach) const {
    return !box.empty() && box.contains(Bounds3d{root, root}.inflated(Vec3d(reach)));
  }

  PlantDetail detail_of(int level, double radius, double segment, double footprint) const {
    if (shares_.footprint() != footprint) shares_ = KeptShares(p_, footprint);
    return plant_detail(p_, level, radius, segment, shares_, step_.plant_->is_smoothed);
  }

  // From the root of a stem to the furthest of anything on it, whatever its key.
  double reach_of_all(int level, double length, double radius, double footprint) const {
    const double segment = length / p_.at(level).curve_res;
    const StemReach reach = stem_reach(p_, level, length, radius);
    const PlantDetail detail = detail_of(level, radius, segment, footprint);
    const double section =
        most_section(p_, level, length, reach.radius * (detail.stem.is_ribbon ? 1 : detail.stem.widening));
    const double beyond = level + 1 == p_.levels ? leaf_reach(p_, detail.leaf_length, detail.leaf_width)
                                                 : reach_of_all(level + 1, reach.child_length, radius, footprint);
    return reach.axis + 0.2 * segment + std::max(2 * section, beyond);
  }

  // Of the stem alone, with its leaves.
  Bounds3d bounds_of(const Stem& stem, double footprint) const {
    const StemBud& bud = stem.bud();
    const double segment = stem.segment_length();
    const PlantDetail detail = detail_of(bud.level, bud.radius, segment, footprint);
    const bool has_leaves = stem.bears_leaves() && bud.children != 0;
    const double leaf = has_leaves ? leaf_reach(p_, detail.leaf_length, detail.leaf_width) : 0;
    // Smoothing draws control points back that stand out: of bends by half the distance of rings, over 6; of tips by a
    // fifth of it
    const double beyond = step_.plant_->is_smoothed ? segment / 12 : 0,
                 tip = step_.plant_->is_smoothed ? 0.2 * segment : 0;
    double section = most_section(stem, p_, detail.stem, stem.flared_radius_at(0));
    Bounds3d bounds;
    bounds.extend(bud.frame.origin - bud.frame.z * (bud.level == 0 ? section : 0));
    bounds = bounds.inflated(Vec3d(section));
    for (const StemPiece& piece : stem.pieces())
      for (std::size_t i = 0; i + 1 < piece.nodes.size(); ++i) {
        const StemNode &a = piece.nodes[i], &b = piece.nodes[i + 1];
        const double z = (piece.first_segment + double(i)) * segment;
        // Beyond a taper of 1 it may be as thick further up
        if (stem.level().taper <= 1) section = most_section(stem, p_, detail.stem, stem.flared_radius_at(z));
        const double third = length(b.frame.origin - a.frame.origin) / 3;
        Bounds3d axis;  // the control points of its cubic
        for (Vec3d p : {a.frame.origin, a.frame.origin + a.tangent * third, b.frame.origin - b.tangent * third,
                        b.frame.origin, b.frame.origin + b.tangent * tip})
          axis.extend(p);
        bounds.extend(axis.inflated(Vec3d(std::max(section + beyond, leaf))));
      }
    return bounds;
  }

  const WeberPennStep& step_;
  const WeberPennParameters& p_;
  const CellMesh& in_;
  const int last_level_;
  mutable KeptShares shares_{p_, 0};  // of where it was asked last
};

// One run of apply().
class WeberPennStep::Application {
 public:
  Application(const WeberPennStep& step, const CellMesh& in, CellMesh& out)
      : step_(step),
        plant_(*step.plant_),
        in_(in),
        out_(out),
        grown_(out.mesh, step.quantum_, step.shown_quantum_, !in.mesh.corner_uv.empty() || in.mesh.uv.empty(),
               hash_keys(step_tag, Key(step.level_))),
        kept_vertices_(in.mesh.vertex_count(), none),
        kept_origins_(in.mesh.origins.size(), none) {
    out.mesh = {};
  }

  void run() {
    reserve();
    out_.owned_faces = 0;
    out_.rings.clear();
    out_.labels.clear();
    for (std::uint32_t f = 0; f < in_.mesh.face_count(); ++f) {
      const FaceOrigin& origin = in_.mesh.origins[in_.mesh.face_origins[f]];
      if (step_.grows(origin.symbol))
        grow(f);
      else
        keep(f);
      const std::uint32_t faces = grown_.face_count();
      if (f < in_.owned_faces) out_.owned_faces = faces;
      if (f < in_.labels.size()) out_.labels.resize(out_.owned_faces, in_.labels[f]);
      out_.rings.resize(faces, f < in_.rings.size() ? in_.rings[f] : std::uint8_t(0));
    }
    grown_.finish();
    Mesh& o = out_.mesh;
    if (has_seams(in_.mesh)) keep_seams(o);
    if (!in_.mesh.corner_sharpness.empty()) o.corner_sharpness.resize(o.corner_vertices.size(), 0);
    if (!in_.mesh.vertex_sharpness.empty()) o.vertex_sharpness.resize(o.positions.size(), 0);
    if (!in_.mesh.nominal_scale.empty()) o.nominal_scale.resize(o.positions.size());
    if (!in_.mesh.frozen.empty() || !o.frozen.empty()) o.frozen.resize(o.positions.size());
    if (!in_.mesh.fading.empty()) o.fading.resize(o.positions.size());
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
    kept = grown_.keep_vertex(m, v);
    keep_detail(m.vertex_sharpness, v, o.vertex_sharpness);
    keep_detail(m.nominal_scale, v, o.nominal_scale);
    keep_detail(m.frozen, v, o.frozen);
    keep_detail(m.fading, v, o.fading);
    return kept;
  }

  // New vertices have none yet.
  template <class T>
  void keep_detail(const std::vector<T>& from, std::uint32_t v, std::vector<T>& to) {
    if (from.empty()) return;
    to.resize(grown_.vertex_count());
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
    if (!m.corner_sharpness.empty()) {
      o.corner_sharpness.resize(grown_.corner_count(), 0);
      const auto first = m.corner_sharpness.begin();
      o.corner_sharpness.insert(o.corner_sharpness.end(), first + m.face_starts[f], first + m.face_starts[f + 1]);
    }
    grown_.keep_face(m, f, face_, origin);
  }

  void grow(std::uint32_t f) {
    const Stem stem(plant_.parameters, step_.bud_of(in_, f));
    const Draws draws(stem.bud().key);
    const PlantDetail detail = plant_detail(plant_.parameters, step_.level_, stem.bud().radius, stem.segment_length(),
                                            step_.footprint_at(in_, stem.bud().frame.origin), plant_.is_smoothed);
    const std::uint32_t before = grown_.face_count();
    grown_.begin_bud(in_.mesh.face_keys[f]);
    if (draws.uniform(shown) < detail.stem_share) mesh_stem(stem, plant_.parameters, detail.stem, stems(), grown_);
    if (stem.bears_leaves())
      add_leaves(stem, detail);
    else
      add_buds(stem, detail);
    if (grown_.face_count() == before) leave_bud(f);
  }

  const StemFaces& stems() const { return plant_.stems[std::size_t(step_.level_)]; }

  // Where nothing of it is drawn, the triangle stays, a speck that nothing grows on.
  void leave_bud(std::uint32_t f) {
    keep(f);
    FaceOrigin speck = in_.mesh.origins[in_.mesh.face_origins[f]];
    speck.symbol = -1;
    out_.mesh.face_origins[grown_.face_count() - 1] = std::uint32_t(out_.mesh.origins.size());
    out_.mesh.origins.push_back(speck);
  }

  void add_buds(const Stem& stem, const PlantDetail& detail) {
    stem.find_children(children_, detail.child_share);
    for (const StemChild& child : children_) add_bud(child.bud);
  }

  void add_bud(const StemBud& bud) {
    FaceOrigin origin{0, stems().material, step_.bud_symbol(bud.level), stems().production, {}};
    parameters_of(bud, origin);
    grown_.begin_bud(bud.key);
    grown_.set_origin(origin);
    grown_.make_room(3, 1, 3);
    const auto corners = bud_corners(bud.frame);
    const std::array vertices{grown_.add_vertex(corners[0], {}), grown_.add_vertex(corners[1], {}),
                              grown_.add_vertex(corners[2], {})};
    grown_.add_face(vertices, bud.key);
  }

  void add_leaves(const Stem& stem, const PlantDetail& detail) {
    const WeberPennParameters& p = plant_.parameters;
    stem.find_children(leaves_, detail.child_share);
    best_child_kernels().turn_to_light(leaves_.view(), leaves_.size(), p.leaf_bend);
    full_leaf_.set(leaf_shape(p.leaf_shape), detail);
    simple_leaf_.set(simple_leaf_shape(p.leaf_shape), detail);
    full_leaf_.make_room(leaves_.size(), grown_);
    simple_leaf_.make_room(leaves_.size(), grown_);
    // Leaves that stand for several lie around the middle of the one that they grow from
    const double forward = -0.5 * (detail.leaf_length - leaf_length(p));
    for (std::size_t first = 0; first < leaves_.size(); first += ChildRows::group) {
      if (detail.leaf_faces > 0) full_leaf_.place(leaves_.view(), first, forward, step_.quantum_);
      if (detail.leaf_faces < 1) simple_leaf_.place(leaves_.view(), first, forward, step_.quantum_);
      for (std::size_t i = first; i < std::min(first + ChildRows::group, leaves_.size()); ++i) {
        const bool in_full = detail.leaf_faces >= 1 || Draws(leaves_.key(i)).uniform(drawn_in_full) < detail.leaf_faces;
        add_leaf(i, detail, in_full ? full_leaf_ : simple_leaf_);
      }
    }
  }

  void add_leaf(std::size_t leaf, const PlantDetail& detail, const SizedLeaf& shape) {
    grown_.begin_bud(leaves_.key(leaf));
    grown_.set_origin({0,
                       plant_.leaf_material,
                       plant_.leaf_symbol,
                       plant_.leaf_production,
                       {float(leaves_.at(ChildRows::place, leaf)), float(detail.leaf_length)}});
    const std::uint32_t first = grown_.face_count();
    shape.add_to(grown_, leaf);
    if (detail.are_cards) grown_.freeze(first);
  }

  const WeberPennStep& step_;
  const WeberPennPlant& plant_;
  const CellMesh& in_;
  CellMesh& out_;
  PlantMesh grown_;
  std::vector<std::uint32_t> kept_vertices_, kept_origins_;  // by index before: index after
  std::vector<std::uint32_t> face_;
  SizedLeaf full_leaf_, simple_leaf_;
  std::vector<StemChild> children_;
  ChildRows leaves_;
};

void WeberPennStep::apply(const CellMesh& in, int rings_after, CellMesh& out) const {
  Application(*this, in, out).run();
  if (out.owned_faces < out.mesh.face_count()) trim_halo(out, rings_after);
}

std::optional<DerivedBounds> WeberPennStep::derive(const CellMesh& in, std::uint32_t face, int levels) const {
  Derivation derivation(*this, in, level_ + levels - 1);
  derivation.add(bud_of(in, face));
  // The bud itself may remain as a speck; positions are rounded once a level
  const double slack = bud_radius + 1e-9 * derivation.box.diagonal();
  return DerivedBounds{derivation.box.inflated(Vec3d(slack)), plant_->parameters.levels - level_};
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
    const double section = most_section(p, level_, length, reach.radius);
    const double segment = length / p.at(level_).curve_res;
    // A control point may lie beyond the axis by half the distance of rings, over 6; a tip by a fifth of it
    const double child = is_last() ? leaf_reach(p, longest_leaf(p), longest_leaf(p)) : bud_radius;
    const double distance = reach.axis + 0.2 * segment + std::max(2 * section, child);
    const double slack = 2 * quantum_.step() + 1e-9 * (distance + e.box.diagonal());
    Bounds3d box = e.box.inflated(Vec3d(distance + slack));
    if (level_ == 0) {
      // A trunk starts upright: it leans no more than all that it may bend and no further down than it is thick
      const double aside = distance - (1 - std::sin(std::min(trunk_lean(p), pi / 2))) * length;
      const double down = std::cos(std::min(trunk_lean(p), pi)) < 0 ? distance : distance - length;
      box = {e.box.lower - Vec3d{aside, down, aside}, e.box.upper + Vec3d{aside, distance, aside}};
      box = box.inflated(Vec3d(slack));
    }
    after.box.extend(box);
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
