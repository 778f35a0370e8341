// What a ray is and what it hits: plain records between the geometry and the renderer.
#pragma once

#include "geometry/base/vec.h"
#include "geometry/mesh/face_origin.h"

#include <cstdint>
#include <limits>

namespace meristem {

// Rays of different classes may see the world at different levels of detail (WorldOptions).
enum class RayClass : std::uint8_t {
  Camera,   // and what mirrors and clear glass show
  Diffuse,  // scattered widely
  Shadow    // towards a light
};
constexpr int ray_classes = 3;

struct Ray {
  Vec3f origin;
  Vec3f direction;  // any length but zero; t is in units of it
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();
  float time = 0;
  RayClass ray_class = RayClass::Camera;
  RayClass origin_class = RayClass::Camera;  // whose world the surface belongs to on which the ray begins
};

struct SurfaceHit {
  float t = std::numeric_limits<float>::infinity();
  Vec3f position;          // on the surface, world space, from the vertices (not from t)
  Vec3f position_error;    // bound on |position - exact|, per component, in world space
  Vec3f geometric_normal;  // unit; towards the outside (counter-clockwise corners), whatever side the ray came from
  Vec3f shading_normal;    // unit; on the same side of the surface as geometric_normal
  Vec3f dpdu, dpdv;        // tangents along growing u and v (not unit); zero if these do not vary there
  float u = 0, v = 0;      // propagated texture coordinates
  int object = -1;         // index into the world's objects
  int level = 0;           // of refinement at which the surface was met: steps of its model
  FaceOrigin origin;       // of the face that was met
  bool valid() const { return t < std::numeric_limits<float>::infinity(); }
};

}  // namespace meristem
