#include "procedural/plants/stem.h"

#include "procedural/plants/child_kernels.h"

#include <cmath>

namespace meristem {

namespace {

constexpr Key tree_scale = hash_text("scale"), trunk_length = hash_text("trunk length"),
              trunk_radius = hash_text("trunk radius"), trunk_turn = hash_text("trunk turn"),
              child_length = hash_text("child length"), bend = hash_text("bend"), side_bend = hash_text("side bend"),
              split_phase = hash_text("split phase"), split_lean = hash_text("split lean"),
              split_turn = hash_text("split turn"), split_side = hash_text("split side"), clone = hash_text("clone"),
              child_phase = hash_text("child phase"), child_turn = hash_text("child turn"),
              child_side = hash_text("child side"), child_down = hash_text("child down"), child = hash_text("child"),
              child_order = hash_text("child order"), helix_turn = hash_text("helix turn");

// In scales; where the variation is as large as the scale.
constexpr double smallest_tree = 0.05;
// A helix makes half a turn in a segment of the paper; it is drawn by so many straight pieces for each.
constexpr int helix_steps = 3;
constexpr int most_clones_at_once = 5;
constexpr int most_clones = 200;      // of one stem: a bound on what a scene file can ask for
constexpr double fork_spread = 0.95;  // how far axes move from the middle of a fork of two, in radii
// The lateral move at a fork is at most this part of a segment.
constexpr double steepest_spread = 0.6;

// Stems with a random bend that is a helix's declination have no random bend.
double random_bend(const PlantLevel& level) { return std::max(level.curve_v, 0.0); }

double spread_at_fork(double radius, double segment, std::size_t stems) {
  return std::min(fork_spread * radius / std::sin(pi / double(stems)), steepest_spread * segment);
}

// The rank of child j of a piece: multiples of the golden ratio spread evenly however many are taken.
double rank_of(double phase, std::uint64_t j) {
  constexpr double golden = 0.6180339887498949;
  const double x = phase + double(j) * golden;
  return x - std::floor(x);
}

}  // namespace

StemBud trunk_bud(const WeberPennParameters& p, const Affine3d& frame, Key key) {
  const Draws draws(key);
  StemBud bud;
  bud.key = key;
  bud.frame = frame;
  turn_about_z(bud.frame, 2 * pi * draws.uniform(trunk_turn));
  bud.scale = std::max(p.scale + draws.spread(p.scale_v, tree_scale), smallest_tree * p.scale);
  bud.length = bud.scale * (p.level[0].length + draws.spread(p.level[0].length_v, trunk_length));
  bud.radius = bud.length * p.ratio * (p.trunk_scale + draws.spread(p.trunk_scale_v, trunk_radius));
  bud.children = p.levels == 1 ? p.leaves * p.quality : p.level[1].branches;
  return bud;
}

// A growing end.
struct Stem::Path {
  Affine3d frame;         // at the joint before `segment`, z along it
  int segment = 0;        // the one that follows
  Vec3d first_end;        // where that one ends
  double correction = 0;  // radians a segment, taking the lean of splits back
  double split_rate = 0, split_sum = 0;
  double share = 1;
  Key key = 0;
};

Stem::Stem(const WeberPennParameters& p, const StemBud& bud)
    : p_(p), bud_(bud), level_(p.at(bud.level)), child_level_(p.at(bud.level + 1)), draws_(bud.key) {
  segments_ = int(level_.curve_res) * (is_helix() ? helix_steps : 1);
  child_length_max_ = child_level_.length + draws_.spread(child_level_.length_v, child_length);
  if (bud_.level > 0 && p_.prune_ratio > 0)
    fit_to_envelope();
  else
    grow_all();
}

void Stem::grow_all() {
  segment_ = bud_.length / segments_;
  bare_ = bud_.level == 0 ? std::min(p_.base_size * bud_.scale, 0.95 * bud_.length)
                          : std::min(bud_.inset, 0.3 * bud_.length);
  pieces_.clear();
  clones_ = 0;
  Path path{bud_.frame, 0, {}, 0, is_helix() ? 0 : level_.seg_splits, draws_.uniform(split_phase), 1, bud_.key};
  if (is_helix()) {
    helix_axis_ = bud_.frame.z;
    const double angle = 2 * pi * draws_.uniform(helix_turn);
    const Vec3d hinge = bud_.frame.x * std::cos(angle) + bud_.frame.y * std::sin(angle);
    turn_about(path.frame, hinge, to_radians(-level_.curve_v));
  }
  path.first_end = path.frame.origin + path.frame.z * segment_;
  grow(path);
  find_tangents(0, bud_.frame.z);
}

// Shortens the stem until it lies inside the crown's envelope (section 4.6); stems that never fit keep a stump.
void Stem::fit_to_envelope() {
  constexpr double shortening = 0.9, stump = 0.15;
  const double wanted = bud_.length;
  for (grow_all(); !fits() && bud_.length > stump * wanted; grow_all()) bud_.length *= shortening;
  bud_.length = wanted + p_.prune_ratio * (bud_.length - wanted);
  grow_all();
}

bool Stem::fits() const {
  for (const StemPiece& piece : pieces_)
    for (const StemNode& node : piece.nodes) {
      const Vec3d o = node.frame.origin;
      const double ratio = (bud_.scale - o.y) / (bud_.scale * (1 - p_.base_size));
      if (std::hypot(o.x, o.z) > bud_.scale * p_.prune_width * prune_shape_ratio(p_, ratio)) return false;
    }
  return true;
}

int Stem::grow(Path path) {
  const int index = int(pieces_.size());
  pieces_.push_back({path.segment, {}, {}, path.share, path.key});
  pieces_.back().nodes.reserve(std::size_t(segments_ - path.segment) + 1);
  pieces_.back().nodes.push_back({path.frame, {}});
  path.frame.origin = path.first_end;
  for (int i = path.segment; i + 1 < segments_; ++i) {
    if (const int clones = clones_after(path, i); clones > 0) {
      pieces_[std::size_t(index)].nodes.push_back({path.frame, {}});
      for (const Path& next : split(path, i + 1, clones)) {
        const int child_piece = grow(next);
        pieces_[std::size_t(index)].next.push_back(child_piece);
      }
      return index;
    }
    advance(path, i + 1);
    pieces_[std::size_t(index)].nodes.push_back({path.frame, {}});
    path.frame.origin += path.frame.z * segment_;
  }
  pieces_[std::size_t(index)].nodes.push_back({path.frame, {}});
  return index;
}

// Turns the frame from the segment before to this one (section 4.1).
void Stem::advance(Path& path, int segment) const {
  if (is_helix()) return turn_about(path.frame, helix_axis_, pi / helix_steps);
  const double res = level_.curve_res;
  const Draws draws(path.key);
  double angle = level_.curve / res;
  if (level_.curve_back != 0) angle = (segment < res / 2 ? level_.curve : level_.curve_back) / (res / 2);
  angle = to_radians(angle + draws.spread(random_bend(level_) / res, bend, Key(segment))) + path.correction;
  if (bud_.level >= 2) angle -= p_.attraction_up * declination(path.frame.z) * dot(path.frame.y, plant_up) / segments_;
  turn_about_x(path.frame, angle);
  turn_about_y(path.frame, to_radians(draws.spread(level_.bend_v / res, side_bend, Key(segment))));
}

int Stem::clones_after(Path& path, int segment) {
  path.split_sum += path.split_rate;
  int clones = int(std::floor(path.split_sum));
  path.split_sum -= clones;
  if (bud_.level == 0 && segment == 0 && p_.base_splits > 0) clones = p_.base_splits;
  clones = std::min({clones, most_clones_at_once, most_clones - clones_});
  clones_ += clones;
  return clones;
}

// The stem and its clones after a fork (section 4.2); each leans away from the direction before, and clones turn about
// the vertical: one clone and the stem by a random angle between them, several evenly.
std::vector<Stem::Path> Stem::split(const Path& path, int segment, int clones) const {
  const Draws draws(path.key);
  const double decl = to_degrees(declination(path.frame.z));
  const double lean =
      std::max(0.0, level_.split_angle + draws.spread(level_.split_angle_v, split_lean, Key(segment)) - decl);
  const double u = draws.uniform(split_turn, Key(segment));
  const double between = 20 + 0.75 * (30 + std::abs(decl - 90)) * u * u;
  const double side = draws.uniform(split_side, Key(segment)) < 0.5 ? -1 : 1;
  const int remaining = segments_ - 1 - segment;
  std::vector<Path> paths;
  for (int j = 0; j <= clones; ++j) {
    Path next = path;
    next.segment = segment;
    turn_about_x(next.frame, to_radians(lean));
    const double turn = clones == 1 ? side * between * (j - 0.5) : 360.0 * j / (clones + 1);
    turn_about_up(next.frame, to_radians(turn));
    if (remaining > 0) next.correction -= to_radians(lean) / remaining;
    next.split_rate *= 0.5;
    next.share /= clones + 1;
    if (j > 0) {
      next.key = hash_keys(path.key, clone, Key(segment), Key(j));
      next.split_sum = Draws(next.key).uniform(split_phase);
    }
    advance(next, segment);
    next.first_end = next.frame.origin + next.frame.z * segment_;
    paths.push_back(next);
  }
  move_apart(paths, segment);
  return paths;
}

void Stem::move_apart(std::vector<Path>& paths, int segment) const {
  const double wanted = spread_at_fork(radius_at(segment * segment_), segment_, paths.size());
  Vec3d middle;
  for (const Path& p : paths) middle += p.first_end / double(paths.size());
  for (std::size_t j = 0; j < paths.size(); ++j) {
    Vec3d aside = paths[j].first_end - middle;
    const double distance = length(aside);
    if (distance >= wanted) continue;
    if (distance < 1e-3 * wanted) {
      const double angle = 2 * pi * double(j) / double(paths.size());
      aside = paths[0].frame.x * std::cos(angle) + paths[0].frame.y * std::sin(angle);
    }
    paths[j].first_end = middle + normalize(aside) * wanted;
  }
}

void Stem::find_tangents(int index, Vec3d before) {
  StemPiece& piece = pieces_[std::size_t(index)];
  const std::size_t last = piece.nodes.size() - 1;
  const auto chord = [&](std::size_t i) {
    return normalize(piece.nodes[i + 1].frame.origin - piece.nodes[i].frame.origin);
  };
  piece.nodes[0].tangent = index == 0 ? before : normalize(before + chord(0));
  for (std::size_t i = 1; i < last; ++i) piece.nodes[i].tangent = normalize(chord(i - 1) + chord(i));
  const Vec3d end = chord(last - 1);
  piece.nodes[last].tangent = end;
  for (int next : piece.next) find_tangents(next, end);
}

// A cubic of Hermite through the joints, so that stems have no kinks.
Vec3d Stem::position(const StemPiece& piece, std::size_t i, double t) const {
  const StemNode &a = piece.nodes[i], &b = piece.nodes[i + 1];
  const double s = 1 - t, h = length(b.frame.origin - a.frame.origin) / 3;
  return a.frame.origin * (s * s * (1 + 2 * t)) + b.frame.origin * (t * t * (3 - 2 * t)) +
         a.tangent * (3 * h * s * s * t) - b.tangent * (3 * h * s * t * t);
}

Vec3d Stem::tangent(const StemPiece& piece, std::size_t i, double t) const {
  const StemNode &a = piece.nodes[i], &b = piece.nodes[i + 1];
  const double s = 1 - t;
  const Vec3d chord = b.frame.origin - a.frame.origin;
  const Vec3d d =
      chord * (6 * s * t) + (a.tangent * (s * s - 2 * s * t) + b.tangent * (t * t - 2 * s * t)) * length(chord);
  const Vec3d direction = normalize(d);
  return direction == Vec3d{} ? normalize(chord) : direction;
}

double Stem::radius_at(double z) const {
  return tapered_radius(level_.taper, bud_.length, bud_.radius, std::clamp(z / bud_.length, 0.0, 1.0));
}

double Stem::flared_radius_at(double z) const {
  const double r = radius_at(z);
  if (bud_.level > 0) return r;
  const double y = std::clamp(1 - 8 * z / bud_.length, 0.0, 1.0);
  return r * (1 + p_.flare * (std::pow(100, y) - 1) / 100);
}

// Away from the stem, in degrees.
double Stem::down_angle(Key child, double place) const {
  const double down = child_level_.down_angle, v = child_level_.down_angle_v;
  return down + (v >= 0 ? Draws(child).spread(v, child_down) : v * (1 - 2 * shape_ratio(0, 1 - place)));
}

void Stem::add_child(Key key, double z, double place, double around, double away, ChildRows& out) const {
  const std::size_t i = out.add(key);
  const ChildRows::View rows = out.view();
  rows[ChildRows::along][i] = z;
  rows[ChildRows::place][i] = place;
  rows[ChildRows::around][i] = to_radians(around);
  rows[ChildRows::away][i] = to_radians(away);
}

void Stem::add_row(const StemPiece& piece, double share, ChildRows& out) const {
  const double first = std::max(piece.first_segment * segment_, bare_);
  const double last = (piece.first_segment + double(piece.nodes.size()) - 1) * segment_;
  const double density = bud_.children * piece.share / (bud_.length - bare_);
  const Draws draws(hash_keys(piece.key, Key(piece.first_segment))), turns = draws.of(child_turn);
  const double phase = draws.uniform(child_phase), order = draws.uniform(child_order);
  const auto count = std::uint64_t(std::max(std::floor((last - first) * density + phase), 0.0));
  const KeysFrom keys(hash_keys(piece.key, child, Key(piece.first_segment)));
  double angle = 360 * draws.uniform(child_turn);
  const std::uint64_t side = draws.uniform(child_side) < 0.5;
  out.make_room(count);
  for (std::uint64_t j = 0; j < count; ++j) {
    const double turn = child_level_.rotate + turns.spread(child_level_.rotate_v, j);
    angle = turn >= 0 && child_level_.rotate >= 0 ? angle + turn : ((j + side) % 2 ? 1 : -1) * (180 + turn);
    if (rank_of(order, j) >= share) continue;
    const double z = std::min(first + (double(j) + 1 - phase) / density, last), place = place_at(z);
    add_child(keys(j), z, place, angle, down_angle(keys(j), place), out);
  }
}

// All at the tip, spread evenly over `rotate` to both sides.
void Stem::add_fan(const StemPiece& piece, double share, ChildRows& out) const {
  if (!piece.next.empty()) return;
  const Draws draws(hash_keys(piece.key, Key(piece.first_segment)));
  const auto count = std::uint64_t(-bud_.children * piece.share + draws.uniform(child_phase));
  const double order = draws.uniform(child_order);
  const KeysFrom keys(hash_keys(piece.key, child, Key(piece.first_segment)));
  out.make_room(count);
  for (std::uint64_t j = 0; j < count; ++j)
    if (rank_of(order, j) < share)
      add_child(keys(j), bud_.length, place_at(bud_.length), 0,
                child_level_.rotate * ((double(j) + 0.5) / double(count) - 0.5), out);
}

// The children from `first` on, which lie on this piece in order.
void Stem::put_on_axis(const StemPiece& piece, std::size_t first, ChildRows& out) const {
  const ChildRows::View rows = out.view();
  const std::size_t segments = piece.nodes.size() - 1;
  for (std::size_t begin = first, end = first; begin < out.size(); begin = end) {
    std::size_t segment = 0;
    for (; end < out.size(); ++end) {
      const double along =
          std::clamp(rows[ChildRows::along][end] / segment_ - piece.first_segment, 0.0, double(segments));
      const std::size_t i = std::min(std::size_t(along), segments - 1);
      if (end > begin && i != segment) break;
      segment = i;
      rows[ChildRows::part][end] = along - double(i);
    }
    best_child_kernels().put_on_axis(piece.nodes[segment], piece.nodes[segment + 1], rows, begin, end);
  }
}

void Stem::find_children(ChildRows& out, double share) const {
  out.clear();
  for (const StemPiece& piece : pieces_) {
    const std::size_t first = out.size();
    if (bud_.children > 0)
      add_row(piece, share, out);
    else
      add_fan(piece, share, out);
    put_on_axis(piece, first, out);
  }
  best_child_kernels().turn_away(out.view(), out.size());
}

// What a child inherits (section 4.3).
StemChild Stem::described(const ChildRows& children, std::size_t i) const {
  const double z = children.at(ChildRows::along, i), place = children.at(ChildRows::place, i);
  StemBud bud{bud_.level + 1, children.key(i), children.frame(i), leaf_length(p_), 0, 0, 0, bud_.scale};
  if (bears_leaves()) return {bud, place};
  bud.inset = radius_at(z) / std::max(std::abs(std::sin(to_radians(down_angle(bud.key, place)))), 0.3);
  const double ratio = bud_.level == 0 ? crown_shape_ratio(p_, 1 - place) : 1 - 0.6 * z / bud_.length;
  bud.length = bud_.length * child_length_max_ * ratio;
  bud.radius = std::min(bud_.radius * std::pow(bud.length / bud_.length, p_.ratio_power), radius_at(z));
  if (bud.level + 1 >= p_.levels)
    bud.children = p_.leaves * p_.quality * shape_ratio(4, place);
  else if (bud.level == 1)
    bud.children = p_.at(2).branches * (0.2 + 0.8 * ratio);
  else
    bud.children = p_.at(bud.level + 1).branches * (1 - 0.5 * place);
  return {bud, place};
}

void Stem::find_children(std::vector<StemChild>& out, double share) const {
  ChildRows children;
  find_children(children, share);
  out.clear();
  for (std::size_t i = 0; i < children.size(); ++i) {
    StemChild child = described(children, i);
    if (bears_leaves() || child.bud.length >= 1e-4 * bud_.length) out.push_back(child);
  }
}

StemReach stem_reach(const WeberPennParameters& p, int n, double length, double radius) {
  const PlantLevel& level = p.at(n);
  const double segment = length / level.curve_res;
  double spread =
      level.seg_splits > 0 ? (level.curve_res - 1) * spread_at_fork(radius, segment, most_clones_at_once + 1) : 0;
  if (n == 0 && p.base_splits > 0) spread += spread_at_fork(radius, segment, std::size_t(p.base_splits) + 1);
  const PlantLevel& next = p.at(n + 1);
  const double longest_child = (next.length + next.length_v) * length;
  const double count = std::abs(n + 1 >= p.levels ? p.leaves * p.quality : next.branches);
  return {length + spread, n == 0 ? radius * (1 + p.flare) : radius, n + 1 >= p.levels ? leaf_length(p) : longest_child,
          count};
}

double longest_trunk(const WeberPennParameters& p) {
  return (p.scale + p.scale_v) * (p.level[0].length + p.level[0].length_v);
}

double thickest_trunk(const WeberPennParameters& p) {
  return longest_trunk(p) * p.ratio * (p.trunk_scale + p.trunk_scale_v);
}

double expected_segments(const WeberPennParameters& p, int n) {
  const PlantLevel& level = p.at(n);
  double stems = 1, segments = 0, rate = level.curve_v < 0 ? 0 : level.seg_splits;
  for (int i = 0; i < int(level.curve_res) && stems < most_clones; ++i) {
    segments += stems;
    if (n == 0 && i == 0) stems *= 1 + p.base_splits;
    stems *= 1 + rate;
    rate /= 1 + rate;
  }
  return segments * (level.curve_v < 0 ? helix_steps : 1);
}

double expected_children(const WeberPennParameters& p, int n) {
  return std::abs(n + 1 >= p.levels ? p.leaves * p.quality : p.at(n + 1).branches);
}

}  // namespace meristem
