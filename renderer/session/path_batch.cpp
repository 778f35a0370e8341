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

PathBatch::PathBatch(const Scene& scene, const CameraPaths& camera, PathWants wants)
    : scene_(scene),
      stepper_(*scene.integrator->stepper()),
      camera_(camera),
      state_words_((stepper_.state_bytes() + sizeof(std::max_align_t) - 1) / sizeof(std::max_align_t)),
      states_(std::make_unique<std::max_align_t[]>(most * state_words_)),
      slots_(most),
      first_(wants.first_surface ? most : 0),
      costs_(wants.costs ? most : 0),
      points_(most * PathStepper::most_rays) {}

PathBatch::~PathBatch() = default;

// A path asks for its next rays while its state is at hand.
void PathBatch::follow(Sampler& sampler, RayCounts& rays) {
  std::uint64_t since = costs_.empty() ? 0 : tracing_clock();
  alive_.clear();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    begin(i, sampler, rays);
    if (ask(i)) alive_.push_back(i);
  }
  for (int vertex = 0; !alive_.empty(); ++vertex) {
    Answers answers = trace_asked(vertex < 2);
    std::erase_if(alive_, [&](std::size_t i) {
      answer(i, answers, sampler, rays);
      return !ask(i);
    });
    if (!costs_.empty()) share_time(since);
  }
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

// In nanoseconds; stands still while the thread waits for cells.
std::uint64_t PathBatch::tracing_clock() const {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::uint64_t(std::chrono::nanoseconds(now).count()) - scene_.intersector->thread_expansions().nanoseconds;
}

void PathBatch::share_time(std::uint64_t& since) {
  const std::uint64_t now = tracing_clock();
  const double each = double(now - since) / double(traced_.size());
  for (std::size_t i = 0; i < samples_.size(); ++i) costs_[i].nanoseconds += each * std::exchange(costs_[i].rays, 0);
  since = now;
}

// The rays to the lights first: from what neighbouring pixels show these go nearly the same way.
PathBatch::Answers PathBatch::trace_asked(bool are_neighbours) {
  traced_.clear();
  std::array<std::size_t, PathStepper::most_rays> first;
  for (std::size_t ray = 0; ray < first.size(); ++ray) {
    first[ray] = traced_.size();
    traced_.insert(traced_.end(), asked_[ray].begin(), asked_[ray].end());
    asked_[ray].clear();
  }
  scene_.intersector->trace(traced_, are_neighbours);
  Answers answers;
  for (std::size_t ray = 0; ray < first.size(); ++ray) answers[ray] = traced_.data() + first[ray];
  return answers;
}

// False: the path has ended.
bool PathBatch::ask(std::size_t i) {
  bool asks = false;
  for (int ray = 0; ray < PathStepper::most_rays; ++ray) {
    const RayRequest request = stepper_.request(state(i), ray);
    slots_[i].asks[ray] = request.kind != RayRequest::Kind::None;
    if (!slots_[i].asks[ray]) continue;
    asked_[std::size_t(ray)].push_back(query(i, ray, request));
    asks = true;
  }
  return asks;
}

void PathBatch::answer(std::size_t i, Answers& answers, Sampler& sampler, RayCounts& rays) {
  Slot& slot = slots_[i];
  const PixelSample& sample = samples_[i];
  sampler.start(sample.x, sample.y, int(sample.number), scene_.settings.seed);
  sampler.go_to(slot.dimension);
  const PathTools with = tools(i, sampler, rays);
  const std::uint64_t escaped = rays.escaped;
  if (!costs_.empty()) costs_[i].rays = std::uint32_t(slot.asks[0]) + slot.asks[1];
  if (slot.asks[0]) meet_light(i, answers[0]++->met, with);
  if (slot.asks[1]) stepper_.answer(state(i), 1, answers[1]++->met, point(i, 1), with);
  slot.covered = slot.covered && rays.escaped == escaped;
  slot.dimension = sampler.dimension();
}

// What dims the light, one after the other: that is answered before the ray that goes on.
void PathBatch::meet_light(std::size_t i, bool met, const PathTools& tools) {
  stepper_.answer(state(i), 0, met, point(i, 0), tools);
  while (true) {
    const RayRequest request = stepper_.request(state(i), 0);
    if (request.kind == RayRequest::Kind::None) return;
    RayQuery next = query(i, 0, request);
    scene_.intersector->trace_alone(next);
    stepper_.answer(state(i), 0, next.met, point(i, 0), tools);
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
