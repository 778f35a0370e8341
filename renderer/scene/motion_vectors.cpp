#include "renderer/scene/motion_vectors.h"

namespace meristem {

Vec2f MotionVectors::at(const SurfaceHit& hit, float time, const Camera& camera, int width, int height) const {
  Vec3d from(hit.position), to = from;
  if (hit.object >= 0 && std::size_t(hit.object) < objects_.size()) {
    const Object& object = objects_[std::size_t(hit.object)];
    const Vec3d local = (object.motion ? object.motion->at(time) : object.now).inverse().point(from);
    if (object.motion) from = object.now.point(local);
    to = object.now == object.later ? from : object.later.point(local);
  }
  const auto start = camera.project(from, width, height), end = (later_ ? *later_ : camera).project(to, width, height);
  return start && end ? *end - *start : Vec2f{};
}

}  // namespace meristem
