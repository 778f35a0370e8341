// rectangle: a glowing rectangle, like a window or a softbox.
//
// Its middle is `from`; it faces `to`; `up` turns it; `width` and `height` are its sides. It is seen by the camera
// unless `visible` is false, in mirrors and through glass in any case, and never casts a shadow: rays go on through it.
//
// Sampled uniformly by solid angle: Urena, Fajardo, King 2013, "An Area-Preserving Parametrization for Spherical
// Rectangles", in double precision; where that solid angle is too small to be computed so, by area.
#include "renderer/scene/interfaces.h"
#include "renderer/scene/warps.h"

namespace meristem {
namespace {

// Below this many steradians the angles of the spherical rectangle, each near pi/2, have too few digits left of their
// excess.
constexpr double smallest_solid_angle = 1e-5;

// The rectangle as seen from a point: the names are those of the paper, section 3.
struct SphericalRectangle {
  double x0, x1, y0, y1, z0;  // corners in the rectangle's frame from the point; z0 < 0
  double b0, b1, k, solid_angle;

  SphericalRectangle(Vec3d corner, double width, double height) : x0(corner.x), y0(corner.y), z0(-std::abs(corner.z)) {
    x1 = x0 + width;
    y1 = y0 + height;
    // z components of the edges' plane normals; the inner angles are the arc cosines of their products
    const double n0 = -y0 / std::hypot(z0, y0), n1 = x1 / std::hypot(z0, x1);
    const double n2 = y1 / std::hypot(z0, y1), n3 = -x0 / std::hypot(z0, x0);
    auto angle = [](double c) { return std::acos(std::clamp(c, -1.0, 1.0)); };
    const double g0 = angle(-n0 * n1), g1 = angle(-n1 * n2), g2 = angle(-n2 * n3), g3 = angle(-n3 * n0);
    b0 = n0;
    b1 = n2;
    k = 2 * pi - g2 - g3;
    solid_angle = z0 < 0 ? std::max(0.0, g0 + g1 - k) : 0;
  }

  // A point (x, y) on the rectangle's plane, uniformly by solid angle.
  Vec2d sample(Vec2f random) const {
    const double area_angle = double(random.x) * solid_angle + k;
    const double sine = std::sin(area_angle);
    const double fu = (std::cos(area_angle) * b0 - b1) / (sine != 0 ? sine : 1e-300);
    const double cu = std::clamp(std::copysign(1 / std::hypot(fu, b0), fu), -1.0, 1.0);
    const double xu = std::clamp(-cu * z0 / std::sqrt(std::max(1e-300, 1 - cu * cu)), x0, x1);
    const double d2 = xu * xu + z0 * z0;
    const double h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
    const double h = h0 + double(random.y) * (h1 - h0);
    const double y = h * h < 1 ? h * std::sqrt(d2 / (1 - h * h)) : y1;
    return {xu, std::clamp(y, y0, y1)};
  }
};

class Rectangle : public Light {
 public:
  explicit Rectangle(Params& params) {
    center_ = params.vector("from", {0, 3, 0}, {-1e9, 1e9, "m"}, "the middle of the rectangle");
    const Vec3d to = params.vector("to", {0, 0, 0}, {-1e9, 1e9, "m"}, "the point it faces");
    const Vec3d up = params.vector("up", {0, 1, 0}, any_range, "the direction of its height, roughly");
    width_ = params.real("width", 1, {1e-6, 1e9, "m"}, "width");
    height_ = params.real("height", 1, {1e-6, 1e9, "m"}, "height");
    const Vec3d color = params.color("color", {1, 1, 1}, "radiance");
    const double intensity = params.real("intensity", 5, not_negative, "scales the colour");
    two_sided_ = params.boolean("two_sided", false, "whether the back glows too");
    visible_ = params.boolean("visible", true, "whether the camera sees it; mirrors do anyway");
    radiance_ = Spectrum(color * intensity);

    normal_ = normalize(to - center_);
    if (length_squared(normal_) == 0) {
      params.error("to", "\"to\" must differ from \"from\"");
      normal_ = {0, -1, 0};
    }
    right_ = normalize(cross(up, normal_));
    if (length_squared(right_) == 0) orthonormal_basis(normal_, right_, up_);
    up_ = cross(normal_, right_);
  }

  LightSample sample(Vec3f from, Vec2f random) const override {
    LightSample s;
    const Vec3d corner = corner_from(from);
    if (!lights(corner)) return s;
    const SphericalRectangle seen(corner, width_, height_);
    const Vec2d p =
        by_area(seen) ? Vec2d{corner.x + random.x * width_, corner.y + random.y * height_} : seen.sample(random);
    const Vec3d v = right_ * p.x + up_ * p.y + normal_ * corner.z;
    const double distance = length(v);
    s.direction = Vec3f(v / distance);
    s.distance = float(distance);
    s.radiance = radiance_;
    s.pdf = pdf(seen, distance);
    return s;
  }

  float intersect(const Ray& ray) const override {
    constexpr float nothing = std::numeric_limits<float>::infinity();
    const Vec3d direction(ray.direction), offset = Vec3d(ray.origin) - center_;
    const double slope = dot(direction, normal_);
    if (slope == 0 || (slope > 0 && !two_sided_)) return nothing;
    const double t = -dot(offset, normal_) / slope;
    if (!(t > ray.t_min && t < ray.t_max)) return nothing;
    const Vec3d p = offset + direction * t;
    const bool inside = std::abs(dot(p, right_)) <= width_ / 2 && std::abs(dot(p, up_)) <= height_ / 2;
    return inside ? float(t) : nothing;
  }
  bool seen_by_camera() const override { return visible_; }
  Spectrum emitted(const Ray&, float) const override { return radiance_; }
  float pdf_hit(const Ray& ray, float t) const override {
    const Vec3d corner = corner_from(ray.origin);
    if (!lights(corner)) return 0;
    return pdf(SphericalRectangle(corner, width_, height_), double(t) * double(length(ray.direction)));
  }

  std::optional<LightBounds> bounds() const override {
    Bounds3d box;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) box.extend(center_ + right_ * (x * width_) + up_ * (y * height_));
    LightBounds b;
    b.box = round_outwards(box);
    b.power = luminance(radiance_) * float(pi * width_ * height_) * (two_sided_ ? 2 : 1);
    b.axis = Vec3f(normal_);
    b.cos_normals = 1;
    b.two_sided = two_sided_;
    return b;
  }

 private:
  // The lower left corner from a point, in the frame (right, up, normal).
  Vec3d corner_from(Vec3f from) const {
    const Vec3d v = center_ - Vec3d(from);
    return {dot(v, right_) - width_ / 2, dot(v, up_) - height_ / 2, dot(v, normal_)};
  }
  bool lights(Vec3d corner) const { return corner.z < 0 || (corner.z > 0 && two_sided_); }
  static bool by_area(const SphericalRectangle& seen) { return !(seen.solid_angle > smallest_solid_angle); }
  float pdf(const SphericalRectangle& seen, double distance) const {
    if (!by_area(seen)) return float(1 / seen.solid_angle);
    return float(distance * distance * distance / (-seen.z0 * width_ * height_));  // distance^2 / (cos * area)
  }

  Vec3d center_, normal_, right_, up_;
  double width_ = 1, height_ = 1;
  Spectrum radiance_;
  bool two_sided_ = false, visible_ = true;
};

}  // namespace

void register_rectangle(LightRegistry& r) { r.add<Rectangle>("rectangle", "A glowing rectangle"); }

}  // namespace meristem
