#include "renderer/cli/film_identity.h"

#include "geometry/base/sha256.h"
#include "renderer/report/version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

namespace meristem {

namespace {

constexpr std::size_t digest_digits = 64;

std::string file_digest(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  Sha256 hash;
  for (std::string block(std::size_t(1) << 20, '\0'); in; hash.update(block.data(), std::size_t(in.gcount())))
    in.read(block.data(), std::streamsize(block.size()));
  if (!in.eof()) throw FileError(fmt::format("cannot read {}: {}", path, std::strerror(errno)));
  return hash.finish();
}

std::string aov_list(const std::vector<Aov>& aovs) {
  std::vector<std::string> names;
  for (const Aov aov : aovs) names.push_back(info_of(aov).name);
  return fmt::format("{}", fmt::join(names, ","));
}

std::string changed(const std::string& name, const std::string& before, const std::string& now) {
  if (before.size() == digest_digits || now.size() == digest_digits) return fmt::format("{} has changed", name);
  const auto shown = [](const std::string& value) { return value.empty() ? std::string("not given") : value; };
  return fmt::format("{} was {} and is {}", name, shown(before), shown(now));
}

}  // namespace

FilmIdentity film_identity(const RenderOptions& options, const LoadedScene& loaded, const PixelWindow& window) {
  const RenderSettings& s = loaded.scene->settings;
  FilmIdentity identity{{"program", version}};
  for (const auto& [name, digest] : loaded.texts) identity.emplace_back(name, digest);
  for (const auto& [name, path] : loaded.files) identity.emplace_back(name, file_digest(path));
  identity.emplace_back("--set", fmt::format("{}", fmt::join(options.load.set, " ")));
  if (options.load.frame) identity.emplace_back("frame", fmt::format("{}", *options.load.frame));
  identity.emplace_back("camera", options.load.camera);
  identity.emplace_back("size", fmt::format("{}x{}", s.width, s.height));
  identity.emplace_back("crop", fmt::format("{},{},{},{}", window.x0, window.y0, window.x1, window.y1));
  identity.emplace_back("seed", fmt::format("{}", s.seed));
  identity.emplace_back("max depth", fmt::format("{}", s.max_depth));
  identity.emplace_back("detail", fmt::format("{}", s.detail));
  identity.emplace_back("shutter", fmt::format("{} in {} moments", s.shutter, s.shutter_moments));
  identity.emplace_back("noise", fmt::format("{}", s.noise));
  identity.emplace_back("AOVs", aov_list(s.aovs));
  // Lazy and eager are the same image; flat may break ties otherwise
  identity.emplace_back("expansion", options.load.expand == ExpandMode::Flat ? "flat" : "by cells");
  return identity;
}

std::string identity_difference(const FilmIdentity& before, const FilmIdentity& now) {
  const std::map<std::string, std::string> old_values(before.begin(), before.end()), new_values(now.begin(), now.end());
  std::set<std::string> names;
  for (const auto& [name, value] : before) names.insert(name);
  for (const auto& [name, value] : now) names.insert(name);
  std::vector<std::string> differences;
  for (const std::string& name : names) {
    const auto was = old_values.find(name), is = new_values.find(name);
    const std::string old_value = was == old_values.end() ? "" : was->second;
    const std::string new_value = is == new_values.end() ? "" : is->second;
    if (old_value != new_value) differences.push_back(changed(name, old_value, new_value));
  }
  return fmt::format("{}", fmt::join(differences, "; "));
}

}  // namespace meristem
