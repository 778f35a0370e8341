#include "geometry/mesh/refine_plan.h"

#include <array>
#include <mutex>
#include <unordered_map>

namespace meristem {

namespace {

// Plans by the hash of everything they depend on. Two 64-bit hashes with different seeds name a shape: a clash would
// need 2^64 shapes before it grew likely.
struct ShapeName {
  Key first, second;
  bool operator==(const ShapeName&) const = default;
};
struct ShapeNameHash {
  std::size_t operator()(const ShapeName& n) const { return n.first; }
};

class ShapeHasher {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    add_word(values.size());
    for (const T& v : values) {
      std::uint32_t bits = 0;
      static_assert(sizeof(T) == sizeof(bits));
      __builtin_memcpy(&bits, &v, sizeof(bits));
      add_word(bits);
    }
  }
  void add_word(std::uint64_t w) {
    name_.first = (name_.first ^ w) * 0x9e3779b97f4a7c15ull;
    name_.first ^= name_.first >> 29;
    name_.second = (name_.second + w) * 0xd1342543de82ef95ull;
    name_.second ^= name_.second >> 32;
  }
  ShapeName name() const { return name_; }

 private:
  ShapeName name_{0x243f6a8885a308d3ull, 0x13198a2e03707344ull};
};

// At most this many bytes of plans: a full set of levels of one quad patch is some 150 KB, so about 200 shapes stay.
constexpr std::size_t table_capacity_bytes = std::size_t(32) << 20;

class PlanTable {
 public:
  std::shared_ptr<const RefinePlan> find(const ShapeName& name) {
    Shard& shard = shard_of(name);
    const std::lock_guard lock(shard.mutex);
    const auto it = shard.plans.find(name);
    return it == shard.plans.end() ? nullptr : it->second;
  }
  void insert(const ShapeName& name, const std::shared_ptr<const RefinePlan>& plan) {
    Shard& shard = shard_of(name);
    const std::lock_guard lock(shard.mutex);
    const std::size_t bytes = plan->bytes();
    if (shard.bytes + bytes >
        table_capacity_bytes / shard_count) {  // full: start afresh; what is in use comes back at once
      shard.plans.clear();
      shard.bytes = 0;
    }
    if (shard.plans.emplace(name, plan).second) shard.bytes += bytes;
  }

 private:
  static constexpr std::size_t shard_count = 8;
  struct Shard {
    std::mutex mutex;
    std::unordered_map<ShapeName, std::shared_ptr<const RefinePlan>, ShapeNameHash> plans;  // guarded by mutex
    std::size_t bytes = 0;                                                                  // guarded by mutex
  };
  Shard& shard_of(const ShapeName& name) { return shards_[name.second % shard_count]; }
  std::array<Shard, shard_count> shards_;
};

PlanTable& plan_table() {
  static PlanTable table;
  return table;
}

ShapeName shape_of(const Mesh& mesh, std::uint32_t owned_faces, int rings_after, const RefineOptions& options) {
  ShapeHasher hasher;
  hasher.add_word(owned_faces);
  hasher.add_word(std::uint64_t(rings_after) << 8 | std::uint64_t(options.scheme) << 4 |
                  std::uint64_t(options.boundary));
  hasher.add(mesh.face_starts);
  hasher.add(mesh.corner_vertices);
  hasher.add(mesh.corner_sharpness);
  hasher.add(mesh.vertex_sharpness);
  return hasher.name();
}

}  // namespace

std::shared_ptr<const RefinePlan> shared_refine_plan(const Mesh& mesh, std::uint32_t owned_faces, int rings_after,
                                                     const RefineOptions& options) {
  const ShapeName name = shape_of(mesh, owned_faces, rings_after, options);
  if (auto plan = plan_table().find(name)) return plan;
  auto plan = make_refine_plan(mesh, owned_faces, rings_after, options);
  plan_table().insert(name, plan);
  return plan;
}

}  // namespace meristem
