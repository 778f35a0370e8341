// Reading a file in one go, of no more than some size. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace meristem {

constexpr std::uintmax_t most_file_bytes = std::uintmax_t(1) << 30;  // of meshes and scenes of other programs

// The bytes of a regular file of at most `most` bytes; nothing, and the reason as a message, if it cannot be read.
std::optional<std::string> read_whole_file(const std::string& path, std::string& reason,
                                           std::uintmax_t most = most_file_bytes);

}  // namespace meristem
