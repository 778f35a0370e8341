// tent: the tent-shaped template of the paper's figure 6, on a quadrilateral: two slopes that meet in a ridge, parallel
// to the reference edge, and two gables.
#include "procedural/growth/template.h"

#include <fmt/format.h>

namespace meristem {

namespace {

class Tent : public Template {
 public:
  explicit Tent(TemplateParams& params)
      : height_(params.number("height", "1", {0, 1e6, "m"}, "of the ridge over the face")),
        ridge_(params.number("ridge", "1", {0.001, 100, ""}, "length of the ridge; 1: as long as the face")) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  std::string refusal(std::uint32_t corners) const override {
    return corners == 4 ? "" : fmt::format("a tent needs a face with 4 corners; this one has {}", corners);
  }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const double height = socket.scalar(height_);
    const auto uv = socket.uv;
    const Vec2d up{0, height};
    const auto ridge_end = [&](std::uint32_t i, std::uint32_t j) {
      return socket.frame.origin + (socket.offset(i) + socket.offset(j)) * (0.5 * socket.scalar(ridge_)) +
             socket.frame.z * height;
    };
    const std::uint32_t a = out.add_vertex(ridge_end(3, 0)), b = out.add_vertex(ridge_end(1, 2));
    out.add_face(front, {0, 1, b, a}, {uv[0], uv[1], uv[1] + up, uv[0] + up});
    out.add_face(right, {1, 2, b}, {uv[1], uv[2], (uv[1] + uv[2]) * 0.5 + up});
    out.add_face(back, {2, 3, a, b}, {uv[2], uv[3], uv[3] + up, uv[2] + up});
    out.add_face(left, {3, 0, a}, {uv[3], uv[0], (uv[3] + uv[0]) * 0.5 + up});
  }

  Reach bound(const SocketRange& range) const override {
    const double height = range.largest(height_), half_ridge = range.largest(ridge_) * range.radius;
    const double widest = std::max({height + half_ridge + range.radius, 2 * half_ridge, 2 * range.radius});
    Reach r;
    r.distance = height + half_ridge;
    r.edge = widest;
    r.face_radius.assign(names_.size(), widest);
    r.u = range.u;
    r.v = {range.v.lower, float(range.v.upper + height)};
    return r;
  }

 private:
  enum {
    slope,
    gable,
    front,
    right,
    back,
    left
  };  // front stands on the reference edge; the others follow counter-clockwise
  std::vector<FaceName> names_{{"slope", -1},    {"gable", -1},   {"front", slope},
                               {"right", gable}, {"back", slope}, {"left", gable}};
  int height_, ridge_;
};

}  // namespace

void register_tent(TemplateRegistry& r) { r.add<Tent>("tent", "Two slopes that meet in a ridge over a quadrilateral"); }

}  // namespace meristem
