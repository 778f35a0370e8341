// PlanTable: index tables that follow from a mesh's topology and creases alone, kept by shape and shared by all cells
// of that shape. Any thread may look up and add; a table holds at most a fixed number of bytes.
#pragma once

#include "geometry/mesh/mesh.h"

#include <array>
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
  explicit PlanTable(std::size_t capacity_bytes) : shard_capacity_bytes_(capacity_bytes / shard_count) {}

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

 private:
  static constexpr std::size_t shard_count = 8;
  struct NameHash {
    std::size_t operator()(const ShapeName& n) const { return n.first; }
  };
  struct Shard {
    std::mutex mutex;
    std::unordered_map<ShapeName, std::shared_ptr<const Plan>, NameHash> plans;  // guarded by mutex
    std::size_t bytes = 0;                                                       // guarded by mutex
  };

  Shard& shard_of(const ShapeName& name) { return shards_[name.second % shard_count]; }
  std::shared_ptr<const Plan> find(const ShapeName& name) {
    Shard& shard = shard_of(name);
    const std::lock_guard lock(shard.mutex);
    const auto it = shard.plans.find(name);
    return it == shard.plans.end() ? nullptr : it->second;
  }
  void insert(const ShapeName& name, const std::shared_ptr<const Plan>& plan) {
    Shard& shard = shard_of(name);
    const std::lock_guard lock(shard.mutex);
    const std::size_t bytes = plan->bytes();
    if (shard.bytes + bytes > shard_capacity_bytes_) {  // full: start afresh; what is in use comes back at once
      shard.plans.clear();
      bytes_ -= shard.bytes;
      shard.bytes = 0;
    }
    if (!shard.plans.emplace(name, plan).second) return;
    shard.bytes += bytes;
    bytes_ += bytes;
  }

  const std::size_t shard_capacity_bytes_;
  std::array<Shard, shard_count> shards_;
  std::atomic<std::size_t> bytes_{0};  // of all shards
};

}  // namespace meristem
