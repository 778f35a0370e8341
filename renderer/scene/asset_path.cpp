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

std::optional<std::string> asset_path(Params& params, const char* name, const std::string& file) {
  const auto& source = params.location().source;
  const fs::path shown = source ? fs::path(source->name).parent_path() : fs::path();
  const fs::path path(file);
  std::error_code error;
  const fs::path folder = fs::canonical(shown.empty() ? fs::path(".") : shown, error);
  const fs::path target = fs::weakly_canonical(folder / path, error);
  if (path.is_relative() && !error && is_inside(target, folder)) return (shown / path).string();
  params.error(name, "a file must lie in the folder of its scene file or below it");
  return std::nullopt;
}

}  // namespace meristem
