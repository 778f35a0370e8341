// AtomicFile: a file that appears whole or not at all. It is written without a name, or where the file system has no
// such files under a temporary one, in the target's own folder; commit() brings it to the disk, reads it back to
// compare, names it and renames it onto the target. Without commit() nothing is left and the target stays as it was; a
// process that is killed leaves at most a file TARGET.PID-N.tmp. A target that is a symbolic link is followed; one that
// is not a regular file (a device, a folder) is refused, since renaming would replace it. Every error is a FileError
// with the path and the system's reason.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace meristem {

// A file that cannot be read or written: the user's disk, not our bug (exit code 4).
class FileError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class AtomicFile {
 public:
  // Creates the file, empty, with the permissions that `path` has or that the umask gives.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void append(std::string_view bytes);
  // Once, at the end.
  void commit();

 private:
  [[noreturn]] void fail() const;  // with errno
  void open_unnamed();
  void open_named();
  void name_it();  // a file opened without a name
  void verify() const;

  std::string path_;       // as the user named it
  std::string target_;     // with links followed
  std::string temporary_;  // empty: it has no name yet
  int descriptor_ = -1;
  std::uint64_t size_ = 0, sum_ = 0;  // of what was appended
  bool committed_ = false;
};

// These bytes, or the old file.
void write_file(const std::string& path, std::string_view bytes);

// Throws the FileError that writing `path` would meet as far as that is known beforehand: so that a long render does
// not end with an image that has nowhere to go.
void check_writable(const std::string& path);

}  // namespace meristem
