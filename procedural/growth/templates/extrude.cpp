// extrude: the face drawn in towards its centroid, then pushed out (or in): a rim, a wall and a cap. For buds, panels,
// hollows.
#include "procedural/growth/template.h"

namespace meristem {

namespace {

class Extrude : public Template {
 public:
  explicit Extrude(TemplateParams& params)
      : inset_(params.number("inset", "0.2", {0.001, 0.999, ""}, "width of the rim in radii of the face")),
        height_(params.number("height", "0", {-1e6, 1e6, "m"}, "of the cap over the face; negative: a hollow")),
        taper_(params.number("taper", "1", {0, 100, ""}, "size of the cap in sizes of the inset face")) {}

  const std::vector<FaceName>& face_names() const override { return names_; }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const std::uint32_t n = socket.count();
    const double inset = 1 - socket.scalar(inset_), height = socket.scalar(height_);
    const Vec3d origin = socket.frame.origin, top = origin + socket.frame.z * height;
    for (std::uint32_t i = 0; i < n; ++i) out.add_vertex(origin + socket.offset(i) * inset);
    for (std::uint32_t i = 0; i < n; ++i) out.add_vertex(top + socket.offset(i) * (inset * socket.scalar(taper_)));
    const Vec2d inwards{0, (1 - inset) * socket.frame.radius};
    const Vec2d up = inwards + Vec2d{0, std::abs(height)};
    add_band(socket, rim, 0, {}, inwards, out);
    add_band(socket, wall, n, inwards, up, out);
    for (std::uint32_t i = 0; i < n; ++i) out.add_corner(2 * n + i, socket.uv[i] + up);
    out.end_face(cap);
  }

  Reach bound(const SocketRange& range) const override {
    const double height = range.largest(height_);
    const double cap_radius = (1 - range.values[std::size_t(inset_)].lower.x) * range.largest(taper_) * range.radius;
    const double wall_size = std::max({height + range.radius + cap_radius, 2 * cap_radius, 2 * range.radius});
    Reach r;
    r.distance = std::max(range.radius, height + cap_radius);
    r.edge = wall_size;
    r.face_radius = {2 * range.radius, wall_size, cap_radius};
    r.u = range.u;
    r.v = {range.v.lower, float(range.v.upper + height + range.radius)};
    return r;
  }

 private:
  enum { rim, wall, cap };

  // Quadrilaterals between the ring of vertices that begins at `first` and the next ring.
  static void add_band(const Socket& socket, int name, std::uint32_t first, Vec2d below, Vec2d above, NamedFaces& out) {
    const std::uint32_t n = socket.count();
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = (i + 1) % n;
      out.add_face(name, {first + i, first + j, first + n + j, first + n + i},
                   {socket.uv[i] + below, socket.uv[j] + below, socket.uv[j] + above, socket.uv[i] + above});
    }
  }

  std::vector<FaceName> names_{{"rim", -1}, {"wall", -1}, {"cap", -1}};
  int inset_, height_, taper_;
};

}  // namespace

void register_extrude(TemplateRegistry& r) { r.add<Extrude>("extrude", "The face drawn in, then pushed out or in"); }

}  // namespace meristem
