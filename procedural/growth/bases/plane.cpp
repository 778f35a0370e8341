// plane: a grid of quadrilaterals on y = 0 that looks up, centred on the origin, square unless both of its sides are
// given; open at its border. u and v run from 0 to 1 along x and -z.
#include "procedural/growth/base_shape.h"

namespace meristem {

namespace {

class Plane : public BaseShape {
 public:
  explicit Plane(Params& params)
      : width_(params.real("width", 1, {1e-6, 1e6, "m"}, "along x")),
        depth_(params.real("depth", width_, {1e-6, 1e6, "m"}, "along z; not given: the width")),
        columns_(params.integer("columns", 1, {1, 4096, ""}, "quadrilaterals along x")),
        rows_(params.integer("rows", columns_, {1, 4096, ""}, "quadrilaterals along z; not given: as many as columns")),
        symbol_(read_symbol(params, "face", "symbol of the faces")) {}

 private:
  NamedFaces outline(BaseContext&) const override {
    NamedFaces faces;
    for (int row = 0; row <= rows_; ++row)
      for (int column = 0; column <= columns_; ++column) {
        const Vec2d p = uv(column, row);
        faces.add_vertex({(p.x - 0.5) * width_, 0, (0.5 - p.y) * depth_});
      }
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column)
        faces.add_face(
            0, {vertex(column, row), vertex(column + 1, row), vertex(column + 1, row + 1), vertex(column, row + 1)},
            {uv(column, row), uv(column + 1, row), uv(column + 1, row + 1), uv(column, row + 1)});
    return faces;
  }
  const FaceSymbol* symbol_of(int) const override { return &symbol_; }

  std::uint32_t vertex(int column, int row) const { return std::uint32_t(row * (columns_ + 1) + column); }
  Vec2d uv(int column, int row) const { return {double(column) / columns_, double(row) / rows_}; }

  double width_, depth_;
  int columns_, rows_;
  FaceSymbol symbol_;
};

}  // namespace

void register_plane(BaseRegistry& r) { r.add<Plane>("plane", "A level grid of quadrilaterals"); }

}  // namespace meristem
