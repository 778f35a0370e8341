// prism: a stem's first piece, standing on y = 0. u runs to and fro around it: with 8 sides and 2 ridges 0 .5 1 .5 0 .5
// 1 .5, the two mirrored cycles of the paper's figure 9, without a seam.
#include "procedural/growth/base_shape.h"

#include <cmath>

namespace meristem {

namespace {

class Prism : public BaseShape {
 public:
  explicit Prism(Params& params)
      : sides_(params.integer("sides", 8, {3, 1000, ""}, "corners of the cross-section")),
        radius_(params.real("radius", 0.5, {1e-6, 1e6, "m"}, "of the corners")),
        height_(params.real("height", 1, {1e-6, 1e6, "m"}, "from y = 0")),
        ridges_(params.integer("ridges", 2, {0, 500, ""}, "mirrored cycles of u around it")),
        crease_(params.real("crease", 0, {0, 10, ""}, "sharpness of the rims of both caps")),
        symbols_{read_symbol(params, "cap", "symbol of the top"), read_symbol(params, "bottom", "symbol of the bottom"),
                 read_symbol(params, "side", "symbol of the sides")} {}

 private:
  enum { cap, bottom, side };

  NamedFaces outline(BaseContext&) const override {
    std::vector<Vec3d> ring;
    std::vector<double> u;
    for (int i = 0; i < sides_; ++i) {
      const double angle = 2 * pi * i / sides_;
      ring.push_back({radius_ * std::cos(angle), 0, -radius_ * std::sin(angle)});
      u.push_back(mirrored_cycle(double(i) * ridges_ / sides_));
    }
    return make_prism(ring, u, height_, {cap, bottom, side}, crease_);
  }
  const FaceSymbol* symbol_of(int name) const override { return &symbols_[name]; }

  // 0 at whole numbers, 1 half way between.
  static double mirrored_cycle(double x) { return 1 - std::abs(1 - 2 * (x - std::floor(x))); }

  int sides_;
  double radius_, height_;
  int ridges_;
  double crease_;
  FaceSymbol symbols_[3];
};

}  // namespace

void register_prism(BaseRegistry& r) { r.add<Prism>("prism", "An upright prism, the first piece of a stem"); }

}  // namespace meristem
