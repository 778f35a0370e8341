// box: an upright box on y = 0, centred on the y axis. u runs 0 1 0 1 around it, v is the height.
#include "procedural/growth/base_shape.h"

namespace meristem {

namespace {

class BaseBox : public BaseShape {
 public:
  explicit BaseBox(Params& params)
      : size_(params.vector("size", {1, 1, 1}, {1e-6, 1e6, "m"}, "along x, y and z")),
        crease_(params.real("crease", 0, {0, 10, ""}, "sharpness of all edges")),
        symbols_{read_symbol(params, "top", "symbol of the top"), read_symbol(params, "bottom", "symbol of the bottom"),
                 read_symbol(params, "side", "symbol of the sides")} {}

 private:
  enum { top, bottom, side };

  NamedFaces outline(BaseContext&) const override {
    const double x = size_.x / 2, z = size_.z / 2;
    const Vec3d ring[] = {{-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z}};
    const double u[] = {0, 1, 0, 1};
    NamedFaces faces = make_prism(ring, u, size_.y, {top, bottom, side}, 0);
    faces.crease_inner_edges(float(crease_));  // no border: all of them
    return faces;
  }
  const FaceSymbol* symbol_of(int name) const override { return &symbols_[name]; }

  Vec3d size_;
  double crease_;
  FaceSymbol symbols_[3];
};

}  // namespace

void register_box(BaseRegistry& r) { r.add<BaseBox>("box", "An upright box"); }

}  // namespace meristem
