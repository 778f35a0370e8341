#include "geometry/cache/scratch_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace meristem {

namespace {

// Blocks begin at pages, and so few sizes occur that rooms are used again.
constexpr std::uint64_t page_bytes = 4096;
std::uint64_t room_of(std::uint64_t bytes) { return (bytes + page_bytes - 1) / page_bytes * page_bytes; }

int open_unnamed(const std::string& directory) {
  if (const int descriptor = ::open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600); descriptor >= 0)
    return descriptor;
  // A file system without such files
  std::string path = directory + "/meristem-XXXXXX";
  const int descriptor = ::mkostemp(path.data(), O_CLOEXEC);
  if (descriptor >= 0) ::unlink(path.c_str());
  return descriptor;
}

// All parts, however many calls that takes.
template <class Call>
bool transfer(Call call, int descriptor, std::uint64_t offset, std::vector<iovec> parts) {
  std::erase_if(parts, [](const iovec& part) { return part.iov_len == 0; });
  for (std::size_t first = 0; first < parts.size();) {
    ssize_t n = call(descriptor, parts.data() + first, int(parts.size() - first), off_t(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    offset += std::uint64_t(n);
    for (; first < parts.size() && std::size_t(n) >= parts[first].iov_len; ++first) n -= ssize_t(parts[first].iov_len);
    if (n == 0) continue;
    parts[first].iov_base = static_cast<std::byte*>(parts[first].iov_base) + n;
    parts[first].iov_len -= std::size_t(n);
  }
  return true;
}

}  // namespace

ScratchFile::ScratchFile(const std::string& directory) : descriptor_(open_unnamed(directory)) {
  if (descriptor_ < 0)
    throw std::runtime_error(fmt::format("no scratch file can be made in \"{}\": {}", directory, std::strerror(errno)));
}

ScratchFile::~ScratchFile() { ::close(descriptor_); }

ScratchFile::Block ScratchFile::write(std::vector<iovec> parts) {
  std::uint64_t bytes = 0;
  for (const iovec& part : parts) bytes += part.iov_len;
  if (is_full_.load(std::memory_order_relaxed) || bytes == 0 || bytes > UINT32_MAX) return {};
  Block block{0, std::uint32_t(bytes)};
  {
    const std::lock_guard lock(mutex_);
    std::vector<std::uint64_t>& rooms = free_[room_of(bytes)];
    if (rooms.empty()) {
      block.offset = bytes_.fetch_add(room_of(bytes), std::memory_order_relaxed);
    } else {
      block.offset = rooms.back();
      rooms.pop_back();
    }
  }
  if (transfer(::pwritev, descriptor_, block.offset, std::move(parts))) return block;
  is_full_ = true;
  free(block);
  return {};
}

bool ScratchFile::read(const Block& block, std::uint64_t from, std::vector<iovec> parts) const {
  return transfer(::preadv, descriptor_, block.offset + from, std::move(parts));
}

void ScratchFile::free(const Block& block) {
  const std::lock_guard lock(mutex_);
  free_[room_of(block.bytes)].push_back(block.offset);
}

}  // namespace meristem
