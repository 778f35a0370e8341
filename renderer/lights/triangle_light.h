// TriangleLight: one glowing face of an object, for light samples; made by the loader, not by a scene's list of lights.
//
// A ray that hits the object there sees what the material emits (Light::object() tells the integrator that both are one
// light). Both sides glow. Sampled uniformly by area. Immutable; refers to the material, which must outlive it.
#pragma once

#include "renderer/scene/interfaces.h"

#include <array>

namespace meristem {

struct LightTriangle {
  std::array<Vec3f, 3> corners;  // world space, counter-clockwise from outside
  std::array<Vec2f, 3> uv;
  FaceOrigin origin;
  int object = 0;
};

class TriangleLight final : public Light {
 public:
  TriangleLight(const LightTriangle& triangle, const Material& material);

  LightSample sample(Vec3f from, Vec2f random) const override;
  int object() const override { return triangle_.object; }
  float intersect(const Ray& ray) const override;
  Spectrum emitted(const Ray& ray, float t) const override;
  float pdf_hit(const Ray& ray, float t) const override;
  std::optional<LightBounds> bounds() const override;

 private:
  Spectrum emission(Vec2f weights, Vec3f towards) const;  // weights of the second and third corner
  Vec2f weights_of(Vec3f position) const;
  Vec3f at(Vec2f weights) const;

  const LightTriangle triangle_;
  const Material& material_;
  Vec3f normal_;  // unit
  float area_ = 0;
};

}  // namespace meristem
