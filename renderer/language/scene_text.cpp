#include "renderer/language/scene_text.h"

#include "renderer/language/jsonc_reader.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>
#include <system_error>

namespace meristem {

namespace fs = std::filesystem;

namespace {

std::string last_error() { return std::generic_category().message(errno != 0 ? errno : EIO); }

// Reads to the end, or one byte beyond the limit: enough to know that there is too much. False if reading failed.
bool read_limited(std::istream& stream, std::string& text) {
  constexpr std::size_t chunk = std::size_t(1) << 16;
  while (stream && text.size() <= JsoncLimits::file_bytes) {
    const std::size_t before = text.size();
    text.resize(before + chunk);
    stream.read(text.data() + before, std::streamsize(chunk));
    text.resize(before + std::size_t(stream.gcount()));
  }
  return !stream.bad();
}

std::shared_ptr<const SourceText> load(std::istream& stream, std::string name, const Location& where,
                                       Diagnostics& diagnostics) {
  auto source = std::make_shared<SourceText>();
  source->name = std::move(name);
  errno = 0;
  if (!read_limited(stream, source->text)) {
    diagnostics.error(where, fmt::format("cannot read \"{}\": {}", source->name, last_error()));
    return nullptr;
  }
  if (source->text.size() > JsoncLimits::file_bytes) {
    diagnostics.error(where, fmt::format("\"{}\" is longer than {} MiB", source->name, JsoncLimits::file_bytes >> 20));
    return nullptr;
  }
  return source;
}

std::shared_ptr<const SourceText> open_and_load(const fs::path& file, std::string name, const Location& where,
                                                Diagnostics& diagnostics) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (stream) return load(stream, std::move(name), where, diagnostics);
  diagnostics.error(where, fmt::format("cannot open \"{}\": {}", name, last_error()));
  return nullptr;
}

bool is_inside(const fs::path& file, const fs::path& folder) {
  const fs::path relative = file.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

bool climbs(const fs::path& path) {
  for (const fs::path& part : path)
    if (part == "..") return true;
  return false;
}

}  // namespace

std::shared_ptr<const SourceText> load_scene_text(const std::string& path, Diagnostics& diagnostics) {
  if (path == "-") return load_stream_text(std::cin, "<stdin>", diagnostics);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    diagnostics.error({}, fmt::format("cannot read \"{}\": it is a folder; expected a scene file in it", path));
    return nullptr;
  }
  return open_and_load(path, path, {}, diagnostics);
}

std::shared_ptr<const SourceText> load_stream_text(std::istream& stream, std::string name, Diagnostics& diagnostics) {
  return load(stream, std::move(name), {}, diagnostics);
}

std::shared_ptr<const SourceText> load_named_text(const fs::path& file, std::string name, const Location& where,
                                                  Diagnostics& diagnostics) {
  return open_and_load(file, std::move(name), where, diagnostics);
}

std::optional<fs::path> resolve_inside(const fs::path& scene_folder, const fs::path& from, const std::string& name,
                                       const Location& where, Diagnostics& diagnostics) {
  const auto refuse = [&](std::string why) {
    diagnostics.error(where, fmt::format("cannot use the file \"{}\": {}", name, why));
    return std::nullopt;
  };
  const fs::path relative(name);
  if (name.empty() || name.find('\0') != std::string::npos) return refuse("not a file name");
  if (relative.is_absolute()) return refuse("expected a path relative to the scene's folder");
  if (climbs(relative)) return refuse("\"..\" is not allowed; files must stand in the scene's folder");
  std::error_code status;
  const fs::path file = fs::canonical(from / relative, status);
  if (status) return refuse(status.message());
  if (!is_inside(file, scene_folder)) return refuse("it lies outside the scene's folder");
  if (!fs::is_regular_file(file, status)) return refuse("not a regular file");
  return file;
}

}  // namespace meristem
