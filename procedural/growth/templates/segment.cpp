// segment: the next piece of a stem. A prism that goes on from a face with any number of corners, n: n sides and a cap
// which is the face itself, carried along the stem and scaled, bent and twisted. u follows the corners; v grows by the
// length.
#include "procedural/growth/template.h"
#include "procedural/growth/turning.h"

namespace meristem {

namespace {

class Segment : public Template {
 public:
  explicit Segment(TemplateParams& params)
      : length_(params.number("length", "1", {0, 1e6, "m"}, "from the centroid of the face to that of the cap")),
        taper_(params.number("taper", "1", {0, 100, ""}, "size of the cap in sizes of the face")),
        bend_(params.number("bend", "0", {-120, 120, "deg"},
                            "angle between the face's normal and the cap's, before tropism")),
        bend_direction_(params.number("bend_direction", "0", any_angle,
                                      "where it bends to, from the reference edge, counter-clockwise")),
        twist_(params.number("twist", "0", any_angle, "turn of the cap about its normal, counter-clockwise")),
        tropism_(params.number(
            "tropism", "0", {-10, 10, "rad"},
            "how strongly it turns towards \"toward\": by this times the sine of the angle between; negative: away")),
        toward_(params.vector("toward", "[0,1,0]", any_range, "direction of the tropism, in model space")) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const FaceFrame& frame = socket.frame;
    const double reach = socket.scalar(length_), taper = socket.scalar(taper_);
    const Affine3d turn = turn_of(socket);
    // Half way between the old direction and the new one: the chord of the bend
    const Vec3d center = frame.origin + normalize(frame.z + turn.vector(frame.z)) * reach;
    const std::uint32_t n = socket.count();
    for (std::uint32_t i = 0; i < n; ++i) out.add_vertex(center + turn.vector(socket.offset(i)) * taper);
    const Vec2d along{0, reach};
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      out.add_face(side, {i, j, n + j, n + i},
                   {socket.uv[i], socket.uv[j], socket.uv[j] + along, socket.uv[i] + along});
    }
    for (std::uint32_t i = 0; i < n; ++i) out.add_corner(n + i, socket.uv[i] + along);
    out.end_face(cap);
  }

  Reach bound(const SocketRange& range) const override {
    const double reach = range.largest(length_), taper = range.largest(taper_);
    const double cap_radius = taper * range.radius;
    const double side_edge = reach + range.radius + cap_radius;
    Reach r;
    r.distance = reach + cap_radius;
    r.edge = std::max(side_edge, 2 * cap_radius);
    r.face_radius = {std::max({side_edge, 2 * cap_radius, 2 * range.radius}), cap_radius};
    r.u = range.u;
    r.v = {range.v.lower, float(range.v.upper + reach)};
    return r;
  }

 private:
  enum { side, cap };
  static constexpr Range any_angle{-1e6, 1e6, "deg"};

  Affine3d turn_of(const Socket& socket) const {
    const FaceFrame& frame = socket.frame;
    const Vec3d towards = plane_direction(frame, radians(socket.scalar(bend_direction_)));
    const Affine3d bend = lean(frame, towards, radians(socket.scalar(bend_)));
    const Affine3d tropism = tropism_turn(bend.vector(frame.z), socket.vector(toward_), socket.scalar(tropism_));
    const Affine3d turn = tropism * bend;
    const double twist = radians(socket.scalar(twist_));
    return twist == 0 ? turn : Affine3d::rotation(turn.vector(frame.z), twist) * turn;
  }

  std::vector<FaceName> names_{{"side", -1}, {"cap", -1}};
  int length_, taper_, bend_, bend_direction_, twist_, tropism_, toward_;
};

}  // namespace

void register_segment(TemplateRegistry& r) {
  r.add<Segment>("segment", "The next piece of a stem: a prism that may taper, bend and twist");
}

}  // namespace meristem
