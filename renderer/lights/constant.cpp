// constant: the same light from all sides. For tests, for ambient fill, and for looking at shapes.
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

class Constant : public Light {
 public:
  explicit Constant(Params& params) {
    const Vec3d color = params.color("color", {1, 1, 1}, "radiance");
    const double intensity = params.real("intensity", 1, not_negative, "scales the colour");
    radiance_ = Spectrum(color * intensity);
    visible_ = params.boolean("visible", true, "whether the camera sees it, else nothing; mirrors do anyway");
  }

  LightSample sample(Vec3f, Vec2f random) const override {
    LightSample s;
    s.direction = uniform_cone(2, random);
    s.distance = std::numeric_limits<float>::infinity();
    s.radiance = radiance_;
    s.pdf = uniform_cone_pdf(2);
    return s;
  }
  EscapedLight escaped(Vec3f) const override { return {radiance_, uniform_cone_pdf(2)}; }
  float environment_power() const override { return luminance(radiance_) * 4 * pi_f; }
  bool is_uniform() const override { return true; }
  bool seen_by_camera() const override { return visible_; }

 private:
  Spectrum radiance_;
  bool visible_ = true;
};

}  // namespace

void register_constant(LightRegistry& r) { r.add<Constant>("constant", "The same light from all sides"); }

}  // namespace meristem
