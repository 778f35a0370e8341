// sphere: a glowing ball, lit on its outside (or, `two_sided`, inside as well).
//
// It is seen by the camera unless `visible` is false, in mirrors and through glass in any case, and never casts a
// shadow: rays go on through it. From outside, the cone it fills is sampled uniformly (Shirley, Wang, Zimmerman 1996);
// from inside, all directions.
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

class Sphere : public Light {
 public:
  explicit Sphere(Params& params) {
    center_ = params.vector("center", {0, 3, 0}, {-1e9, 1e9, "m"}, "the middle");
    radius_ = params.real("radius", 0.25, {1e-6, 1e9, "m"}, "radius");
    const Vec3d color = params.color("color", {1, 1, 1}, "radiance");
    const double intensity = params.real("intensity", 5, not_negative, "scales the colour");
    two_sided_ = params.boolean("two_sided", false, "whether the inside glows too");
    visible_ = params.boolean("visible", true, "whether the camera sees it; mirrors do anyway");
    radiance_ = Spectrum(color * intensity);
  }

  LightSample sample(Vec3f from, Vec2f random) const override {
    LightSample s;
    const float width = cone_width(from);
    if (width == 0) return s;
    const Frame frame(width < 2 ? Vec3f(normalize(center_ - Vec3d(from))) : Vec3f{0, 0, 1});
    s.direction = normalize(frame.to_world(uniform_cone(width, random)));
    s.distance = distance_along(from, s.direction);
    s.radiance = radiance_;
    s.pdf = uniform_cone_pdf(width);
    return s;
  }

  float intersect(const Ray& ray) const override {
    constexpr float nothing = std::numeric_limits<float>::infinity();
    const double scale = double(length(ray.direction));
    const Vec3d d = Vec3d(ray.direction) / scale, v = Vec3d(ray.origin) - center_;
    const double middle = -dot(v, d), reach2 = radius_ * radius_ - length_squared(v + d * middle);
    if (reach2 < 0) return nothing;
    const double half = std::sqrt(reach2);
    auto in_range = [&](double t) { return t > ray.t_min && t < ray.t_max; };
    if (const double t = (middle - half) / scale; in_range(t)) return float(t);
    if (const double t = (middle + half) / scale; two_sided_ && in_range(t)) return float(t);
    return nothing;
  }
  bool seen_by_camera() const override { return visible_; }
  Spectrum emitted(const Ray&, float) const override { return radiance_; }
  float pdf_hit(const Ray& ray, float) const override {
    const float width = cone_width(ray.origin);
    return width > 0 ? uniform_cone_pdf(width) : 0;
  }

  std::optional<LightBounds> bounds() const override {
    LightBounds b;
    b.box = round_outwards(Bounds3d{center_, center_}.inflated(Vec3d(radius_)));
    b.power = luminance(radiance_) * float(4 * pi * pi * radius_ * radius_) * (two_sided_ ? 2 : 1);
    return b;
  }

 private:
  // 1 - cos of the half angle under which the sphere is seen; 2 from inside; 0 where it gives no light.
  float cone_width(Vec3f from) const {
    const double sine2 = radius_ * radius_ / length_squared(center_ - Vec3d(from));
    if (!(sine2 < 1)) return two_sided_ ? 2.f : 0.f;
    return float(sine2 / (1 + std::sqrt(1 - sine2)));
  }
  // To the sphere in a direction of its cone: the nearest point if rounding makes the ray miss it.
  float distance_along(Vec3f from, Vec3f direction) const {
    const Vec3d v = Vec3d(from) - center_, d(direction);
    const double middle = -dot(v, d);
    const double half = std::sqrt(std::max(0.0, radius_ * radius_ - length_squared(v + d * middle)));
    return float(length_squared(v) < radius_ * radius_ ? middle + half : middle - half);
  }

  Vec3d center_;
  double radius_ = 1;
  Spectrum radiance_;
  bool two_sided_ = false, visible_ = true;
};

}  // namespace

void register_sphere(LightRegistry& r) { r.add<Sphere>("sphere", "A glowing ball"); }

}  // namespace meristem
