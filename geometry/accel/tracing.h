// Tracing: one ray on its way through the world, with what it needs there.
#pragma once

#include "geometry/accel/model_root.h"
#include "geometry/cache/expansion_recorder.h"

namespace meristem {

class Tracing {
 public:
  // With a recorder it counts the cells it meets, if it is in the recorder's sample.
  Tracing(const Ray& ray, ExpansionRecorder* recorder);
  Tracing(const Tracing&) = delete;
  Tracing& operator=(const Tracing&) = delete;

  // The nearest hit, of a ray that has met one.
  void surface_hit(SurfaceHit& hit) const;

  RTCRayHit query;
  RayContext context;

 private:
  class Sampled {
   public:
    Sampled(ExpansionRecorder* recorder, RayContext& context) : recorder_(recorder) {
      if (recorder_ && !(context.visits = recorder_->begin_ray())) recorder_ = nullptr;
    }
    ~Sampled() {
      if (recorder_) recorder_->end_ray();
    }
    Sampled(const Sampled&) = delete;
    Sampled& operator=(const Sampled&) = delete;

   private:
    ExpansionRecorder* recorder_;
  };

  const TreeRay tree_;
  const Sampled sampled_;
};

}  // namespace meristem
