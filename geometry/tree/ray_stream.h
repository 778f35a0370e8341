// RayStream: many rays that go through trees and braids in turns, one node each, on one thread.
//
// A ray alone waits at each node: for the node to come from memory, for its boxes to be tested, for a branch that was
// guessed wrongly. Here the boxes of up to `most_lanes` rays are tested one after another, and none of these tests
// waits for another; then each ray chooses where it goes on, and what it will need is fetched while the others are
// tested. What a ray meets does not depend on the rays beside it.
#pragma once

#include "geometry/tree/braid.h"
#include "geometry/tree/surface_tree.h"

#include <cstdint>

namespace meristem {

// A ray of a stream: where it goes, and what it does with what it meets.
class StreamRay {
 public:
  // A part of its way: through a braid, or where `nodes` is null through one tree.
  struct Leg {
    const TreeRay* ray = nullptr;
    float t_min = 0;
    Braid::View braid{nullptr, nullptr};
    Braid::Strand tree{};
  };
  // Where to go next; false: the ray has arrived. Called at first and after each leg.
  virtual bool next(Leg& leg) = 0;
  // What is met in a leg, as BraidVisitor has it.
  virtual void met(std::uint32_t tree, const TreeHit& hit) = 0;
  virtual void enter(std::uint32_t other) = 0;
  // The same, if it returns false. True: there is a leg inside, to be gone until leave(), up to `most_nested` one in
  // the other. What is met until then is met there.
  virtual bool enter(std::uint32_t other, Leg& inside) {
    (void)inside;
    enter(other);
    return false;
  }
  virtual void leave() {}
  static constexpr std::size_t most_nested = 2;

  float t_max = 0;   // the end of the ray
  bool any = false;  // it asks whether anything is met: then t_max becomes less than 0, and it goes no further

 protected:
  ~StreamRay() = default;
};

class RayStream {
 public:
  static constexpr int most_lanes = 16;
  // The ray that takes a lane, from 0 on, when the one before has arrived; null: there is no more.
  virtual StreamRay* next(int lane) = 0;
  // Until all have arrived.
  void run();

 protected:
  ~RayStream() = default;
};

}  // namespace meristem
