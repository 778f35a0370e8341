// TemporaryFolder: a folder of this process alone, gone with everything in it when it goes out of scope.
#pragma once

#include <filesystem>
#include <string>

namespace meristem {

class TemporaryFolder {
 public:
  TemporaryFolder();  // throws FileError if the system gives none
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace meristem
