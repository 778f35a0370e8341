// MotionVectors: how what is seen moves on the film from the opening of the shutter to that of the next frame: by the
// camera and by the transforms of the scene's objects. What grows or moves within an object is left out. Immutable; any
// thread.
#pragma once

#include "geometry/base/motion.h"
#include "renderer/scene/interfaces.h"

#include <memory>
#include <vector>

namespace meristem {

class MotionVectors {
 public:
  // An object's way to the world.
  struct Object {
    Affine3d now, later;                   // when the shutter opens, and a frame later
    std::shared_ptr<const Motion> motion;  // while the shutter is open; null: it stays at `now`
  };
  // `later`: the camera a frame later; null: it stands still. `objects`: by SurfaceHit::object.
  MotionVectors(std::unique_ptr<Camera> later, std::vector<Object> objects)
      : later_(std::move(later)), objects_(std::move(objects)) {}

  // In pixels to the right and down, of a hit at a time from 0 to 1 of the shutter. `camera`: the scene's. 0 for what
  // is not in front of the camera at both times.
  Vec2f at(const SurfaceHit& hit, float time, const Camera& camera, int width, int height) const;

 private:
  std::unique_ptr<Camera> later_;
  std::vector<Object> objects_;
};

}  // namespace meristem
