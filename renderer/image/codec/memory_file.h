// A file in memory that a library opens by a name like any other: for OpenImageIO's writer of TIFF, which fails on its
// own memory streams. Linux (memfd_create).
#pragma once

#include <string>
#include <vector>

namespace meristem {

class MemoryFile {
 public:
  MemoryFile();  // throws std::bad_alloc if the system gives none
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  // Valid in this process while the MemoryFile lives.
  std::string path() const;
  std::vector<unsigned char> content() const;

 private:
  int descriptor_;
};

}  // namespace meristem
