#include "geometry/accel/model_root.h"

#include <algorithm>

namespace meristem {

void ExpansionCounts::add(const Model& model, const Expansion& expansion, double seconds) {
  const std::lock_guard lock(mutex_);
  faces_ += expansion.faces;
  time_s_ += seconds;
  for (std::size_t level = 0; level < expansion.work.size(); ++level) {
    const StepWork& work = expansion.work[level];
    if (work.faces == 0) continue;
    const std::string name = model.step(int(level)).name();
    auto row = std::find_if(by_step_.begin(), by_step_.end(), [&](const StepStatistics& s) { return s.step == name; });
    if (row == by_step_.end()) row = by_step_.insert(row, StepStatistics{name, 0, 0, 0});
    ++row->cells;
    row->faces += work.faces;
    row->time_s += work.time_s;
  }
}

void ExpansionCounts::add_defect(std::string message) {
  const std::lock_guard lock(mutex_);
  ++failed_;
  defects_.insert(std::move(message));
}

void ExpansionCounts::write(ExpansionStatistics& statistics) const {
  const std::lock_guard lock(mutex_);
  statistics.faces = faces_;
  statistics.time_s = time_s_;
  statistics.failed = failed_;
  statistics.by_step = by_step_;
  statistics.defects.assign(defects_.begin(), defects_.end());
}

void intersect_patch(const SurfacePatch& patch, Key key, RayContext& context, RTCRayHit& ray) {
  const RTCHit previous = ray.hit;
  const float previous_t = ray.ray.tfar;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(patch.scene(), &context.embree, &ray);
  const bool missed = ray.hit.geomID == RTC_INVALID_GEOMETRY_ID;
  const bool lost_tie = ray.ray.tfar == previous_t && context.patch && context.patch_key < key;
  if (missed || lost_tie) {
    ray.hit = previous;
    return;
  }
  context.patch = &patch;
  context.patch_key = key;
  context.patch_object = context.object;
}

}  // namespace meristem
