#include "renderer/session/path_batch.h"

#include <chrono>
#include <utility>

namespace meristem {

struct PathBatch::Slot {
  std::uint32_t dimension = 0;  // of random numbers
  int weight = 0;
  bool covered = true;
  bool asks[PathStepper::most_rays] = {};  // one of the queries
};

struct PathBatch::Cost {
  ThreadExpansions expansions;
  double nanoseconds = 0;  // its share of the time beside these
  std::uint32_t rays = 0;  // at this vertex
};

PathBatch::PathBatch(const Scene& scene, const CameraPaths& camera, PathWants wants)
    : scene_(scene),
      stepper_(*scene.integrator->stepper()),
      camera_(camera),
      state_words_((stepper_.state_bytes() + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t)),
      states_(std::make_unique<std::max_align_t[]>(most * state_words_)),
      slots_(most),
      first_(wants.first_surface ? most : 0),
      costs_(wants.costs ? most : 0),
      hits_(most * PathStepper::most_rays) {}

PathBatch::~PathBatch() = default;

void PathBatch::follow(Sampler& sampler, RayCounts& rays) {
  std::uint64_t since = costs_.empty() ? 0 : tracing_clock();
  alive_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    begin(i, sampler, rays);
    alive_.push_back(i);
  }
  for (bool are_of_camera = true;; are_of_camera = false) {
    queries_.clear();
    std::erase_if(alive_, [this](std::size_t i) { return !ask(i); });
    if (alive_.empty()) return;
    scene_.intersector->trace(queries_, are_of_camera);
    const RayQuery* answers = queries_.data();
    for (const std::size_t i : alive_) answer(i, answers, sampler, rays);
    if (!costs_.empty()) share_time(since);
  }
}

PathTools PathBatch::tools(std::size_t i, Sampler& sampler, RayCounts& rays) {
  return {scene_, sampler, rays, first_.empty() ? nullptr : &first_[i]};
}

void PathBatch::begin(std::size_t i, Sampler& sampler, RayCounts& rays) {
  const CameraPaths::Start start = camera_.start(samples_[i], sampler);
  if (!first_.empty()) {
    first_[i] = {};
    first_[i].time = start.ray.time;
  }
  if (!costs_.empty()) costs_[i] = {};
  stepper_.begin(state(i), start.ray, tools(i, sampler, rays));
  slots_[i] = {.dimension = sampler.dimension(), .weight = start.weight};
}

RayQuery PathBatch::query(std::size_t i, int ray, const RayRequest& request) {
  RayQuery query{.ray = &request.ray, .hit = request.kind == RayRequest::Kind::Any ? nullptr : &hit(i, ray)};
  if (!costs_.empty()) {
    ++costs_[i].rays;
    query.expansions = &costs_[i].expansions;
  }
  return query;
}

// In nanoseconds; stands still while the thread waits for cells.
std::uint64_t PathBatch::tracing_clock() const {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::uint64_t(std::chrono::nanoseconds(now).count()) - scene_.intersector->thread_expansions().nanoseconds;
}

void PathBatch::share_time(std::uint64_t& since) {
  const std::uint64_t now = tracing_clock();
  std::uint32_t rays = 0;
  for (const std::size_t i : alive_) rays += costs_[i].rays;
  const double each = double(now - since) / rays;
  for (const std::size_t i : alive_) costs_[i].nanoseconds += each * std::exchange(costs_[i].rays, 0);
  since = now;
}

// False: the path has ended.
bool PathBatch::ask(std::size_t i) {
  bool asks = false;
  for (int ray = 0; ray < PathStepper::most_rays; ++ray) {
    const RayRequest request = stepper_.request(state(i), ray);
    slots_[i].asks[ray] = request.kind != RayRequest::Kind::None;
    if (!slots_[i].asks[ray]) continue;
    queries_.push_back(query(i, ray, request));
    asks = true;
  }
  return asks;
}

void PathBatch::answer(std::size_t i, const RayQuery*& answers, Sampler& sampler, RayCounts& rays) {
  Slot& slot = slots_[i];
  const PixelSample& sample = samples_[i];
  sampler.start(sample.x, sample.y, int(sample.number), scene_.settings.seed);
  sampler.go_to(slot.dimension);
  const PathTools with = tools(i, sampler, rays);
  const std::uint64_t escaped = rays.escaped;
  if (slot.asks[0]) meet_light(i, answers++->met, with);
  if (slot.asks[1]) stepper_.answer(state(i), 1, answers++->met, hit(i, 1), with);
  slot.covered = slot.covered && rays.escaped == escaped;
  slot.dimension = sampler.dimension();
}

// What dims the light, one after the other: that is answered before the ray that goes on.
void PathBatch::meet_light(std::size_t i, bool met, const PathTools& tools) {
  stepper_.answer(state(i), 0, met, hit(i, 0), tools);
  while (true) {
    const RayRequest request = stepper_.request(state(i), 0);
    if (request.kind == RayRequest::Kind::None) return;
    RayQuery next = query(i, 0, request);
    scene_.intersector->trace_alone(next);
    stepper_.answer(state(i), 0, next.met, hit(i, 0), tools);
  }
}

FilmSample PathBatch::result(std::size_t i) const {
  FilmSample sample{.radiance = stepper_.result(state(i)),
                    .covered = slots_[i].covered,
                    .weight = slots_[i].weight,
                    .number = samples_[i].number};
  if (!first_.empty()) sample.first = &first_[i];
  if (!costs_.empty()) {
    sample.expansions = costs_[i].expansions;
    sample.nanoseconds = std::uint64_t(costs_[i].nanoseconds) + sample.expansions.nanoseconds;
  }
  camera_.measure(sample);
  return sample;
}

}  // namespace meristem
