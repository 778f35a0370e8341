#include "geometry/io/whole_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace meristem {

std::optional<std::string> read_whole_file(const std::string& path, std::string& reason, std::uintmax_t most) {
  std::error_code code;
  const std::uintmax_t bytes = std::filesystem::file_size(path, code);
  if (code) {
    reason = fmt::format("cannot read \"{}\": {}", path, code.message());
    return std::nullopt;
  }
  if (bytes > most) {
    reason = fmt::format("\"{}\" has {} bytes; at most {} are read", path, bytes, most);
    return std::nullopt;
  }
  std::string text(std::size_t(bytes), '\0');
  std::ifstream file(path, std::ios::binary);
  if (std::filesystem::is_regular_file(path, code) && file.read(text.data(), std::streamsize(bytes))) return text;
  reason = fmt::format("cannot read \"{}\"", path);
  return std::nullopt;
}

}  // namespace meristem
