#include "renderer/lights/triangle_light.h"

#include "renderer/scene/warps.h"

namespace meristem {
namespace {

// Shadow rays end this part of the way before the light, which is a surface and would shade itself.
constexpr float short_of_surface = 1e-4f;
// Rays that pass an edge by this part of the triangle still count as meeting it: Embree's hit has been rounded.
constexpr double edge_tolerance = 1e-4;

}  // namespace

TriangleLight::TriangleLight(const LightTriangle& triangle, const Material& material)
    : triangle_(triangle), material_(material) {
  const auto& c = triangle_.corners;
  const Vec3d across = cross(Vec3d(c[1] - c[0]), Vec3d(c[2] - c[0]));
  area_ = float(length(across) / 2);
  normal_ = Vec3f(normalize(across));
}

Vec3f TriangleLight::at(Vec2f w) const {
  const auto& c = triangle_.corners;
  return c[0] + (c[1] - c[0]) * w.x + (c[2] - c[0]) * w.y;
}

Vec2f TriangleLight::weights_of(Vec3f position) const {
  const auto& c = triangle_.corners;
  const Vec3d a(c[1] - c[0]), b(c[2] - c[0]), p(position - c[0]), n = cross(a, b);
  const double scale = 1 / length_squared(n);
  return {float(dot(cross(p, b), n) * scale), float(dot(cross(a, p), n) * scale)};
}

Spectrum TriangleLight::emission(Vec2f w, Vec3f towards) const {
  ShadingPoint point;
  point.hit.position = at(w);
  point.hit.geometric_normal = point.hit.shading_normal = normal_;
  const Vec2f uv = triangle_.uv[0] * (1 - w.x - w.y) + triangle_.uv[1] * w.x + triangle_.uv[2] * w.y;
  point.hit.u = uv.x;
  point.hit.v = uv.y;
  point.hit.origin = triangle_.origin;
  point.wo = towards;
  return material_.emission(point);
}

LightSample TriangleLight::sample(Vec3f from, Vec2f random) const {
  LightSample s;
  const float root = std::sqrt(random.x);
  const Vec2f w{root * (1 - random.y),
                root * random.y};  // uniform by area: Turk 1990, "Generating Random Points in Triangles"
  const Vec3f way = at(w) - from;
  const float distance = length(way);
  if (!(distance > 0)) return s;
  s.direction = way / distance;
  const float cosine = std::abs(dot(s.direction, normal_));
  if (!(cosine > 1e-6f)) return s;
  s.distance = distance * (1 - short_of_surface);
  s.pdf = distance * distance / (cosine * area_);
  s.radiance = emission(w, -s.direction);
  return s;
}

float TriangleLight::intersect(const Ray& ray) const {
  constexpr float nothing = std::numeric_limits<float>::infinity();
  const double slope = dot(Vec3d(ray.direction), Vec3d(normal_));
  if (slope == 0) return nothing;
  const double t = dot(Vec3d(triangle_.corners[0]) - Vec3d(ray.origin), Vec3d(normal_)) / slope;
  const Vec2f w = weights_of(ray.origin + ray.direction * float(t));
  const bool inside = w.x >= -edge_tolerance && w.y >= -edge_tolerance && w.x + w.y <= 1 + edge_tolerance;
  return inside && t > ray.t_min ? float(t) : nothing;
}

Spectrum TriangleLight::emitted(const Ray& ray, float t) const {
  return emission(weights_of(ray.origin + ray.direction * t), -normalize(ray.direction));
}

float TriangleLight::pdf_hit(const Ray& ray, float t) const {
  const float size = length(ray.direction), cosine = std::abs(dot(ray.direction, normal_)) / size, distance = t * size;
  return cosine > 1e-6f ? distance * distance / (cosine * area_) : 0;
}

std::optional<LightBounds> TriangleLight::bounds() const {
  LightBounds b;
  for (const Vec3f c : triangle_.corners) b.box.extend(c);
  Spectrum mean;  // of the middle and of three points around it
  for (const Vec2f w :
       {Vec2f{1.f / 3, 1.f / 3}, Vec2f{1.f / 6, 1.f / 6}, Vec2f{2.f / 3, 1.f / 6}, Vec2f{1.f / 6, 2.f / 3}})
    mean += (emission(w, normal_) + emission(w, -normal_)) / 8;
  b.power = luminance(mean) * 2 * pi_f * area_;
  b.axis = normal_;
  b.cos_normals = 1;
  b.two_sided = true;
  return b;
}

}  // namespace meristem
