// IndividualBounds: the bounds of individuals of one part, as they were derived of late (Step::derive, some 0.3 ms for
// a tree). Who counts on how far trees may reach asks for the same ones as who places them. Any thread.
#pragma once

#include "geometry/base/bounds.h"
#include "geometry/base/key.h"

#include <bit>
#include <mutex>
#include <unordered_map>

namespace meristem {

class IndividualBounds {
 public:
  static constexpr std::size_t most_known = 1 << 13;  // some 0.5 MB; when there are as many all are forgotten

  // An individual, and as what it is seen: a constant footprint.
  struct Name {
    Key individual;
    double size;
    bool fades;
    bool operator==(const Name&) const = default;
  };

  // Those that were made of that name, or what make() makes now: always the same, so that several threads may make it.
  template <class Make>
  Bounds3f get(const Name& name, const Make& make) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto it = known_.find(name); it != known_.end()) return it->second;
    }
    const Bounds3f bounds = make();
    const std::lock_guard lock(mutex_);
    if (known_.size() >= most_known) known_.clear();
    known_.emplace(name, bounds);
    return bounds;
  }

 private:
  struct Hash {
    std::size_t operator()(const Name& n) const { return hash_keys(n.individual, std::bit_cast<Key>(n.size), n.fades); }
  };

  std::mutex mutex_;
  std::unordered_map<Name, Bounds3f, Hash> known_;  // guarded by mutex_
};

}  // namespace meristem
