#include "geometry/accel/search_driver.h"

#include <limits>

namespace meristem {

namespace {

// Their memory is used again: no ray allocates.
thread_local std::vector<std::uint32_t> way_of_thread, target;
thread_local MissingCells missing_of_thread;

}  // namespace

SearchDriver::SearchDriver(RaySearch& search, bool any, RayContext& context, RTCRayHit& ray)
    : search_(search), missing_(missing_of_thread), context_(context), ray_(ray), state_{missing_, way_of_thread, any} {
  state_.way.clear();
  missing_.restore(search.missing_);
  context.search = &state_;
  if (!search.nearest_) return;
  context.has_hit = true;
  context.patch_key = search.hit_key_;
  ray.ray.tfar = search.nearest_->t;
}

RaySearch::End SearchDriver::go_on(const RayRoute& route, const GeometryCache& cache) {
  if (search_.waits_) {
    state_.expands = true;
    visit(route, [&](std::size_t cell) { return missing_.name(cell) == search_.woken_for_; });
    state_.expands = false;
    // What else has become resident meanwhile
    visit(route, [&](std::size_t cell) { return cache.may_hold(missing_.name(cell)); });
  } else if (state_.any) {
    route.occluded(context_, ray_.ray);
  } else {
    route.intersect(context_, ray_);
  }
  if (has_ended() || overflows()) return RaySearch::End::Met;
  MissingCells::Names names;
  if (missing_.first(ray_.ray.tfar, names) == 0) return context_.has_hit ? RaySearch::End::Met : RaySearch::End::Missed;
  search_.woken_for_ = names[0];
  return RaySearch::End::Waits;
}

template <class IsAsked>
void SearchDriver::visit(const RayRoute& route, IsAsked is_asked) {
  for (std::size_t cell = 0; cell < missing_.end(); cell = missing_.next(cell)) {
    if (has_ended() || overflows()) return;
    if (missing_.is_removed(cell) || !(missing_.entry(cell) <= ray_.ray.tfar) || !is_asked(cell)) continue;
    const MissingCells::Way way = missing_.way(cell);
    target.assign(way.begin(), way.end());  // the list grows while it is followed
    if (route.follow(target, context_, ray_)) missing_.remove(cell);
  }
}

void SearchDriver::keep(const SurfaceHit* nearer) {
  search_.waits_ = true;
  search_.missing_ = missing_.kept(ray_.ray.tfar);
  if (!nearer) return;
  if (search_.nearest_)
    *search_.nearest_ = *nearer;
  else
    search_.nearest_ = std::make_unique<SurfaceHit>(*nearer);
  search_.hit_key_ = context_.patch_key;
}

}  // namespace meristem
