#include "renderer/image/atomic_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace meristem {

namespace fs = std::filesystem;

namespace {

FileError write_error(const std::string& path, const std::string& reason) {
  return FileError(fmt::format("cannot write {}: {}", path, reason));
}

std::string folder_of(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

// The file to replace: `path` with symbolic links followed. Refuses what is not a regular file.
std::string resolved_target(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) throw write_error(path, "it is not a regular file");
  if (!fs::is_symlink(path, ignored)) return path;
  const fs::path target = fs::canonical(path, ignored);
  if (target.empty()) throw write_error(path, "it is a symbolic link to nothing");
  return target.string();
}

std::string temporary_name(const std::string& target, int attempt) {
  return fmt::format("{}.{}-{}.tmp", target, ::getpid(), attempt);
}

// Of bytes after those that gave `sum`: depends on every byte and its place.
std::uint64_t checksum(std::uint64_t sum, std::string_view bytes) {
  for (const char c : bytes) sum = (sum ^ std::uint8_t(c)) * 0x100000001b3ull + 1;
  return sum;
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(resolved_target(path)) {
  open_unnamed();
  if (descriptor_ < 0) open_named();
  struct stat status {};
  if (::stat(target_.c_str(), &status) == 0) ::fchmod(descriptor_, status.st_mode & 07777);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!committed_ && !temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::open_unnamed() {
  descriptor_ = ::open(folder_of(target_).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
}

void AtomicFile::open_named() {
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    temporary_ = temporary_name(target_, attempt);
    descriptor_ = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) {
      temporary_.clear();
      fail();
    }
  }
}

void AtomicFile::name_it() {
  const std::string opened = fmt::format("/proc/self/fd/{}", descriptor_);
  for (int attempt = 0; temporary_.empty(); ++attempt) {
    const std::string name = temporary_name(target_, attempt);
    if (::linkat(AT_FDCWD, opened.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
      temporary_ = name;
    else if (errno != EEXIST)
      fail();
  }
}

// Reads the file back: some file systems report success and lose bytes.
void AtomicFile::verify() const {
  std::string block(std::size_t(1) << 20, '\0');
  std::uint64_t size = 0, sum = 0;
  for (;;) {
    const ssize_t read = ::pread(descriptor_, block.data(), block.size(), off_t(size));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) fail();
    if (read == 0) break;
    sum = checksum(sum, {block.data(), std::size_t(read)});
    size += std::uint64_t(read);
  }
  if (size != size_ || sum != sum_) throw write_error(path_, "the disk does not give back what was written");
}

void AtomicFile::fail() const { throw write_error(path_, std::strerror(errno)); }

void AtomicFile::append(std::string_view bytes) {
  size_ += bytes.size();
  sum_ = checksum(sum_, bytes);
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail();
    bytes.remove_prefix(std::size_t(written));
  }
}

void AtomicFile::commit() {
  if (::fsync(descriptor_) != 0) fail();
  verify();
  if (temporary_.empty()) name_it();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail();
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail();
  committed_ = true;
  // The rename itself reaches the disk with its folder; not every file system can sync one, and the file is whole
  // anyway.
  const int folder = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  ::fsync(folder);
  ::close(folder);
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.append(bytes);
  file.commit();
}

void check_writable(const std::string& path) {
  if (::access(folder_of(resolved_target(path)).c_str(), W_OK | X_OK) != 0)
    throw write_error(path, std::strerror(errno));
}

}  // namespace meristem
