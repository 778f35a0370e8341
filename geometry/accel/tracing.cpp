#include "geometry/accel/tracing.h"

namespace meristem {

namespace {

// A hit in the frame of an instance, in the world.
void place(const Affine3d& from_world, SurfaceHit& hit) {
  const Affine3d m = from_world.inverse();
  const Affine3f to_world{Vec3f(m.x), Vec3f(m.y), Vec3f(m.z), Vec3f(m.origin)};
  const Vec3f p = hit.position, e = hit.position_error;
  hit.position = to_world.point(p);
  // The error carried over, and that of the product and of the way into the instance: gamma(4) of the sum of
  // magnitudes.
  auto magnitudes = [&](Vec3f v) {
    return abs(to_world.x) * std::abs(v.x) + abs(to_world.y) * std::abs(v.y) + abs(to_world.z) * std::abs(v.z);
  };
  hit.position_error = magnitudes(e) + (magnitudes(p) + abs(to_world.origin)) * (4 * 0x1p-24f);
  hit.geometric_normal = Vec3f(normalize(from_world.transposed_vector(Vec3d(hit.geometric_normal))));
  hit.shading_normal = Vec3f(normalize(from_world.transposed_vector(Vec3d(hit.shading_normal))));
  hit.dpdu = to_world.vector(hit.dpdu);
  hit.dpdv = to_world.vector(hit.dpdv);
}

}  // namespace

Tracing::Tracing(const Ray& ray, ExpansionRecorder* recorder)
    : query(query_of(ray)), tree_(ray.origin, ray.direction), sampled_(recorder, context) {
  rtcInitIntersectContext(&context.embree);
  context.tree_ray = &tree_;
}

void Tracing::surface_hit(SurfaceHit& hit) const {
  context.patch->surface_at(context.patch_hit, hit);
  if (context.patch_from_world) place(*context.patch_from_world, hit);
  hit.t = query.ray.tfar;
  hit.object = context.patch_object;
}

}  // namespace meristem
