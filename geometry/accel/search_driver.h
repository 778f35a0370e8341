// SearchDriver: one call that carries a RaySearch on, between the search that waits and Embree's callbacks.
#pragma once

#include "geometry/accel/class_worlds.h"

namespace meristem {

class SearchDriver {
 public:
  // Puts the nearest hit so far into the ray. All must outlive it.
  SearchDriver(RaySearch& search, bool any, RayContext& context, RTCRayHit& ray);
  SearchDriver(const SearchDriver&) = delete;
  SearchDriver& operator=(const SearchDriver&) = delete;

  RaySearch::End go_on(const RayRoute& route, const GeometryCache& cache);
  // The search has no end: it would have to wait for too many cells.
  bool overflows() const { return missing_.overflows(); }

  // Before it waits; `nearer`: a hit that this call found, or nullptr.
  void keep(const SurfaceHit* nearer);
  // The nearest hit, if it is none of this call.
  const SurfaceHit& kept() const { return search_.nearest_->hit; }
  // Makes the search as new.
  void end() { search_ = {}; }

 private:
  bool has_ended() const { return state_.any && ray_.ray.tfar < 0; }
  // The known cell that comes first, once all before it have been visited or left out; the list's end if there is none.
  std::size_t settle_nearest(const RayRoute& route);
  // Noted cells that are asked for, as far as they are resident or it expands.
  template <class IsAsked>
  void visit(const RayRoute& route, IsAsked is_asked);

  RaySearch& search_;
  MissingCells& missing_;
  RayContext& context_;
  RTCRayHit& ray_;
  RayContext::Search state_;
};

}  // namespace meristem
