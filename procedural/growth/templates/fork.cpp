// fork: one stem becomes two (the paper's figures 8, 9 and 10). The face's corners, an even number n, are halved by a
// line across; between its ends a chain of new vertices rises to the saddle of the crotch. Each half of the corners
// together with the chain makes a ring of n again, on which a branch stands whose cap is the replaced face itself,
// scaled and turned outwards. So a branch can go on with segments and forks like the stem.
//
// u: each branch takes over all n values of the stem in their order, beginning at its half, so with the two mirrored
// cycles 0 .5 1 .5 0 .5 1 .5 of the paper every corner of the stem agrees with its branch, and each branch has two
// mirrored cycles. On the chain the left branch sees the values on one side of the line, the right one those on the
// other:
// - halved at corners where u mirrors itself (u = 0 or 1), they agree everywhere (the default picks such a line);
// - halved at other corners (u = .5), two vertices of the chain average 0 and 1;
// - halved at edges, they average (0+.5)/2 and (.5+1)/2: the values of the paper's figure 9.
//
// Halved at corners all faces but the caps are quadrilaterals, and the only irregular vertices are the two ends of the
// line (six edges). Halved at edges a triangle closes each end, and six vertices have five edges.
#include "procedural/growth/template.h"
#include "procedural/growth/turning.h"

#include <fmt/format.h>

namespace meristem {

namespace {

class Fork : public Template {
 public:
  explicit Fork(TemplateParams& params)
      : length_(params.number("length", "1", {0, 1e6, "m"}, "of both branches")),
        angle_(params.number("angle", "40", {0, 170, "deg"}, "between the branches")),
        balance_(params.number("balance", "0.5", unit_range,
                               "share of the angle by which the left branch leaves the stem's direction; 0: the left "
                               "one goes straight on")),
        left_radius_(params.number("left_radius", "0.75", {0, 10, ""}, "size of the left cap in sizes of the face")),
        right_radius_(params.number("right_radius", "0.75", {0, 10, ""}, "size of the right cap in sizes of the face")),
        saddle_(params.number("saddle", "0.4", unit_range, "height of the crotch in lengths of the branches")),
        roll_(params.number("roll", "0", {-1e6, 1e6, "deg"},
                            "direction of the left branch, from the reference edge, counter-clockwise; taken by the "
                            "nearest line across that suits u")),
        split_(params.number(
            "split", "-1", {-1, 1e6, ""},
            "corner (or edge) at which the line across begins, the left branch behind it; -1: chosen by roll")),
        twist_(
            params.number("twist", "0", {-1e6, 1e6, "deg"}, "turn of the caps about their normals, counter-clockwise")),
        tropism_(params.number("tropism", "0", {-10, 10, "rad"},
                               "how strongly the branches turn towards \"toward\": by this times the sine of the angle "
                               "between; negative: away")),
        toward_(params.vector("toward", "[0,1,0]", any_range, "direction of the tropism, in model space")),
        at_edges_(params.plain().choice("halve", 0, {"corners", "edges"},
                                        "whether the line across runs from corner to corner or from the middle of an "
                                        "edge to that of the opposite one") == 1) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  std::string refusal(std::uint32_t corners) const override {
    return corners >= 4 && corners % 2 == 0
               ? ""
               : fmt::format("a fork needs a face with an even number of corners, at least 4; this one has {}",
                             corners);
  }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const Halves halves = halve(socket);
    add_chain(socket, halves, out);
    add_branch(socket, halves, left, out);
    add_branch(socket, halves, right, out);
    if (at_edges_) add_ends(socket, halves, out);
  }

  Reach bound(const SocketRange& range) const override {
    const double reach = range.largest(length_);
    const double left_cap = range.largest(left_radius_) * range.radius,
                 right_cap = range.largest(right_radius_) * range.radius;
    const double cap = std::max(left_cap, right_cap);
    const double rise = range.largest(saddle_) * reach;
    Reach r;
    r.distance = std::max(reach + largest_shift(range.radius, cap) + cap, range.radius + rise);
    r.edge = r.distance + range.radius + rise;
    const double any = std::max({r.edge, 2 * cap, 2 * range.radius});
    r.face_radius = {left_cap, right_cap, any, any};
    r.u = range.u;
    r.v = {range.v.lower, float(range.v.upper + reach)};
    return r;
  }

 private:
  enum Name { left, right, side, crotch };

  // How the corners are shared out. The chain's vertex i, counted from 1 at the line's beginning, is vertex n + i - 1.
  struct Halves {
    std::uint32_t n, start;  // corners; the corner (or edge) where the line begins
    std::uint32_t chain;     // number of vertices in between
    Vec3d begin, end;        // of the line
    Vec3d to_left;           // unit, across the line
  };

  std::uint32_t chain_length(std::uint32_t n) const { return at_edges_ ? n / 2 : n / 2 - 1; }

  // The corner whose u, v a branch gives to the chain's vertex i.
  std::uint32_t left_twin(std::uint32_t n, std::uint32_t start, std::uint32_t i) const {
    return (start + (at_edges_ ? 1 : 0) + n - i) % n;
  }
  std::uint32_t right_twin(std::uint32_t n, std::uint32_t start, std::uint32_t i) const { return (start + i) % n; }

  // How much u disagrees along the chain.
  double conflict(const Socket& socket, std::uint32_t start) const {
    const std::uint32_t n = socket.count();
    double sum = 0;
    for (std::uint32_t i = 1; i <= chain_length(n); ++i)
      sum += std::abs(socket.uv[left_twin(n, start, i)].x - socket.uv[right_twin(n, start, i)].x);
    return sum;
  }

  Halves halves_at(const Socket& socket, std::uint32_t start) const {
    const std::uint32_t n = socket.count();
    const auto end_of_line = [&](std::uint32_t i) {
      const Vec3d corner = socket.corners[i % n];
      return at_edges_ ? (corner + socket.corners[(i + 1) % n]) * 0.5 : corner;
    };
    const Vec3d begin = end_of_line(start), end = end_of_line(start + n / 2);
    return {n, start, chain_length(n), begin, end, normalize(cross(end - begin, socket.frame.z))};
  }

  // The line asked for; else, among those along which u disagrees least, the one that points the left branch nearest to
  // the roll. Ties go to the lowest corner.
  Halves halve(const Socket& socket) const {
    const double split = socket.scalar(split_);
    if (split >= 0) return halves_at(socket, std::uint32_t(split) % socket.count());
    const Vec3d wanted = plane_direction(socket.frame, radians(socket.scalar(roll_)));
    constexpr double tolerance = 1e-6;  // of rounding, in u and in the cosine
    Halves best = halves_at(socket, 0);
    double best_conflict = conflict(socket, 0);
    for (std::uint32_t start = 1; start < socket.count(); ++start) {
      const Halves h = halves_at(socket, start);
      const double c = conflict(socket, start);
      const bool nearer = dot(h.to_left, wanted) > dot(best.to_left, wanted) + tolerance;
      if (c > best_conflict + tolerance || (c > best_conflict - tolerance && !nearer)) continue;
      best = h;
      best_conflict = c;
    }
    return best;
  }

  // The arch of the saddle over the line, highest in its middle.
  double rise(const Socket& socket, const Halves& h, std::uint32_t i) const {
    const double t = double(i) / (h.chain + 1);
    return socket.scalar(saddle_) * socket.scalar(length_) * 4 * t * (1 - t);
  }

  void add_chain(const Socket& socket, const Halves& h, NamedFaces& out) const {
    for (std::uint32_t i = 1; i <= h.chain; ++i)
      out.add_vertex(lerp(h.begin, h.end, double(i) / (h.chain + 1)) + socket.frame.z * rise(socket, h, i));
  }

  // Branches stand beside each other: their axes start half a radius off the stem's, and further if the caps would
  // touch.
  static constexpr double clearance = 1.1;
  static double shift(double radius, double cap, double aside) {
    return std::clamp(clearance * cap - aside, 0.5 * radius, largest_shift(radius, cap));
  }
  static double largest_shift(double radius, double cap) { return 0.5 * radius + clearance * cap; }

  // Vertex j of the ring on which a branch stands; the ring runs counter-clockwise seen from its cap and begins at the
  // first of the branch's own corners.
  struct Ring {
    std::uint32_t first_corner, own_corners;
  };
  Ring ring_of(const Halves& h, Name branch) const {
    const std::uint32_t skipped = at_edges_ ? 1 : 0;
    return {h.start + skipped + (branch == right ? h.n / 2 : 0), h.n - h.chain};
  }
  static std::uint32_t ring_vertex(const Halves& h, const Ring& ring, Name branch, std::uint32_t j) {
    if (j < ring.own_corners) return (ring.first_corner + j) % h.n;
    const std::uint32_t k = j - ring.own_corners;
    return h.n + (branch == left ? h.chain - 1 - k : k);
  }

  void add_branch(const Socket& socket, const Halves& h, Name branch, NamedFaces& out) const {
    const Affine3d turn = turn_of(socket, h, branch);
    const std::uint32_t first = add_cap_vertices(socket, h, branch, turn, out);
    const Ring ring = ring_of(h, branch);
    const Vec2d along{0, socket.scalar(length_)};
    for (std::uint32_t j = 0; j < h.n; ++j) {
      const std::uint32_t k = (j + 1) % h.n;
      const std::uint32_t a = ring_vertex(h, ring, branch, j), b = ring_vertex(h, ring, branch, k);
      const std::uint32_t twin_a = (ring.first_corner + j) % h.n, twin_b = (ring.first_corner + k) % h.n;
      out.add_face(side, {a, b, first + twin_b, first + twin_a},
                   {ring_uv(socket, h, a, twin_a), ring_uv(socket, h, b, twin_b), socket.uv[twin_b] + along,
                    socket.uv[twin_a] + along});
    }
    for (std::uint32_t i = 0; i < h.n; ++i) out.add_corner(first + i, socket.uv[i] + along);
    out.end_face(branch);
  }

  // Below a branch, a vertex of the chain has the u, v of the corner that the ring has there, raised with the saddle.
  Vec2d ring_uv(const Socket& socket, const Halves& h, std::uint32_t vertex, std::uint32_t twin) const {
    return vertex < h.n ? socket.uv[vertex] : socket.uv[twin] + Vec2d{0, rise(socket, h, vertex - h.n + 1)};
  }

  Affine3d turn_of(const Socket& socket, const Halves& h, Name branch) const {
    const FaceFrame& frame = socket.frame;
    const double share = branch == left ? socket.scalar(balance_) : 1 - socket.scalar(balance_);
    const Affine3d apart = lean(frame, branch == left ? h.to_left : -h.to_left, radians(socket.scalar(angle_)) * share);
    const Affine3d tropism = tropism_turn(apart.vector(frame.z), socket.vector(toward_), socket.scalar(tropism_));
    const Affine3d turn = tropism * apart;
    const double twist = radians(socket.scalar(twist_));
    return twist == 0 ? turn : Affine3d::rotation(turn.vector(frame.z), twist) * turn;
  }

  // A copy of the face: its corner i is the cap's corner i, so the cap's frame is the face's frame under the turn.
  std::uint32_t add_cap_vertices(const Socket& socket, const Halves& h, Name branch, const Affine3d& turn,
                                 NamedFaces& out) const {
    const FaceFrame& frame = socket.frame;
    const double size = socket.scalar(branch == left ? left_radius_ : right_radius_);
    const Vec3d outwards = branch == left ? h.to_left : -h.to_left;
    const Vec3d along = turn.vector(frame.z) * socket.scalar(length_);
    const Vec3d center =
        frame.origin + along + outwards * shift(frame.radius, size * frame.radius, dot(along, outwards));
    const std::uint32_t first = out.vertex_count();
    for (std::uint32_t i = 0; i < h.n; ++i) out.add_vertex(center + turn.vector(socket.offset(i)) * size);
    return first;
  }

  // Halved at edges: the triangles between an end of the line and the chain.
  void add_ends(const Socket& socket, const Halves& h, NamedFaces& out) const {
    for (const bool far : {false, true}) {
      const std::uint32_t a = (h.start + (far ? h.n / 2 : 0)) % h.n, b = (a + 1) % h.n;
      const std::uint32_t i = far ? h.chain : 1;
      const Vec2d mean = (socket.uv[left_twin(h.n, h.start, i)] + socket.uv[right_twin(h.n, h.start, i)]) * 0.5;
      out.add_face(crotch, {a, b, h.n + i - 1}, {socket.uv[a], socket.uv[b], mean + Vec2d{0, rise(socket, h, i)}});
    }
  }

  std::vector<FaceName> names_{{"left", -1}, {"right", -1}, {"side", -1}, {"crotch", side}};
  int length_, angle_, balance_, left_radius_, right_radius_, saddle_, roll_, split_, twist_, tropism_, toward_;
  bool at_edges_;
};

}  // namespace

void register_fork(TemplateRegistry& r) {
  r.add<Fork>("fork", "A stem divides into two branches, and the ridges of its bark with it");
}

}  // namespace meristem
