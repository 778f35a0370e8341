// leaf: a stalk that narrows from the face, and a blade: a sheet of two halves along a midrib. The sheet hangs on the
// upper half of the stalk's end, whose lower half stays open; so the mesh has a border, which runs around the blade.
// One sheet, because light that shines through a closed leaf would have to cross two surfaces, and no shadow ray does.
//
// The upper side looks away from the face's reference edge; on a side of a stem that is where the stem goes to. u runs
// over the blade from its left rim to its right one, v from its foot to its tip.
#include "procedural/growth/template.h"
#include "procedural/growth/turning.h"

#include <fmt/format.h>

namespace meristem {

namespace {

class Leaf : public Template {
 public:
  explicit Leaf(TemplateParams& params)
      : length_(params.number("length", "1", {0, 1e6, "m"}, "of the blade, along its midrib")),
        width_(params.number("width", "0.5", {0, 1e6, "m"}, "of the blade where it is widest")),
        widest_(params.number("widest", "0.4", {0.05, 0.95, ""}, "where it is widest: 0 the foot, 1 the tip")),
        stalk_(params.number("stalk", "0.1", {0, 1e6, "m"}, "length of the stalk")),
        stalk_radius_(params.number("stalk_radius", "0.01", {0, 1e6, "m"},
                                    "of the stalk where the blade begins; not given: a fiftieth of the width")),
        thin_stalk_(!params.plain().has("stalk_radius")),
        bend_(params.number("bend", "45", {-180, 180, "deg"}, "angle between the face's normal and the leaf")),
        bend_direction_(params.number("bend_direction", "180", any_angle,
                                      "where it leans to, from the reference edge, counter-clockwise")),
        fold_(params.number("fold", "15", {-90, 90, "deg"}, "by which both halves of the blade are raised")),
        droop_(params.number("droop", "30", {-360, 360, "deg"}, "by which the blade curves down towards its tip")),
        facing_(params.number("facing", "0", unit_range,
                              "how far the leaf turns about its stalk so that the upper side sees \"toward\"")),
        toward_(params.vector("toward", "[0,1,0]", any_range, "direction of the light, in model space")),
        sections_(std::uint32_t(params.plain().integer("sections", 4, {1, 16, ""}, "cross-sections of the blade"))) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  std::string refusal(std::uint32_t corners) const override {
    return corners == 4 ? "" : fmt::format("a leaf needs a face with 4 corners; this one has {}", corners);
  }

  void grow(const Socket& socket, NamedFaces& out) const override {
    add_vertices(socket, out);
    add_stalk(socket, out);
    for (std::uint32_t section = 0; section < sections_; ++section) add_band(section, out);
    add_tip(out);
  }

  Reach bound(const SocketRange& range) const override {
    const double length = range.largest(length_), half_width = range.largest(width_) / 2;
    const double stem = range.largest(stalk_), foot = stalk_radius([&](int slot) { return range.largest(slot); });
    const double section = std::max(half_width, foot);
    const double widest = std::max({2 * range.radius, range.radius + stem + foot, length + 2 * section});
    Reach r;
    r.distance = stem + length + section;
    r.edge = widest;
    r.face_radius.assign(names_.size(), widest);
    r.u = {std::min(range.u.lower, 0.f), std::max(range.u.upper, 1.f)};
    r.v = {std::min(range.v.lower, 0.f), std::max(range.v.upper, 1.f)};
    return r;
  }

 private:
  enum { blade, stalk };
  static constexpr Range any_angle{-1e6, 1e6, "deg"};
  static constexpr std::uint32_t ring = 4;  // corners of the stalk: below, left, above, right
  static constexpr double ring_u[ring] = {0.5, 0, 0.5, 1};

  // At the foot of the blade: along the leaf, to its left, out of its upper side.
  struct Axes {
    Vec3d along, left, up;
  };

  Axes axes(const Socket& socket) const {
    const FaceFrame& frame = socket.frame;
    const Vec3d towards = plane_direction(frame, radians(socket.scalar(bend_direction_)));
    const Affine3d turn = lean(frame, towards, radians(socket.scalar(bend_)));
    const Vec3d along = turn.vector(frame.z), up = turn.vector(-frame.x);
    const Vec3d wanted = socket.vector(toward_) - along * dot(socket.vector(toward_), along);
    const double between = std::atan2(dot(cross(up, wanted), along), dot(up, wanted));
    const Vec3d turned = Affine3d::rotation(along, between * socket.scalar(facing_)).vector(up);
    return {along, cross(turned, along), turned};
  }

  // From the value of each parameter, by slot.
  template <class Value>
  double stalk_radius(const Value& value) const {
    return thin_stalk_ ? value(width_) / 50 : value(stalk_radius_);
  }

  double half_width(const Socket& socket, double t) const {
    const double exponent = std::log(0.5) / std::log(socket.scalar(widest_));  // widest where t^exponent is a half
    return std::max(socket.scalar(width_) / 2 * std::sin(pi * std::pow(t, exponent)), 0.0);
  }

  double position(std::uint32_t section) const { return double(section) / (sections_ + 1); }
  // Left rim, midrib and right rim (0 to 2) of a section; 0 is the end of the stalk.
  static std::uint32_t vertex(std::uint32_t section, std::uint32_t across) {
    return section == 0 ? ring + 1 + across : 2 * ring + 3 * (section - 1) + across;
  }
  static Vec2d blade_uv(std::uint32_t across, double v) { return {0.5 * across, v}; }

  // The midrib is an arc of a circle with its foot at the end of the stalk.
  static Vec3d midrib(const Axes& a, double length, double droop, double t) {
    if (std::abs(droop) < 1e-6) return a.along * (length * t);
    const double radius = length / droop;
    return a.along * (radius * std::sin(droop * t)) - a.up * (radius * (1 - std::cos(droop * t)));
  }

  void add_vertices(const Socket& socket, NamedFaces& out) const {
    const Axes a = axes(socket);
    const double length = socket.scalar(length_), droop = radians(socket.scalar(droop_));
    const double fold = radians(socket.scalar(fold_)),
                 foot_radius = stalk_radius([&](int slot) { return socket.scalar(slot); });
    const Vec3d foot = socket.frame.origin + a.along * socket.scalar(stalk_);
    for (const Vec3d side : {-a.up, a.left, a.up, -a.left}) out.add_vertex(foot + side * foot_radius);
    for (std::uint32_t i = 1; i <= sections_; ++i) {
      const double t = position(i), width = half_width(socket, t);
      const Vec3d center = foot + midrib(a, length, droop, t);
      const Vec3d up = a.up * std::cos(droop * t) + a.along * std::sin(droop * t);
      const Vec3d raised = up * (std::sin(fold) * width), aside = a.left * (std::cos(fold) * width);
      for (const Vec3d across : {raised + aside, Vec3d{}, raised - aside}) out.add_vertex(center + across);
    }
    out.add_vertex(foot + midrib(a, length, droop, 1));
  }

  static void add_stalk(const Socket& socket, NamedFaces& out) {
    for (std::uint32_t i = 0; i < ring; ++i) {
      const std::uint32_t j = (i + 1) % ring;
      out.add_face(stalk, {i, j, ring + j, ring + i},
                   {socket.uv[i], socket.uv[j], Vec2d{ring_u[j], 0}, Vec2d{ring_u[i], 0}});
    }
  }

  void add_band(std::uint32_t section, NamedFaces& out) const {
    const double below = position(section), above = position(section + 1);
    for (std::uint32_t i = 0; i < 2; ++i)
      out.add_face(blade,
                   {vertex(section, i), vertex(section, i + 1), vertex(section + 1, i + 1), vertex(section + 1, i)},
                   {blade_uv(i, below), blade_uv(i + 1, below), blade_uv(i + 1, above), blade_uv(i, above)});
  }

  void add_tip(NamedFaces& out) const {
    const double below = position(sections_);
    for (std::uint32_t i = 0; i < 2; ++i)
      out.add_face(blade, {vertex(sections_, i), vertex(sections_, i + 1), vertex(sections_ + 1, 0)},
                   {blade_uv(i, below), blade_uv(i + 1, below), blade_uv(1, 1)});
  }

  std::vector<FaceName> names_{{"blade", -1}, {"stalk", -1}};
  int length_, width_, widest_, stalk_, stalk_radius_;
  bool thin_stalk_;  // the radius is that of the width
  int bend_, bend_direction_, fold_, droop_, facing_, toward_;
  std::uint32_t sections_;
};

}  // namespace

void register_leaf(TemplateRegistry& r) { r.add<Leaf>("leaf", "A leaf: a stalk, and a sheet that folds and droops"); }

}  // namespace meristem
