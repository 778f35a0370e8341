// sphere: a ball about the origin as a cube whose faces are grids of quadrilaterals, blown up; no poles. u is the angle
// around the y axis from +z, mirrored (0 in front, 1 behind), so that it has no seam; v is the height from -1 to 1.
#include "procedural/growth/base_shape.h"

#include <array>
#include <map>

namespace meristem {

namespace {

class Sphere : public BaseShape {
 public:
  explicit Sphere(Params& params)
      : radius_(params.real("radius", 0.5, {1e-6, 1e6, "m"}, "of the vertices")),
        divisions_(params.integer("divisions", 2, {1, 512, ""}, "quadrilaterals along an edge of the cube")),
        symbol_(read_symbol(params, "face", "symbol of the faces")) {}

 private:
  using Lattice = std::array<int, 3>;  // a point of the cube's surface: 0 to divisions along each axis

  NamedFaces outline(BaseContext&) const override {
    NamedFaces faces;
    std::map<Lattice, std::uint32_t> vertices;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {0, divisions_})
        for (int i = 0; i < divisions_; ++i)
          for (int j = 0; j < divisions_; ++j) add_quad(axis, side, i, j, vertices, faces);
    return faces;
  }
  const FaceSymbol* symbol_of(int) const override { return &symbol_; }

  void add_quad(int axis, int side, int i, int j, std::map<Lattice, std::uint32_t>& vertices, NamedFaces& faces) const {
    std::array<Lattice, 4> corners;
    constexpr int steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::size_t c = 0; c < 4; ++c) {
      corners[c][std::size_t(axis)] = side;
      corners[c][std::size_t((axis + 1) % 3)] = i + steps[c][0];
      corners[c][std::size_t((axis + 2) % 3)] = j + steps[c][1];
    }
    if (side == 0) std::swap(corners[1], corners[3]);
    for (const Lattice& corner : corners) {
      const Vec3d direction = on_sphere(corner);
      const auto [entry, is_new] = vertices.try_emplace(corner, faces.vertex_count());
      if (is_new) faces.add_vertex(direction * radius_);
      faces.add_corner(entry->second, {std::abs(std::atan2(direction.x, direction.z)) / pi, direction.y});
    }
    faces.end_face(0);
  }

  // Lattice points at equal angles, which makes the quadrilaterals nearly of one size.
  Vec3d on_sphere(const Lattice& corner) const {
    const auto spread = [&](int i) {
      return i == 0 ? -1.0 : i == divisions_ ? 1.0 : std::tan((2.0 * i / divisions_ - 1) * (pi / 4));
    };
    return normalize(Vec3d{spread(corner[0]), spread(corner[1]), spread(corner[2])});
  }

  double radius_;
  int divisions_;
  FaceSymbol symbol_;
};

}  // namespace

void register_sphere(BaseRegistry& r) { r.add<Sphere>("sphere", "A ball of nearly equal quadrilaterals"); }

}  // namespace meristem
