// LeafStore: surfaces of one root's cells that were evicted, in a scratch file, by the names of their cells. To read
// one takes a small part of the time of expanding the cell again. Their trees are kept as well: of triangles at one
// distance the first in the order of the tree is met. Any thread.
#pragma once

#include "geometry/accel/surface_patch.h"
#include "geometry/base/key.h"
#include "geometry/cache/geometry_cache.h"
#include "geometry/cache/scratch_file.h"

#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace meristem {

class LeafStore {
 public:
  // The file must outlive it.
  explicit LeafStore(ScratchFile& file) : file_(file) {}
  ~LeafStore();
  LeafStore(const LeafStore&) = delete;
  LeafStore& operator=(const LeafStore&) = delete;

  struct Leaf {
    std::unique_ptr<SurfacePatch> patch;
    CellLabel label;
  };
  // Once for each cell: what it expands to is always the same. Nothing happens if the file is full.
  void keep(Key name, const SurfacePatch& patch, const CellLabel& label);
  // Nothing if it was not kept, or cannot be read.
  std::optional<Leaf> find(Key name) const;

 private:
  static constexpr std::ptrdiff_t node_bytes = 56;  // of the map
  ScratchFile& file_;
  mutable std::mutex mutex_;
  std::unordered_map<Key, ScratchFile::Block> blocks_;  // guarded by mutex_
};

}  // namespace meristem
