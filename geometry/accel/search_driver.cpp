#include "geometry/accel/search_driver.h"

#include <limits>

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
  MissingCells& missing = search_.missing_;
  if (search_.waits_) {
    state_.expands = true;
    visit(route, [&](std::size_t cell) { return missing.name(cell) == search_.woken_for_; });
    state_.expands = false;
  } else if (state_.any) {
    route.occluded(context_, ray_.ray);
  } else {
    route.intersect(context_, ray_);
  }
  visit(route, [](std::size_t) { return true; });
  if (has_ended() || overflows()) return RaySearch::End::Met;
  const std::size_t count = missing.first(ray_.ray.tfar, search_.names_);
  search_.name_count_ = std::uint8_t(count);
  if (count == 0) return context_.has_hit ? RaySearch::End::Met : RaySearch::End::Missed;
  search_.woken_for_ = search_.names_[0];
  missing.compact();
  return RaySearch::End::Waits;
}

template <class IsAsked>
void SearchDriver::visit(const RayRoute& route, IsAsked is_asked) {
  MissingCells& missing = search_.missing_;
  for (std::size_t cell = 0; cell < missing.end(); cell = missing.next(cell)) {
    if (has_ended() || overflows()) return;
    const float entry = missing.entry(cell);
    if (entry == std::numeric_limits<float>::infinity() || !(entry <= ray_.ray.tfar) || !is_asked(cell)) continue;
    const MissingCells::Way way = missing.way(cell);
    target.assign(way.begin(), way.end());  // the list grows while it is followed
    if (route.follow(target, context_, ray_)) missing.remove(cell);
  }
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
  constexpr std::size_t most_kept_bytes = 256;
  search_.missing_.clear();
  if (search_.missing_.bytes() > most_kept_bytes) search_.missing_ = {};
  search_.waits_ = search_.has_hit_ = false;
}

}  // namespace meristem
