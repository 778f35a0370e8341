// mesh: any closed mesh as a template, inline or from an OBJ or PLY file. Its first polygon is the socket: it looks
// into the replaced face and vanishes with it, and its reference edge (corner 0 to corner 1) lies on the reference edge
// of that face. The other vertices keep their places in the frame of the socket, scaled with the radius of the replaced
// face.
#include "procedural/growth/mesh_source.h"
#include "procedural/growth/template.h"

#include <fmt/format.h>

namespace meristem {

namespace {

class MeshTemplate : public Template {
 public:
  explicit MeshTemplate(TemplateParams& params)
      : scale_(params.number("scale", "1", {0, 1000, ""},
                             "size in radii of the replaced face, with the socket's radius as 1")),
        height_(params.number("height", "1", {0, 1000, ""}, "stretches it along the face's normal")),
        source_(params.plain()) {
    if (params.plain().describing()) return;
    NamedMesh mesh = source_.load(params.files().folder, params.plain().diagnostics());
    if (mesh.faces.face_count() == 0) return;
    if (!is_closed(bare_mesh(mesh.faces))) {
      params.plain().diagnostics().error(source_.location(),
                                         "a template mesh must be closed: every edge needs two polygons");
      return;
    }
    take_socket_frame(mesh);
    renumber(mesh);
  }

  const std::vector<FaceName>& face_names() const override { return names_; }

  std::string refusal(std::uint32_t corners) const override {
    return corners == socket_corners_ ? ""
                                      : fmt::format("the template mesh's first polygon has {} corners; the face has {}",
                                                    socket_corners_, corners);
  }

  void grow(const Socket& socket, NamedFaces& out) const override {
    const FaceFrame& frame = socket.frame;
    const double scale = socket.scalar(scale_) * frame.radius, height = scale * socket.scalar(height_);
    for (const Vec3d p : local_)
      out.add_vertex(frame.origin + frame.x * (p.x * scale) + frame.y * (p.y * scale) + frame.z * (p.z * height));
    for (std::uint32_t f = 0; f < faces_.face_count(); ++f) {
      const auto corners = faces_.face(f);
      for (std::size_t i = 0; i < corners.size(); ++i)
        out.add_corner(corners[i], corner_uv(socket, corners[i], faces_.corner_uv[faces_.face_starts[f] + i], height));
      out.end_face(faces_.names[f]);
    }
  }

  Reach bound(const SocketRange& range) const override {
    const double scale = range.largest(scale_) * range.radius, height = scale * range.largest(height_);
    Reach r;
    double rise = 0;
    for (const Vec3d p : local_) {
      r.distance = std::max(r.distance, length(Vec3d{p.x * scale, p.y * scale, p.z * height}));
      rise = std::max(rise, std::abs(p.z) * height);
    }
    const double widest = 2 * std::max(r.distance, range.radius);
    r.edge = widest;
    r.face_radius.assign(names_.size(), widest);
    r.u = {std::min(range.u.lower, uv_bounds_.lower_u), std::max(range.u.upper, uv_bounds_.upper_u)};
    r.v = {std::min(float(range.v.lower - rise), uv_bounds_.lower_v),
           std::max(float(range.v.upper + rise), uv_bounds_.upper_v)};
    return r;
  }

 private:
  struct UvBounds {
    float lower_u = std::numeric_limits<float>::infinity(), upper_u = -lower_u;
    float lower_v = lower_u, upper_v = -lower_u;
  };

  // The frame of the first polygon as the replaced face will see it: z into the template.
  void take_socket_frame(NamedMesh& mesh) {
    FaceFrame frame = face_frame(bare_mesh(mesh.faces), 0);
    frame.z = -frame.z;
    frame.y = cross(frame.z, frame.x);
    for (Vec3d& p : mesh.faces.vertices) {
      const Vec3d d = (p - frame.origin) * (frame.radius > 0 ? 1 / frame.radius : 0);
      p = {dot(d, frame.x), dot(d, frame.y), dot(d, frame.z)};
    }
  }

  // Corner i of the replaced face is corner 1 - i of the first polygon, which runs the other way round.
  void renumber(const NamedMesh& mesh) {
    const auto socket = mesh.faces.face(0);
    socket_corners_ = std::uint32_t(socket.size());
    faces_.clear(socket_corners_);
    std::vector<std::uint32_t> number(mesh.faces.vertices.size(), unnumbered);
    for (std::uint32_t i = 0; i < socket_corners_; ++i) number[socket[(socket_corners_ + 1 - i) % socket_corners_]] = i;
    has_uv_ = mesh.has_uv;
    std::vector<std::string> names;
    for (std::uint32_t f = 1; f < mesh.faces.face_count(); ++f) add_face(mesh, f, number, names);
    for (const std::string& n : names) names_.push_back({n, -1});
  }

  void add_face(const NamedMesh& mesh, std::uint32_t f, std::vector<std::uint32_t>& number,
                std::vector<std::string>& names) {
    const auto corners = mesh.faces.face(f);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      std::uint32_t& v = number[corners[i]];
      if (v == unnumbered) {
        v = socket_corners_ + std::uint32_t(local_.size());
        local_.push_back(mesh.faces.vertices[corners[i]]);
      }
      const Vec2d uv = mesh.faces.corner_uv[mesh.faces.face_starts[f] + i];
      faces_.add_corner(v, uv);
      if (has_uv_) extend(uv);
    }
    faces_.end_face(index_of_name(names, mesh.names[std::size_t(mesh.faces.names[f])]));
  }

  void extend(Vec2d uv) {
    uv_bounds_ = {std::min(uv_bounds_.lower_u, float(uv.x)), std::max(uv_bounds_.upper_u, float(uv.x)),
                  std::min(uv_bounds_.lower_v, float(uv.y)), std::max(uv_bounds_.upper_v, float(uv.y))};
  }

  // The template's own u, v; without them the mean of the replaced face's, v growing with the height.
  Vec2d corner_uv(const Socket& socket, std::uint32_t vertex, Vec2d own, double height) const {
    if (vertex < socket_corners_) return socket.uv[vertex];
    if (has_uv_) return own;
    Vec2d mean;
    for (Vec2d uv : socket.uv) mean = mean + uv * (1.0 / double(socket.uv.size()));
    return mean + Vec2d{0, local_[vertex - socket_corners_].z * height};
  }

  static constexpr std::uint32_t unnumbered = ~0u;

  int scale_, height_;
  MeshSource source_;
  std::uint32_t socket_corners_ = 0;
  NamedFaces faces_;          // without the socket; vertices numbered as grow() adds them
  std::vector<Vec3d> local_;  // new vertices in the socket's frame, in its radii
  std::vector<FaceName> names_;
  bool has_uv_ = false;
  UvBounds uv_bounds_;
};

}  // namespace

void register_mesh(TemplateRegistry& r) {
  r.add<MeshTemplate>("mesh", "Any closed mesh with named faces, written inline or read from an OBJ or PLY file");
}

}  // namespace meristem
