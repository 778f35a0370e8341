#include "renderer/loading/scene_files.h"

#include "geometry/base/sha256.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>

namespace meristem {

namespace {

constexpr std::size_t longest_name = 255;

void visit(const Value& value, const std::function<void(const Value&)>& see) {
  see(value);
  for (const Value& item : value.items) visit(item, see);
  for (const Member& member : value.members) visit(member.value, see);
}

// Names of files have extensions; most texts of a scene are expressions and names.
bool may_name_a_file(const std::string& text) {
  return text.size() <= longest_name && text.find('.') != std::string::npos && text.find('\n') == std::string::npos;
}

std::filesystem::path folder_of(const Value& value) {
  return value.location.source ? std::filesystem::path(value.location.source->name).parent_path() : "";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> scene_texts(const Value& scene) {
  std::vector<const SourceText*> sources;
  visit(scene, [&](const Value& v) {
    if (const SourceText* s = v.location.source.get(); s && std::ranges::find(sources, s) == sources.end())
      sources.push_back(s);
  });
  std::vector<std::pair<std::string, std::string>> texts;
  for (const SourceText* s : sources)
    texts.emplace_back(texts.empty() ? "scene" : std::filesystem::path(s->name).filename().string(), sha256(s->text));
  return texts;
}

std::vector<std::pair<std::string, std::string>> named_files(const Value& scene, const std::string& folder) {
  std::map<std::string, std::string> files;
  visit(scene, [&](const Value& v) {
    if (v.kind != Value::Kind::Text || !may_name_a_file(v.text)) return;
    // Beside the scene, or beside the file that the text stands in
    for (const std::filesystem::path& beside : {std::filesystem::path(folder), folder_of(v)}) {
      std::error_code ignored;
      if (std::filesystem::is_regular_file(beside / v.text, ignored)) files.emplace(v.text, (beside / v.text).string());
    }
  });
  return {files.begin(), files.end()};
}

}  // namespace meristem
