#include "geometry/accel/search_driver.h"

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
  context.kept_rank = search.nearest_->rank;
  ray.ray.tfar = search.nearest_->hit.t;
}

RaySearch::End SearchDriver::go_on(const RayRoute& route, const GeometryCache& cache) {
  if (search_.waits()) {
    state_.expands = true;
    visit(route, [&](const CellList& list, std::size_t cell) { return list.name(cell) == search_.woken_for_; });
    state_.expands = false;
    // What else has become resident meanwhile, or known
    visit(route, [&](const CellList& list, std::size_t cell) {
      return cache.may_hold(list.name(cell)) || !list.is_known(cell);
    });
  } else if (state_.any) {
    route.occluded(context_, ray_.ray);
  } else {
    route.intersect(context_, ray_);
  }
  const std::size_t nearest = settle_nearest(route);
  if (has_ended() || overflows()) return RaySearch::End::Met;
  if (nearest == missing_.list().end()) return context_.has_hit ? RaySearch::End::Met : RaySearch::End::Missed;
  search_.woken_for_ = missing_.list().name(nearest);
  if (context_.patch) context_.kept_rank = rank_of_hit(context_);
  return RaySearch::End::Waits;
}

// Of a known cell it is asked whether the ray enters its outline, and where, unless its parent is not there. What a
// cell that was never expanded is like nobody knows, and its box is wide; waiting rays would note hundreds of them. It
// has to be expanded once in any case, so the first ray that certainly needs it does not wait.
std::size_t SearchDriver::settle_nearest(const RayRoute& route) {
  while (!has_ended() && !overflows()) {
    const std::size_t nearest = missing_.list().nearest(ray_.ray.tfar);
    if (nearest == missing_.list().end()) return nearest;
    const bool is_known = missing_.list().is_known(nearest);
    if (is_known && missing_.list().is_exact(nearest)) return nearest;
    state_.expands = !is_known;
    visit(route, [&](const CellList&, std::size_t cell) { return cell == nearest; });
    state_.expands = false;
    if (is_known && !missing_.list().is_removed(nearest)) return nearest;
  }
  return missing_.list().end();
}

template <class IsAsked>
void SearchDriver::visit(const RayRoute& route, IsAsked is_asked) {
  for (std::size_t cell = 0; cell < missing_.list().end(); cell = missing_.list().next(cell)) {
    if (has_ended() || overflows()) return;
    const CellList list = missing_.list();
    if (list.is_removed(cell) || !(list.entry(cell) <= ray_.ray.tfar) || !is_asked(list, cell)) continue;
    const CellList::Way way = list.way(cell);
    target.assign(way.begin(), way.end());  // the list grows while it is followed
    state_.is_exact = list.is_known(cell) && list.is_exact(cell);
    if (route.follow(target, context_, ray_)) missing_.remove(cell);
  }
}

void SearchDriver::keep(const SurfaceHit* nearer) {
  search_.missing_.assign(missing_.list(), ray_.ray.tfar);
  if (!nearer) return;
  if (!search_.nearest_) search_.nearest_ = std::make_unique<RaySearch::Nearest>();
  *search_.nearest_ = {*nearer, context_.kept_rank};
}

}  // namespace meristem
