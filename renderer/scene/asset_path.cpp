#include "renderer/scene/asset_path.h"

#include <algorithm>
#include <filesystem>

namespace meristem {

namespace fs = std::filesystem;

namespace {

bool is_inside(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

std::optional<std::string> path_in_folder(const std::string& shown, const std::string& file) {
  const fs::path path(file);
  std::error_code error;
  const fs::path folder = fs::canonical(shown.empty() ? fs::path(".") : fs::path(shown), error);
  const fs::path target = fs::weakly_canonical(folder / path, error);
  if (path.is_relative() && !error && is_inside(target, folder)) return (fs::path(shown) / path).string();
  return std::nullopt;
}

std::optional<std::string> asset_path(Params& params, const char* name, const std::string& file) {
  const auto& source = params.location().source;
  if (auto path = path_in_folder(source ? fs::path(source->name).parent_path().string() : "", file)) return path;
  params.error(name, "a file must lie in the folder of its scene file or below it");
  return std::nullopt;
}

}  // namespace meristem
