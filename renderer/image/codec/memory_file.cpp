#include "renderer/image/codec/memory_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meristem {

MemoryFile::MemoryFile() : descriptor_(::memfd_create("meristem-image", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::bad_alloc();
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::string MemoryFile::path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

std::vector<unsigned char> MemoryFile::content() const {
  struct stat status {};
  ::fstat(descriptor_, &status);
  std::vector<unsigned char> bytes(std::size_t(status.st_size));
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::pread(descriptor_, bytes.data() + done, bytes.size() - done, off_t(done));
    if (n <= 0) throw std::runtime_error(fmt::format("cannot read memory back: {}", std::strerror(errno)));
    done += std::size_t(n);
  }
  return bytes;
}

}  // namespace meristem
