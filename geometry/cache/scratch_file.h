// ScratchFile: a file without a name for what memory has no room for, in blocks that come and go. It is gone with the
// process, however that ends. Any thread.
#pragma once

#include <sys/uio.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace meristem {

class ScratchFile {
 public:
  // Throws std::runtime_error with the system's reason.
  explicit ScratchFile(const std::string& directory);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  struct Block {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;  // 0: none
  };
  // One part after another. None if the disk does not take it; it is not asked again then.
  Block write(std::vector<iovec> parts);
  // Fills the parts with what stands in a block from `from` on; false if it cannot be had.
  bool read(const Block& block, std::uint64_t from, std::vector<iovec> parts) const;
  void free(const Block& block);

  void count_read_back() { read_back_.fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t read_back() const { return read_back_.load(std::memory_order_relaxed); }
  std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }  // on the disk at most
  // In memory, to know where blocks are; whoever keeps lists of them adds theirs.
  std::size_t index_bytes() const { return index_bytes_.load(std::memory_order_relaxed); }
  void add_index_bytes(std::ptrdiff_t bytes) { index_bytes_.fetch_add(std::size_t(bytes), std::memory_order_relaxed); }

 private:
  int descriptor_ = -1;
  std::atomic<bool> is_full_{false};
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<std::size_t> index_bytes_{0};
  std::atomic<std::uint64_t> read_back_{0};
  std::mutex mutex_;
  std::map<std::uint64_t, std::vector<std::uint64_t>> free_;  // offsets by room; guarded by mutex_
};

}  // namespace meristem
