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
  steps_.reset();
  if (!context.visits) steps_.emplace(*route_);
  at_ = count_ = 0;
}

// Finds a leg through all objects of the next world, or lists those that may be entered, or goes through it alone.
bool StreamedRays::Traveller::enter_class_world(Leg& leg) {
  RayContext& context = tracing_->context;
  RTCRay& ray = tracing_->query.ray;
  if (steps_->is_last()) {
    if (class_world_->braided) {
      find_leg(*class_world_->braided, visited_[0], leg);
      return true;
    }
    if (const auto few = class_world_->objects->entered(*context.tree_ray, ray.tnear, ray.tfar, entered_)) {
      count_ = *few;
      return false;
    }
  }
  const Aside aside(*rays_, *query_, context.use);
  if (any)
    class_world_->objects->occluded(context, ray);
  else
    class_world_->objects->intersect(context, tracing_->query);
  return false;
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
  visited_[0].visit.reset();
  if (!steps_) {
    if (at_++ == 0) go_alone();
    return false;
  }
  for (;;) {
    while (!has_ended() && at_ < count_ && entered_[at_].t <= tracing_->query.ray.tfar)
      if (visit(*class_world_->objects, entered_[at_++].box, tracing_->query, visited_[0], leg)) return true;
    at_ = count_ = 0;
    if (!(class_world_ = steps_->next(tracing_->query.ray, has_met()))) return false;
    if (enter_class_world(leg)) return true;
  }
}

// Finds a leg in an instance, or goes through it alone: then false.
bool StreamedRays::Traveller::visit(const Instances& all, std::uint32_t index, RTCRayHit& outside, Visited& visited,
                                    Leg& leg) {
  visited.visit.emplace(all.instance(index), all.place_of(index), tracing_->context, outside);
  if (const Passage* const passage = visited.visit->root().passage()) {
    find_leg(*passage, visited, leg);
    return true;
  }
  go_alone_into(*visited.visit);
  visited.visit.reset();
  return false;
}

void StreamedRays::Traveller::find_leg(const Passage& passage, Visited& visited, Leg& leg) {
  const RTCRay& ray = visited.visit ? visited.visit->ray().ray : tracing_->query.ray;
  visited.passage = &passage;
  leg = passage.leg();
  leg.ray = tracing_->context.tree_ray;
  leg.t_min = ray.tnear;
  t_max = ray.tfar;
}

void StreamedRays::Traveller::met(std::uint32_t tree, const TreeHit& hit) {
  if (any)
    ray().tfar = -std::numeric_limits<float>::infinity();
  else
    visited_[nested_].passage->met(tree, hit, tracing_->context, ray());
  t_max = ray().tfar;
}

void StreamedRays::Traveller::enter(std::uint32_t other) {
  RayContext& context = tracing_->context;
  const Aside aside(*rays_, *query_, context.use);
  Visited& here = visited_[nested_];
  if (any)
    here.passage->occlude_other(other, context, query().ray);
  else
    here.passage->intersect_other(other, context, query());
  t_max = ray().tfar;
}

bool StreamedRays::Traveller::enter(std::uint32_t other, Leg& inside) {
  Visited& here = visited_[nested_];
  const Passage::Placed placed = here.passage->placed(other);
  if (!placed.all) {
    enter(other);
    return false;
  }
  if (visit(*placed.all, placed.index, query(), visited_[nested_ + 1], inside)) {
    ++nested_;
    return true;
  }
  t_max = ray().tfar;
  return false;
}

void StreamedRays::Traveller::leave() {
  visited_[nested_--].visit.reset();
  t_max = ray().tfar;
}

// The answer of the ray that had the lane, if there was one.
void StreamedRays::Traveller::end() {
  if (!tracing_) return;
  RayContext& context = tracing_->context;
  if (steps_) steps_->end(tracing_->query.ray);
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
