#include "geometry/accel/streamed_rays.h"

#include <algorithm>
#include <cmath>

namespace meristem {

namespace {

// Of the angle between two rays: beyond it they part soon.
constexpr float least_cosine = 0.995f;
// A packet costs what a few rays do.
constexpr std::size_t least_packet = 4;

bool are_alike(Vec3f a, Vec3f b) { return dot(a, b) >= least_cosine * std::sqrt(dot(a, a) * dot(b, b)); }

// Of those at the beginning that go as the first does, a packet.
std::span<RayQuery> alike(std::span<RayQuery> queries) {
  const Vec3f first = queries[0].ray->direction;
  std::size_t count = 1;
  while (count < std::min(queries.size(), RayPacket::most) && are_alike(first, queries[count].ray->direction)) ++count;
  return queries.first(count);
}

}  // namespace

class StreamedRays::Aside {
 public:
  Aside(const StreamedRays& rays, const RayQuery& query, RayUse& use)
      : meter_(rays.world_, query.expansions), use_(use), outer_(use.cells) {
    std::size_t count = 0;
    for (const Traveller& other : rays.travellers_)
      if (CacheEntry* const nearest = other.nearest()) {
        used_[count] = {nearest, use.cells};
        use.cells = &used_[count++];
      }
  }
  ~Aside() { use_.cells = outer_; }
  Aside(const Aside&) = delete;
  Aside& operator=(const Aside&) = delete;

 private:
  const ExpansionMeter meter_;
  RayUse& use_;
  const UsedEntry* const outer_;
  std::array<UsedEntry, most_lanes> used_;
};

StreamRay* StreamedRays::next(int lane) {
  Traveller& traveller = travellers_[std::size_t(lane)];
  traveller.end();
  if (next_ == alone_.size()) return nullptr;
  traveller.begin(*alone_[next_++], *this);
  return &traveller;
}

void StreamedRays::trace(bool are_neighbours) {
  alone_.reserve(queries_.size());
  for (std::span<RayQuery> rest = queries_; !rest.empty();) {
    const std::span<RayQuery> group = are_neighbours ? alike(rest) : rest;
    if (are_neighbours && group.size() >= least_packet)
      trace_packet(group);
    else
      for (RayQuery& query : group) alone_.push_back(&query);
    rest = rest.subspan(group.size());
  }
  run();
}

void StreamedRays::trace_packet(std::span<RayQuery> alike) {
  RayPacket packet;
  for (std::size_t i = 0; i < alike.size(); ++i) {
    travellers_[i].begin(alike[i], *this);
    packet.add(travellers_[i]);
  }
  packet.run();
  for (std::size_t i = 0; i < alike.size(); ++i) travellers_[i].end();
}

void StreamedRays::Traveller::begin(RayQuery& query, StreamedRays& rays) {
  rays_ = &rays;
  query_ = &query;
  any = !query.hit;
  tracing_.emplace(*query.ray, rays.recorder_);
  RayContext& context = tracing_->context;
  // What is resident may be in the way, and spare what is not its expansion.
  context.only_resident = any;
  route_ = rays.worlds_.route(*query.ray);
  const RTCRay& ray = tracing_->query.ray;
  objects_ = context.visits ? nullptr : route_->only();
  at_ = count_ = 0;
  if (!objects_) return;
  const auto few = objects_->entered(*context.tree_ray, ray.tnear, ray.tfar, entered_);
  if (few)
    count_ = *few;
  else
    objects_ = nullptr;
}

void StreamedRays::Traveller::go_alone() {
  RayContext& context = tracing_->context;
  const Aside aside(*rays_, *query_, context.use);
  if (any)
    route_->occluded(context, tracing_->query.ray);
  else
    route_->intersect(context, tracing_->query);
}

void StreamedRays::Traveller::go_alone_into(Instance::Visit& visit) {
  RayContext& context = tracing_->context;
  const Aside aside(*rays_, *query_, context.use);
  if (any)
    visit.root().occluded(context, visit.ray().ray);
  else
    visit.root().intersect(context, visit.ray());
}

bool StreamedRays::Traveller::next(Leg& leg) {
  visit_.reset();
  if (!objects_) {
    if (at_++ == 0) go_alone();
    return false;
  }
  RayContext& context = tracing_->context;
  while (!has_ended() && at_ < count_ && entered_[at_].t <= tracing_->query.ray.tfar) {
    const std::uint32_t index = entered_[at_++].box;
    visit_.emplace(objects_->instance(index), objects_->place_of(index), context, tracing_->query);
    if ((passage_ = visit_->root().passage())) {
      const RTCRay& ray = visit_->ray().ray;
      leg = passage_->leg();
      leg.ray = context.tree_ray;
      leg.t_min = ray.tnear;
      t_max = ray.tfar;
      return true;
    }
    go_alone_into(*visit_);
    visit_.reset();
  }
  return false;
}

void StreamedRays::Traveller::met(std::uint32_t tree, const TreeHit& hit) {
  RTCRay& ray = visit_->ray().ray;
  if (any)
    ray.tfar = -std::numeric_limits<float>::infinity();
  else
    passage_->met(tree, hit, tracing_->context, ray);
  t_max = ray.tfar;
}

void StreamedRays::Traveller::enter(std::uint32_t other) {
  RayContext& context = tracing_->context;
  const Aside aside(*rays_, *query_, context.use);
  if (any)
    passage_->occlude_other(other, context, visit_->ray().ray);
  else
    passage_->intersect_other(other, context, visit_->ray());
  t_max = visit_->ray().ray.tfar;
}

// The answer of the ray that had the lane, if there was one.
void StreamedRays::Traveller::end() {
  if (!tracing_) return;
  RayContext& context = tracing_->context;
  if (any) {
    if (!has_ended() && context.has_passed_by) {
      context.only_resident = false;
      go_alone();
    }
    query_->met = has_ended();
  } else {
    query_->met = context.patch != nullptr;
    if (context.patch) tracing_->surface_hit(*query_->hit);
  }
  rays_->acquired_ += context.acquired;
  tracing_.reset();
}

}  // namespace meristem
