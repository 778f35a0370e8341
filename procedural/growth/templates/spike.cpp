// spike: a pyramid or cone of few faces with a single tip, such as the thorns of the paper's cactus (figure 12). With
// an inset the spike stands on the middle of the face, and a rim is left around it.
#include "procedural/growth/template.h"
#include "procedural/growth/turning.h"

namespace meristem {

namespace {

class Spike : public Template {
 public:
  explicit Spike(TemplateParams& params)
      : length_(params.number("length", "1", {0, 1e6, "m"}, "from the centroid of the face to the tip")),
        bend_(params.number("bend", "0", {-120, 120, "deg"}, "angle between the face's normal and the spike")),
        bend_direction_(params.number("bend_direction", "0", {-1e6, 1e6, "deg"},
                                      "where it leans to, from the reference edge, counter-clockwise")),
        inset_(params.plain().real("inset", 0, {0, 0.99, ""}, "width of the rim in radii of the face; 0: none")) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const std::uint32_t n = socket.count();
    const std::uint32_t base = inset_ > 0 ? add_rim(socket, out) : 0;
    const double reach = socket.scalar(length_);
    const Vec3d towards = plane_direction(socket.frame, radians(socket.scalar(bend_direction_)));
    const Affine3d turn = lean(socket.frame, towards, radians(socket.scalar(bend_)));
    const std::uint32_t tip = out.add_vertex(socket.frame.origin + turn.vector(socket.frame.z) * reach);
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      const Vec2d tip_uv = (socket.uv[i] + socket.uv[j]) * 0.5 + Vec2d{0, reach};
      out.add_face(side, {base + i, base + j, tip}, {socket.uv[i], socket.uv[j], tip_uv});
    }
  }

  Reach bound(const SocketRange& range) const override {
    const double reach = range.largest(length_);
    const double widest = std::max(reach + range.radius, 2 * range.radius);
    Reach r;
    r.distance = std::max(reach, range.radius);
    r.edge = widest;
    r.face_radius = {widest, 2 * range.radius};
    r.u = range.u;
    r.v = {range.v.lower, float(range.v.upper + reach)};
    return r;
  }

 private:
  enum { side, rim };

  // The faces around the spike's foot; returns the first corner of the foot.
  std::uint32_t add_rim(const Socket& socket, NamedFaces& out) const {
    const std::uint32_t n = socket.count();
    for (std::uint32_t i = 0; i < n; ++i) out.add_vertex(socket.frame.origin + socket.offset(i) * (1 - inset_));
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      out.add_face(rim, {i, j, n + j, n + i}, {socket.uv[i], socket.uv[j], socket.uv[j], socket.uv[i]});
    }
    return n;
  }

  std::vector<FaceName> names_{{"side", -1}, {"rim", -1}};
  int length_, bend_, bend_direction_;
  double inset_;
};

}  // namespace

void register_spike(TemplateRegistry& r) {
  r.add<Spike>("spike", "A pyramid with a single tip, as the thorns of a cactus");
}

}  // namespace meristem
