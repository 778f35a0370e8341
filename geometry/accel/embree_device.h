// The Embree device and small owners of its handles. The one folder that includes Embree (3.13; 4 compiles against the
// same few calls).
#pragma once

#include "geometry/accel/surface.h"

#include <embree3/rtcore.h>

#include <cstddef>
#include <memory>
#include <utility>

namespace meristem {

// Scenes and geometries are reference-counted by Embree; these release one reference.
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using ScenePtr = std::unique_ptr<RTCSceneTy, SceneDeleter>;

// One device a process, made at first use. Never given "threads=": that would throttle all TBB of the process.
RTCDevice embree_device();

// A ray that has met nothing yet.
inline RTCRayHit query_of(const Ray& ray) {
  RTCRayHit query;
  query.ray = {ray.origin.x,
               ray.origin.y,
               ray.origin.z,
               ray.t_min,
               ray.direction.x,
               ray.direction.y,
               ray.direction.z,
               ray.time,
               ray.t_max,
               ~0u,
               0,
               0};
  query.hit = {};
  query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

// Bytes that Embree says it allocated minus freed on this thread since the last call.
std::ptrdiff_t take_embree_bytes();

// What a scene with one geometry costs beyond what Embree's monitor reports: 3.5 to 4 KB, by resident set over 10^5 of
// them.
constexpr std::size_t hidden_scene_bytes = 4096;

// Commits a scene (call inside run_isolated() to build on the calling thread alone); returns the bytes it costs, hidden
// ones included. Throws std::runtime_error when Embree fails (out of memory).
std::size_t commit_scene(RTCScene scene);

}  // namespace meristem
