#include "geometry/accel/search_driver.h"

namespace meristem {

namespace {

// Their memory is used again: no ray allocates.
thread_local std::vector<std::uint32_t> way_of_thread, target;

}  // namespace

SearchDriver::SearchDriver(RaySearch& search, bool any, RayContext& context, RTCRayHit& ray)
    : search_(search), context_(context), ray_(ray), state_{search.missing_, way_of_thread, any} {
  state_.way.clear();
  context.search = &state_;
  if (!search.has_hit_) return;
  context.has_hit = true;
  context.patch_key = search.hit_key_;
  ray.ray.tfar = search.kept_->t;
}

RaySearch::End SearchDriver::go_on(const RayRoute& route) {
  if (search_.waits_) {
    state_.expands = true;
  } else if (state_.any) {
    route.occluded(context_, ray_.ray);
  } else {
    route.intersect(context_, ray_);
  }
  while (!has_ended() && !overflows()) {
    const std::size_t cell = search_.missing_.first(ray_.ray.tfar);
    if (cell == MissingCells::none) return context_.has_hit ? RaySearch::End::Met : RaySearch::End::Missed;
    if (!visit(route, cell)) {
      search_.name_ = search_.missing_.name(cell);
      return RaySearch::End::Waits;
    }
    search_.missing_.remove(cell);
    state_.expands = false;
  }
  return RaySearch::End::Met;
}

bool SearchDriver::visit(const RayRoute& route, std::size_t cell) {
  const MissingCells::Way way = search_.missing_.way(cell);
  target.assign(way.begin(), way.end());  // the list grows while it is followed
  return route.follow(target, context_, ray_);
}

void SearchDriver::keep(const SurfaceHit* nearer) {
  search_.waits_ = true;
  if (!nearer) return;
  if (search_.kept_)
    *search_.kept_ = *nearer;
  else
    search_.kept_ = std::make_unique<SurfaceHit>(*nearer);
  search_.has_hit_ = true;
  search_.hit_key_ = context_.patch_key;
}

void SearchDriver::end() {
  constexpr std::size_t most_kept_bytes = 1024;
  search_.missing_.clear();
  if (search_.missing_.bytes() > most_kept_bytes) search_.missing_ = {};
  search_.waits_ = search_.has_hit_ = false;
}

}  // namespace meristem
