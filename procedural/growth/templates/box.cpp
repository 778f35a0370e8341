// box: the cube-shaped template of the paper's figure 6, on a quadrilateral. Each side has a name of its own, so that
// growth can go on from any of them.
#include "procedural/growth/template.h"

#include <fmt/format.h>

namespace meristem {

namespace {

class Box : public Template {
 public:
  explicit Box(TemplateParams& params)
      : height_(params.number("height", "1", {0, 1e6, "m"}, "along the face's normal")),
        taper_(params.number("taper", "1", {0, 100, ""}, "size of the top in sizes of the face")) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  std::string refusal(std::uint32_t corners) const override {
    return corners == 4 ? "" : fmt::format("a box needs a face with 4 corners; this one has {}", corners);
  }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const double height = socket.scalar(height_);
    const Vec3d center = socket.frame.origin + socket.frame.z * height;
    const Vec2d up{0, height};
    for (std::uint32_t i = 0; i < 4; ++i) out.add_vertex(center + socket.offset(i) * socket.scalar(taper_));
    for (std::uint32_t i = 0; i < 4; ++i) {
      const std::uint32_t j = (i + 1) % 4;
      out.add_face(front + int(i), {i, j, 4 + j, 4 + i},
                   {socket.uv[i], socket.uv[j], socket.uv[j] + up, socket.uv[i] + up});
    }
    out.add_face(top, {4, 5, 6, 7}, {socket.uv[0] + up, socket.uv[1] + up, socket.uv[2] + up, socket.uv[3] + up});
  }

  Reach bound(const SocketRange& range) const override {
    const double height = range.largest(height_), top_radius = range.largest(taper_) * range.radius;
    const double side_edge = height + range.radius + top_radius;
    const double side_radius = std::max({side_edge, 2 * range.radius, 2 * top_radius});
    Reach r;
    r.distance = height + top_radius;
    r.edge = std::max(side_edge, 2 * top_radius);
    r.face_radius = {top_radius, side_radius, side_radius, side_radius, side_radius, side_radius};
    r.u = range.u;
    r.v = {range.v.lower, float(range.v.upper + height)};
    return r;
  }

 private:
  enum {
    top,
    side,
    front,
    right,
    back,
    left
  };  // front stands on the reference edge; the others follow counter-clockwise
  std::vector<FaceName> names_{{"top", -1},     {"side", -1},   {"front", side},
                               {"right", side}, {"back", side}, {"left", side}};
  int height_, taper_;
};

}  // namespace

void register_box(TemplateRegistry& r) {
  r.add<Box>("box", "A box on a quadrilateral, each side with a name of its own");
}

}  // namespace meristem
