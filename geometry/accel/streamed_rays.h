// StreamedRays: rays of one thread that go through the world together.
//
// Those that go nearly the same way go through it as packets, others as a stream. Their ways lead through braided cells
// and flat surfaces of the world's objects, and of what is placed in these. What is not resident, or placed deeper than
// legs nest, each enters by itself while the others wait.
#pragma once

#include "geometry/accel/class_worlds.h"
#include "geometry/accel/intersector.h"
#include "geometry/accel/tracing.h"
#include "geometry/tree/ray_packet.h"

#include <array>
#include <optional>
#include <span>

namespace meristem {

class StreamedRays final : public RayStream {
 public:
  // Answers the queries in trace(), within one visit to the cache. All must outlive it. Rays must be finite and have a
  // direction. `are_neighbours`: as Intersector::trace() has it.
  StreamedRays(const Intersector& world, const ClassWorlds& worlds, ExpansionRecorder* recorder,
               std::span<RayQuery> queries)
      : world_(world), worlds_(worlds), recorder_(recorder), queries_(queries) {}

  void trace(bool are_neighbours);
  std::uint64_t acquired() const { return acquired_; }  // cells that were asked for, by all

 private:
  class Traveller final : public StreamRay {
   public:
    void begin(RayQuery& query, StreamedRays& rays);
    void end();

    bool next(Leg& leg) override;
    void met(std::uint32_t tree, const TreeHit& hit) override;
    void enter(std::uint32_t other) override;
    bool enter(std::uint32_t other, Leg& inside) override;
    void leave() override;

    CacheEntry* nearest() const { return tracing_ ? tracing_->context.use.nearest : nullptr; }

   private:
    struct Visited {
      std::optional<Instance::Visit> visit;  // none: of the world
      const Passage* passage = nullptr;
    };
    bool has_met() const { return any ? has_ended() : tracing_->context.has_hit; }
    bool has_ended() const { return any && tracing_->query.ray.tfar < 0; }
    bool visit(const Instances& all, std::uint32_t index, RTCRayHit& outside, Visited& visited, Leg& leg);
    bool enter_class_world(Leg& leg);
    void find_leg(const Passage& passage, Visited& visited, Leg& leg);
    void go_alone();
    void go_alone_into(Instance::Visit& visit);
    RTCRayHit& query() {  // in the frame in which it is
      Visited& here = visited_[nested_];
      return here.visit ? here.visit->ray() : tracing_->query;
    }
    RTCRay& ray() { return query().ray; }

    StreamedRays* rays_ = nullptr;
    RayQuery* query_ = nullptr;
    std::optional<Tracing> tracing_;
    std::optional<RayRoute> route_;
    std::optional<RayRoute::Steps> steps_;     // none: it goes alone
    const ClassWorld* class_world_ = nullptr;  // in which it is
    FewBoxes::List entered_;
    std::size_t count_ = 0, at_ = 0;                // of these
    std::array<Visited, 1 + most_nested> visited_;  // an object, and instances one in the other
    std::size_t nested_ = 0;                        // so many instances
  };

  StreamRay* next(int lane) override;
  void trace_packet(std::span<RayQuery> alike);

  // While one goes by itself: what others have met stays, and what is expanded is counted for it.
  class Aside;

  const Intersector& world_;
  const ClassWorlds& worlds_;
  ExpansionRecorder* const recorder_;
  const std::span<RayQuery> queries_;
  std::vector<RayQuery*> alone_;  // that no packet has taken; the next
  std::size_t next_ = 0;
  std::uint64_t acquired_ = 0;
  std::array<Traveller, most_lanes> travellers_;
};

}  // namespace meristem
