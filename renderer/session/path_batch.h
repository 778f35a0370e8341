// PathBatch: paths that one thread follows together, vertex by vertex, so that their rays are traced together. Each
// ends with the bits of one that is followed alone.
//
// What paths cost is measured vertex by vertex, of all together: the rays of all paths share the time equally, but for
// that in which cells were expanded, which is of the path whose ray they stood in the way of.
#pragma once

#include "renderer/session/camera_paths.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace meristem {

class PathBatch {
 public:
  static constexpr std::size_t most = 128;  // enough that few lanes of a stream are ever empty

  // The scene's integrator has a stepper. All must outlive it.
  PathBatch(const Scene& scene, const CameraPaths& camera, PathWants wants);
  ~PathBatch();

  bool is_full() const { return samples_.size() == most; }
  void add(const PixelSample& sample) { samples_.push_back(sample); }  // not if it is full
  // Follows all to their ends, hands them over by deliver(const PixelSample&, const FilmSample&) in the order in which
  // they came, and is empty.
  template <class Deliver>
  void finish(Sampler& sampler, RayCounts& rays, const Deliver& deliver) {
    follow(sampler, rays);
    for (std::size_t i = 0; i < samples_.size(); ++i) deliver(samples_[i], result(i));
    samples_.clear();
  }

 private:
  struct Slot;
  struct Cost {
    ThreadExpansions expansions;
    double nanoseconds = 0;  // its share of the time beside these
    std::uint32_t rays = 0;  // that were traced to this vertex
  };
  using Answers = std::array<const RayQuery*, PathStepper::most_rays>;  // the next of each kind

  void follow(Sampler& sampler, RayCounts& rays);
  void begin(std::size_t i, Sampler& sampler, RayCounts& rays);
  bool ask(std::size_t i);
  Answers trace_asked(bool are_neighbours);
  void answer(std::size_t i, Answers& answers, Sampler& sampler, RayCounts& rays);
  void meet_light(std::size_t i, bool met, const PathTools& tools);
  RayQuery query(std::size_t i, int ray, const RayRequest& request) {
    return {.ray = &request.ray,
            .hit = request.kind == RayRequest::Kind::Any ? nullptr : &point(i, ray).hit,
            .expansions = costs_.empty() ? nullptr : &costs_[i].expansions};
  }
  ShadingPoint& point(std::size_t i, int ray) { return points_[i * PathStepper::most_rays + std::size_t(ray)]; }
  FilmSample result(std::size_t i) const;
  std::uint64_t tracing_clock() const;
  void share_time(std::uint64_t& since);
  PathTools tools(std::size_t i, Sampler& sampler, RayCounts& rays) {
    return {scene_, sampler, rays, first_.empty() ? nullptr : &first_[i]};
  }
  void* state(std::size_t i) const { return &states_[i * state_words_]; }

  const Scene& scene_;
  const PathStepper& stepper_;
  const CameraPaths& camera_;
  const std::size_t state_words_;
  std::vector<PixelSample> samples_;
  std::unique_ptr<std::max_align_t[]> states_;
  std::vector<Slot> slots_;
  std::vector<FirstSurface> first_;  // none: they are not wanted
  std::vector<Cost> costs_;          // nor these
  std::vector<std::size_t> alive_;
  std::vector<ShadingPoint> points_;                                 // that each path's rays meet
  std::array<std::vector<RayQuery>, PathStepper::most_rays> asked_;  // of the paths alive, in their order
  std::vector<RayQuery> traced_;
};

}  // namespace meristem
