#include "renderer/interchange/spool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

namespace meristem {

namespace {

constexpr std::size_t block_bytes = std::size_t(1) << 18;

}  // namespace

Spool::Spool(const std::string& folder) : folder_(folder.empty() ? "." : folder) {
  descriptor_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor_ >= 0) return;
  std::string name = folder_ + "/spoolXXXXXX";  // a file system without nameless files
  descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor_ < 0) fail();
  ::unlink(name.c_str());
}

Spool::~Spool() { ::close(descriptor_); }

void Spool::fail() const {
  throw FileError(fmt::format("cannot write a temporary file in {}: {}", folder_, std::strerror(errno)));
}

void Spool::append(std::string_view bytes) {
  buffer_ += bytes;
  size_ += bytes.size();
  if (buffer_.size() >= block_bytes) flush();
}

void Spool::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    rest.remove_prefix(std::size_t(written));
  }
  buffer_.clear();
}

template <class Target>
void Spool::copy_blocks(Target& target) {
  flush();
  std::string block(block_bytes, '\0');
  for (std::uint64_t at = 0; at < size_;) {
    const std::size_t wanted = std::size_t(std::min<std::uint64_t>(block.size(), size_ - at));
    const ssize_t read = ::pread(descriptor_, block.data(), wanted, off_t(at));
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) fail();
    target.append(std::string_view(block.data(), std::size_t(read)));
    at += std::uint64_t(read);
  }
}

void Spool::copy_to(AtomicFile& file) { copy_blocks(file); }
void Spool::copy_to(Spool& other) { copy_blocks(other); }

}  // namespace meristem
