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
template <class Plan>
class PlanTable {
 public:
  static constexpr std::size_t most_bytes = std::size_t(32) << 20;

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

  // How many it may hold: at most most_bytes.
  void set_capacity(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    capacity_bytes_ = std::min(bytes, most_bytes);
    make_room(0);
  }

 private:
  struct NameHash {
    std::size_t operator()(const ShapeName& n) const { return n.first; }
  };

  std::shared_ptr<const Plan> find(const ShapeName& name) {
    const std::lock_guard lock(mutex_);
    const auto it = plans_.find(name);
    return it == plans_.end() ? nullptr : it->second;
  }
  void insert(const ShapeName& name, const std::shared_ptr<const Plan>& plan) {
    const std::lock_guard lock(mutex_);
    const std::size_t bytes = plan->bytes();
    if (bytes > capacity_bytes_) return;
    make_room(bytes);
    if (plans_.emplace(name, plan).second) bytes_ += bytes;
  }
  // A full table starts afresh: what is in use comes back at once. Needs mutex_.
  void make_room(std::size_t bytes) {
    if (bytes_ + bytes <= capacity_bytes_) return;
    plans_.clear();
    bytes_ = 0;
  }

  std::mutex mutex_;                         // held for a look-up: some ten in an expansion
  std::size_t capacity_bytes_ = most_bytes;  // guarded by mutex_
  std::unordered_map<ShapeName, std::shared_ptr<const Plan>, NameHash> plans_;  // guarded by mutex_
  std::atomic<std::size_t> bytes_{0};                                           // written under mutex_
};

}  // namespace meristem
