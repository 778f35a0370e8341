#include "procedural/plants/stem_mesh.h"

#include <cmath>

namespace meristem {

namespace {

constexpr std::uint32_t most_sides = 64;
constexpr int most_bend_rings = 6;
constexpr Key ribbon_turn = hash_text("ribbon turn");

// 0 at whole numbers, 1 half way between.
double mirrored_cycle(double x) { return 1 - std::abs(1 - 2 * (x - std::floor(x))); }

double half_ribbon(const Stem& stem, const StemDetail& detail, double radius) {
  return std::min(ribbon_width * detail.widening * radius, widest_ribbon * stem.bud().length);
}

// Vertices of a cross-section by label: label i looks into the direction at i / sides of a turn from the ring's x.
using Ring = std::array<std::uint32_t, most_sides>;

class StemMesher {
 public:
  StemMesher(const Stem& stem, const WeberPennParameters& p, const StemDetail& detail, const StemFaces& faces,
             PlantMesh& out)
      : stem_(stem), p_(p), detail_(detail), faces_(faces), out_(out), n_(detail.sides) {
    cage_ = detail.is_smoothed ? cage_radius(n_) : 1;
    for (std::uint32_t i = 0; i < n_; ++i) {
      const double angle = 2 * pi * i / n_;
      cos_[i] = std::cos(angle);
      sin_[i] = std::sin(angle);
      bulge_[i] = stem.bud().level == 0 && p.lobes > 0 ? 1 + p.lobe_depth * std::sin(p.lobes * angle) : 1;
      u_[i] = mirrored_cycle(2.0 * i / n_);
    }
  }

  void run() {
    const std::uint32_t first = out_.face_count();
    if (detail_.is_ribbon)
      add_ribbons();
    else
      add_tube();
    if (detail_.is_final) out_.freeze(first);
  }

 private:
  void add_tube() {
    const StemPiece& trunk = stem_.pieces().front();
    Ring ring;
    Section root{trunk.nodes[0].frame.origin, trunk.nodes[0].tangent, stem_.bud().frame.x, 0};
    root.x = across(root);
    set_origin(0);
    if (stem_.bud().level == 0) {  // the foot goes on below the ground
      Section foot = root;
      foot.center -= foot.tangent * stem_.flared_radius_at(0);
      ring = add_ring(foot);
      close_root(ring);
      ring = go_on(ring, root);
    } else {
      ring = add_ring(root);
      close_root(ring);
    }
    add_piece(trunk, 0, 0, ring, root);
  }

  // A place on an axis, with the direction of label 0.
  struct Section {
    Vec3d center, tangent, x;
    double z = 0;
  };

  // x at right angles to the tangent.
  static Vec3d across(const Section& s) {
    const Vec3d x = normalize(s.x - s.tangent * dot(s.x, s.tangent));
    if (x != Vec3d{}) return x;
    Vec3d a, b;
    orthonormal_basis(s.tangent, a, b);
    return a;
  }

  // The y of a section goes with its x.
  static Vec3d beside(const Section& s) { return cross(s.tangent, s.x); }
  Vec3d direction(Vec3d x, Vec3d y, std::uint32_t label) const { return x * cos_[label] + y * sin_[label]; }
  Vec3d direction(const Section& s, std::uint32_t label) const { return direction(s.x, beside(s), label); }
  double radius(double z) const {
    return cage_ * detail_.widening * std::max(stem_.flared_radius_at(z), 1e-3 * stem_.bud().radius);
  }
  Vec3d rim(const Section& s, std::uint32_t label, double radius) const {
    return s.center + direction(s, label) * (radius * bulge_[label]);
  }

  // A ribbon lies along the stem, turned about it by chance, and on average covers as much as the stem.
  void add_ribbons() {
    const double z_scale = stem_.segment_length();
    const double turn = 2 * pi * Draws(stem_.bud().key).uniform(ribbon_turn);
    for (const StemPiece& piece : stem_.pieces()) {
      const StemNode &from = piece.nodes.front(), &to = piece.nodes.back();
      const Vec3d across = from.frame.x * std::cos(turn) + from.frame.y * std::sin(turn);
      const double z0 = piece.first_segment * z_scale, z1 = z0 + double(piece.nodes.size() - 1) * z_scale;
      const Vec3d side0 = across * half_ribbon(stem_, detail_, stem_.flared_radius_at(z0));
      set_origin(0.5 * (z0 + z1));
      out_.make_room(4, 1, 4);
      const std::uint32_t a = out_.add_vertex(from.frame.origin - side0, {0, z0});
      const std::uint32_t b = out_.add_vertex(from.frame.origin + side0, {1, z0});
      if (piece.next.empty()) {
        out_.add_face({a, b, out_.add_vertex(to.frame.origin, {0.5, z1})});
        continue;
      }
      const Vec3d side1 = across * half_ribbon(stem_, detail_, stem_.flared_radius_at(z1));
      const std::uint32_t c = out_.add_vertex(to.frame.origin + side1, {1, z1});
      const std::uint32_t d = out_.add_vertex(to.frame.origin - side1, {0, z1});
      out_.add_face({a, b, c, d});
    }
  }

  void set_origin(double z) {
    FaceOrigin origin{0, faces_.material, faces_.symbol, faces_.production, {}};
    origin.parameters[0] = float(stem_.bud().level);
    origin.parameters[1] = float(stem_.radius_at(z));
    origin.parameters[2] = float(stem_.bud().length);
    out_.set_origin(origin);
  }

  Ring add_ring(const Section& s) {
    Ring ring;
    const double r = radius(s.z), v = s.z;
    const Vec3d center = s.center, x = s.x, y = beside(s);
    out_.make_room(n_, 0, 0);
    for (std::uint32_t i = 0; i < n_; ++i)
      ring[i] = out_.add_vertex(center + direction(x, y, i) * (r * bulge_[i]), {u_[i], v});
    return ring;
  }

  void connect(const Ring& a, const Ring& b) {
    out_.make_room(0, n_, 4 * n_);
    for (std::uint32_t i = 0; i < n_; ++i) {
      const std::uint32_t j = i + 1 == n_ ? 0 : i + 1;
      out_.add_face({a[i], a[j], b[j], b[i]});
    }
  }

  Ring go_on(const Ring& from, const Section& to) {
    set_origin(to.z);
    const Ring ring = add_ring(to);
    connect(from, ring);
    return ring;
  }

  void close_root(const Ring& ring) {
    std::array<std::uint32_t, most_sides> face;
    out_.make_room(0, 1, n_);
    for (std::uint32_t i = 0; i < n_; ++i) face[i] = ring[n_ - 1 - i];
    out_.add_face(std::span<const std::uint32_t>(face.data(), n_));
  }

  void close_tip(const Ring& ring, const Section& last, const Section& tip) {
    set_origin(tip.z);
    if (stem_.radius_at(tip.z) > 0.05 * stem_.bud().radius && stem_.level().taper < 1) {
      const Ring end = add_ring(tip);
      connect(ring, end);
      out_.make_room(0, 1, n_);
      return out_.add_face(std::span<const std::uint32_t>(end.data(), n_));
    }
    out_.make_room(1, n_, 3 * n_);
    // Smoothing draws the tip back by about a fifth of the last ring's distance
    const double longer = detail_.is_smoothed ? 0.2 * (tip.z - last.z) : 0;
    const std::uint32_t apex = out_.add_vertex(tip.center + tip.tangent * longer, {0.5, tip.z});
    for (std::uint32_t i = 0; i < n_; ++i) out_.add_face({ring[i], ring[(i + 1) % n_], apex});
  }

  // The section at segment i, t; control points lie a little outside of bends, so that the smooth surface follows the
  // axis. `step`: the distance of rings, in t.
  Section section(const StemPiece& piece, std::size_t i, double t, const Section& before, double step) const {
    Section s{stem_.position(piece, i, t), stem_.tangent(piece, i, t), before.x,
              (double(piece.first_segment) + double(i) + t) * stem_.segment_length()};
    if (detail_.is_smoothed && step > 0) s.center -= second_difference(piece, i, t, step, s) / 6.0;
    s.x = across(s);
    return s;
  }

  Vec3d second_difference(const StemPiece& piece, std::size_t i, double t, double step, const Section& s) const {
    const double along = double(i) + t;
    if (along < step || along + step > double(piece.nodes.size() - 1)) return {};
    const auto at = [&](double a) {
      const std::size_t k = std::min(std::size_t(a), piece.nodes.size() - 2);
      return stem_.position(piece, k, a - double(k));
    };
    Vec3d d = at(along - step) + at(along + step) - s.center * 2.0;
    d -= s.tangent * dot(d, s.tangent);
    const double most = 0.5 * step * stem_.segment_length(), size = length(d);
    return size > most ? d * (most / size) : d;
  }

  // How many rings stand on segment i after t = `from`.
  int ring_count(const StemPiece& piece, std::size_t i, double from, double z0) const {
    const double segment = stem_.segment_length();
    const double width = 2 * pi * stem_.radius_at(z0 + 0.5 * segment) / n_;
    const double long_faces = std::min(segment / std::max(detail_.aspect * width, 1e-9), double(detail_.most_rings));
    const auto count = [&](double turn) {
      const double bends = std::min(to_degrees(turn) / detail_.bend, double(most_bend_rings));
      return std::max(int(std::ceil(std::max(long_faces, bends) * (1 - from) - 1e-9)), 1);
    };
    // An angle is at least its chord c and at most c + (pi - 2) (c / 2)^3; mostly that tells
    const double cosine = std::clamp(dot(piece.nodes[i].tangent, piece.nodes[i + 1].tangent), -1.0, 1.0);
    const double chord = std::sqrt(2 - 2 * cosine);
    const int least = count(chord), most = count(chord + (pi - 2) / 8 * chord * chord * chord);
    return least == most ? least : count(std::acos(cosine));
  }

  // Where they stand: ascending, ending at 1.
  std::span<const double> ring_places(const StemPiece& piece, std::size_t i, double from) {
    const double z0 = (piece.first_segment + double(i)) * stem_.segment_length();
    const int count = ring_count(piece, i, from, z0);
    places_.clear();
    for (int k = 1; k <= count; ++k) places_.push_back(k == count ? 1 : from + (1 - from) * k / count);
    add_special_places(piece, i, from, z0, places_);
    return places_;
  }

  // The flare of a trunk, and ends that are rounder than a cone, need rings of their own.
  void add_special_places(const StemPiece& piece, std::size_t i, double from, double z0,
                          std::vector<double>& places) const {
    const double segment = stem_.segment_length(), total = stem_.bud().length, taper = stem_.level().taper;
    const bool is_tip = piece.next.empty() && i + 2 == piece.nodes.size();
    const auto add = [&](double z) {
      const double t = (z - z0) / segment;
      if (t > from + 0.004 && t < 0.996) places.push_back(t);
    };
    if (stem_.bud().level == 0 && p_.flare > 0 && detail_.has_flare)
      for (double part : {0.012, 0.03, 0.055, 0.085, 0.125}) add(part * total);
    if (taper > 1 && taper <= 2 && is_tip) {
      const double end = stem_.bud().radius * (taper - 1);
      for (double part : {1.0, 0.6, 0.3, 0.1}) add(total - part * end);
    }
    if (taper > 2) {
      const double step = std::max(0.35 * stem_.bud().radius, segment / 40);
      for (double z = z0; z < z0 + segment; z += step) add(z);
    }
    std::sort(places.begin(), places.end());
  }

  // From t = `from` of segment `first` on, where `ring` stands, to the end of the piece and all that follows.
  void add_piece(const StemPiece& piece, std::size_t first, double from, Ring ring, Section last) {
    for (std::size_t i = first; i + 1 < piece.nodes.size(); ++i, from = 0) {
      double t = from;
      for (const double next : ring_places(piece, i, from)) {
        const Section s = section(piece, i, next, last, next - t);
        if (next == 1 && i + 2 == piece.nodes.size() && piece.next.empty()) return close_tip(ring, last, s);
        ring = go_on(ring, s);
        last = s;
        t = next;
      }
    }
    fork(piece.next, 0, ring, last);
  }

  using Pieces = std::vector<int>;
  const StemPiece& piece_of(int index) const { return stem_.pieces()[std::size_t(index)]; }

  // The mean of the axes of a group of pieces on their first segment.
  Section group_section(const Pieces& group, double t, const Section& before) const {
    Section s{{}, {}, before.x, 0};
    for (int index : group) {
      const Section one = section(piece_of(index), 0, t, before, 0);
      s.center += one.center / double(group.size());
      s.tangent += one.tangent;
      s.z = one.z;
    }
    s.tangent = normalize(s.tangent);
    s.x = across(s);
    return s;
  }
  double group_radius(const Pieces& group, double z) const { return radius(z) * (1 + 0.45 * double(group.size() - 1)); }

  // Sets apart the piece that ends furthest from the others.
  static void part(const StemMesher& mesher, const Pieces& group, Pieces& a, Pieces& b) {
    const auto end = [&](int index) { return mesher.stem_.position(mesher.piece_of(index), 0, 1); };
    Vec3d middle;
    for (int index : group) middle += end(index) / double(group.size());
    const int furthest = *std::max_element(group.begin(), group.end(), [&](int i, int j) {
      return length_squared(end(i) - middle) < length_squared(end(j) - middle);
    });
    a = {furthest};
    for (int index : group)
      if (index != furthest) b.push_back(index);
  }

  // Where two groups have parted so far that the crotch is between them, after t = `from`.
  double crotch_place(const Pieces& a, const Pieces& b, double from, const Section& last) const {
    const double nearest = from + 0.2 * (1 - from), furthest = from + 0.7 * (1 - from);
    for (double t = nearest; t < furthest; t += 0.05 * (1 - from)) {
      const Section sa = group_section(a, t, last), sb = group_section(b, t, last);
      if (length(sa.center - sb.center) > 0.8 * (group_radius(a, sa.z) + group_radius(b, sb.z)) / cage_) return t;
    }
    return furthest;
  }

  // `ring` stands at t = `from` on the first segments of these pieces.
  void fork(const Pieces& group, double from, const Ring& ring, const Section& last) {
    if (group.size() == 1) return add_piece(piece_of(group[0]), 0, from, ring, last);
    Pieces a, b;
    part(*this, group, a, b);
    const double t = crotch_place(a, b, from, last);
    const Section sa = group_section(a, t, last), sb = group_section(b, t, last);
    Section middle{(sa.center + sb.center) * 0.5, normalize(sa.tangent + sb.tangent), last.x, sa.z};
    middle.x = across(middle);
    const std::uint32_t start = first_label_towards(middle, sa.center - sb.center);

    set_origin(middle.z);
    const Ring outline = add_outline(sa, group_radius(a, sa.z), sb, group_radius(b, sb.z), middle, start);
    connect(ring, outline);
    Ring ring_a = outline, ring_b = outline;
    const Vec3d begin = edge_of_saddle(sa, sb, middle, start), end = edge_of_saddle(sa, sb, middle, start + n_ / 2);
    const double rise = 0.35 * radius(middle.z);
    out_.make_room(n_ / 2, 0, 0);
    for (std::uint32_t i = 1; i < n_ / 2; ++i) {
      const std::uint32_t label_a = (start + n_ - i) % n_, label_b = (start + i) % n_;
      const double s = 2.0 * i / n_;
      ring_a[label_a] = ring_b[label_b] =
          out_.add_vertex(lerp(begin, end, s) + middle.tangent * (rise * 4 * s * (1 - s)),
                          {0.5 * (u_[label_a] + u_[label_b]), middle.z});
    }
    fork(a, t, ring_a, sa);
    fork(b, t, ring_b, sb);
  }

  // The label at which the half that looks towards `aside` begins.
  std::uint32_t first_label_towards(const Section& s, Vec3d aside) const {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < n_; ++i)
      if (dot(direction(s, i), aside) > dot(direction(s, best), aside) + 1e-9 * length(aside)) best = i;
    return (best + n_ - n_ / 4) % n_;
  }

  // Both ends of the saddle lie between the axes, on the rim.
  Vec3d edge_of_saddle(const Section& a, const Section& b, const Section& middle, std::uint32_t label) const {
    return (rim(a, label % n_, radius(a.z)) + rim(b, label % n_, radius(b.z)) +
            rim(middle, label % n_, radius(middle.z))) /
           3.0;
  }

  Ring add_outline(const Section& a, double radius_a, const Section& b, double radius_b, const Section& middle,
                   std::uint32_t start) {
    Ring ring;
    out_.make_room(n_, 0, 0);
    for (std::uint32_t k = 0; k < n_; ++k) {
      const std::uint32_t label = (start + k) % n_;
      const bool is_edge = k == 0 || k == n_ / 2;
      const Vec3d p = is_edge      ? edge_of_saddle(a, b, middle, label)
                      : k < n_ / 2 ? rim(a, label, radius_a)
                                   : rim(b, label, radius_b);
      ring[label] = out_.add_vertex(p, {u_[label], middle.z});
    }
    return ring;
  }

  const Stem& stem_;
  const WeberPennParameters& p_;
  const StemDetail& detail_;
  const StemFaces& faces_;
  PlantMesh& out_;
  const std::uint32_t n_;
  double cage_ = 1;
  std::vector<double> places_;
  std::array<double, most_sides> cos_, sin_, bulge_, u_;
};

}  // namespace

double cage_radius(std::uint32_t sides) { return 3 / (2 + std::cos(2 * pi / sides)); }

double most_section(const Stem& stem, const WeberPennParameters& p, const StemDetail& detail, double radius) {
  std::size_t stems = 1;
  for (const StemPiece& piece : stem.pieces()) stems = std::max(stems, piece.next.size());
  const double outline =
      cage_radius(4) * (1 + 0.45 * double(stems - 1)) * (stem.bud().level == 0 ? 1 + p.lobe_depth : 1);
  return detail.is_ribbon ? half_ribbon(stem, detail, radius) : outline * detail.widening * radius;
}

double faces_of_segment(const StemDetail& detail) { return detail.sides * (0.5 + 0.5 * detail.most_rings); }

void mesh_stem(const Stem& stem, const WeberPennParameters& p, const StemDetail& detail, const StemFaces& faces,
               PlantMesh& out) {
  StemMesher(stem, p, detail, faces, out).run();
}

}  // namespace meristem
