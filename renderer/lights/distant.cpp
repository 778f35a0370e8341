// distant: a sun by itself: light from one direction, or from a small cone around it.
//
// `direction` is where the light goes, as from a lamp far away; `irradiance` is what a surface receives that faces it,
// whatever the `angle` (the angular diameter; 0 gives perfectly sharp shadows).
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

class Distant : public Light {
 public:
  explicit Distant(Params& params) {
    Vec3d direction = normalize(params.vector("direction", {-1, -1, -1}, any_range, "where the light goes"));
    if (length_squared(direction) == 0) {
      params.error("direction", "a direction must not be zero");
      direction = {0, -1, 0};
    }
    const Vec3d color = params.color("irradiance", {3, 3, 3}, "irradiance of a surface that faces the light");
    const double intensity = params.real("intensity", 1, not_negative, "scales the irradiance");
    const double angle = params.real("angle", 0.53, {0, 180, "deg"}, "angular diameter; 0: sharp shadows");
    frame_ = Frame(Vec3f(-direction));
    irradiance_ = Spectrum(color * intensity);
    // Half the diameter; 1 - cos x = 2 sin^2(x / 2), and the cone's projected solid angle is pi sin^2 x
    const double radius = angle * pi / 360;
    width_ = float(2 * std::pow(std::sin(radius / 2), 2.0));
    if (width_ > 0) radiance_ = irradiance_ / float(pi * std::pow(std::sin(radius), 2.0));
  }

  LightSample sample(Vec3f, Vec2f random) const override {
    LightSample s;
    s.distance = std::numeric_limits<float>::infinity();
    if (width_ > 0) {
      s.direction = normalize(frame_.to_world(uniform_cone(width_, random)));
      s.radiance = radiance_;
      s.pdf = uniform_cone_pdf(width_);
    } else {
      s.direction = frame_.n;
      s.radiance = irradiance_;
      s.pdf = 1;
      s.is_delta = true;
    }
    return s;
  }
  EscapedLight escaped(Vec3f d) const override {
    return inside(d) ? EscapedLight{radiance_, uniform_cone_pdf(width_)} : EscapedLight{};
  }
  float environment_power() const override { return luminance(irradiance_); }

 private:
  bool inside(Vec3f d) const { return width_ > 0 && one_minus_cosine(d, frame_.n) <= width_; }

  Frame frame_;  // around the direction towards the light
  Spectrum irradiance_, radiance_;
  float width_ = 0;  // 1 - cos of the angular radius
};

}  // namespace

void register_distant(LightRegistry& r) { r.add<Distant>("distant", "Light from one direction, like a sun"); }

}  // namespace meristem
