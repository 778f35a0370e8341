// PlanTable: index tables that follow from a mesh's topology and creases alone, kept by shape and shared by all cells
// of that shape. Any thread may look up and add; a table holds at most a fixed number of bytes.
#pragma once

#include "geometry/mesh/mesh.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

namespace meristem {

// Two 64-bit hashes with different seeds name a shape: a clash would need 2^64 shapes before it grew likely.
struct ShapeName {
  Key first, second;
  bool operator==(const ShapeName&) const = default;
};

// The shape of a mesh whose first owned_faces are owned: its faces and sharpness, with `options`: whatever else the
// table in question depends on. About 10 ns a face.
ShapeName shape_name(const Mesh& mesh, std::uint32_t owned_faces, std::uint64_t options);

// `Plan` has bytes().
template <class Plan, std::size_t most = std::size_t(4) << 20>
class PlanTable {
 public:
  static constexpr std::size_t most_bytes = most;

  // The plan of a shape; made by make() if the table does not hold it.
  template <class Make>
  std::shared_ptr<const Plan> get(const ShapeName& name, Make make) {
    if (auto plan = find(name)) return plan;
    std::shared_ptr<const Plan> plan = make();
    insert(name, plan);
    return plan;
  }

  // Of the plans it holds.
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

  // How many it may hold: at most most_bytes. With less it begins empty, so that what a small budget has room for does
  // not depend on what was rendered before.
  void set_capacity(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    capacity_bytes_ = std::min(bytes, most_bytes);
    if (capacity_bytes_ == most_bytes) return;
    plans_.clear();
    places_.clear();
    bytes_ = hand_ = 0;
  }

 private:
  struct Held {
    ShapeName name;
    std::shared_ptr<const Plan> plan;
    bool used;  // since the hand was there
  };
  struct NameHash {
    std::size_t operator()(const ShapeName& n) const { return n.first; }
  };

  std::shared_ptr<const Plan> find(const ShapeName& name) {
    const std::lock_guard lock(mutex_);
    const auto it = places_.find(name);
    if (it == places_.end()) return nullptr;
    Held& held = plans_[it->second];
    held.used = true;
    return held.plan;
  }
  void insert(const ShapeName& name, const std::shared_ptr<const Plan>& plan) {
    const std::lock_guard lock(mutex_);
    const std::size_t bytes = plan->bytes();
    if (bytes > capacity_bytes_) return;
    make_room(bytes);
    if (!places_.try_emplace(name, plans_.size()).second) return;
    plans_.push_back({name, plan, false});
    bytes_ += bytes;
  }
  // CLOCK: shapes of cells that are like no others leave before those that are met again. Needs mutex_.
  void make_room(std::size_t bytes) {
    while (bytes_ + bytes > capacity_bytes_) {
      if (hand_ >= plans_.size()) hand_ = 0;
      if (std::exchange(plans_[hand_].used, false)) {
        ++hand_;
        continue;
      }
      bytes_ -= plans_[hand_].plan->bytes();
      places_.erase(plans_[hand_].name);
      if (hand_ + 1 < plans_.size()) {
        plans_[hand_] = std::move(plans_.back());
        places_[plans_[hand_].name] = hand_;
      }
      plans_.pop_back();
    }
  }

  std::mutex mutex_;                                             // held for a look-up: some ten in an expansion
  std::size_t capacity_bytes_ = most_bytes;                      // guarded by mutex_
  std::vector<Held> plans_;                                      // guarded by mutex_
  std::unordered_map<ShapeName, std::size_t, NameHash> places_;  // in plans_; guarded by mutex_
  std::size_t hand_ = 0;                                         // guarded by mutex_
  std::atomic<std::size_t> bytes_{0};                            // written under mutex_
};

}  // namespace meristem
