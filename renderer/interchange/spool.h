// Spool: bytes that wait on the disk until what comes before them in a file is known. It lies in a folder, without a
// name, and is gone with the object or the process. One thread. Every error is a FileError.
#pragma once

#include "renderer/image/atomic_file.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace meristem {

class Spool {
 public:
  explicit Spool(const std::string& folder);
  ~Spool();
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void append(std::string_view bytes);
  // The bytes of plain values, as they lie in memory.
  template <class T>
  void append_values(std::span<const T> values) {
    append({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  }
  std::uint64_t size() const { return size_; }

  // All of it, in blocks.
  void copy_to(AtomicFile& file);
  void copy_to(Spool& other);

 private:
  template <class Target>
  void copy_blocks(Target& target);
  void flush();
  [[noreturn]] void fail() const;

  std::string folder_;
  int descriptor_ = -1;
  std::string buffer_;
  std::uint64_t size_ = 0;
};

}  // namespace meristem
