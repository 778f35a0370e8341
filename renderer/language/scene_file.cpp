#include "renderer/language/scene_file.h"

#include "renderer/language/jsonc_reader.h"
#include "renderer/language/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

namespace meristem {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view shared_sections[] = {"materials", "models"};

bool is_shared_section(std::string_view key) {
  return std::find(std::begin(shared_sections), std::end(shared_sections), key) != std::end(shared_sections);
}

// Takes the member "include" out of an object.
std::optional<Member> take_include(Value& object) {
  const auto found =
      std::find_if(object.members.begin(), object.members.end(), [](const Member& m) { return m.key == "include"; });
  if (found == object.members.end()) return {};
  Member result = std::move(*found);
  object.members.erase(found);
  return result;
}

void check_format(const Value& object, Diagnostics& diagnostics) {
  const Value* const format = object.find("format");
  if (format && (format->kind != Value::Kind::Number || format->number != scene_format))
    diagnostics.error(format->location, fmt::format("this program reads \"format\": {} only", scene_format));
}

class Includer {
 public:
  // `scene_file` is canonical; `shown_folder` is its folder as the user wrote it.
  Includer(fs::path scene_file, fs::path shown_folder, Diagnostics& diagnostics)
      : folder_(scene_file.parent_path()),
        shown_folder_(std::move(shown_folder)),
        stack_{std::move(scene_file)},
        diagnostics_(diagnostics) {}

  // Collects what `object`, read from the file on top of the stack, includes; then what it defines itself.
  void collect(Value& object) {
    if (const std::optional<Member> include = take_include(object)) {
      for (const Value* name : names_of(include->value)) include_file(*name);
    }
    for (Member& member : object.members)
      if (is_shared_section(member.key)) add_section(member);
  }

  // Puts what was collected in the place of the scene's own sections.
  void store(Value& scene) {
    for (auto& [key, section] : sections_) {
      const auto same_key = [&](const Member& m) { return m.key == key; };
      const auto own = std::find_if(scene.members.begin(), scene.members.end(), same_key);
      if (own == scene.members.end())
        scene.members.push_back(std::move(section));
      else if (own->value.kind == Value::Kind::Object)
        own->value.members = std::move(section.value.members);
    }
  }

 private:
  std::vector<const Value*> names_of(const Value& include) {
    std::vector<const Value*> names;
    if (include.kind == Value::Kind::Array)
      for (const Value& item : include.items) names.push_back(&item);
    else
      names.push_back(&include);
    const auto refuse = [&](const Value* name) {
      if (name->kind == Value::Kind::Text) return false;
      diagnostics_.error(name->location, fmt::format("\"include\": expected a file name or a list of them, found {}",
                                                     name->kind_name()));
      return true;
    };
    std::erase_if(names, refuse);
    return names;
  }

  void include_file(const Value& name) {
    const std::optional<fs::path> file =
        resolve_inside(folder_, stack_.back().parent_path(), name.text, name.location, diagnostics_);
    if (!file || !may_include(*file, name)) return;
    const auto source =
        load_named_text(*file, (shown_folder_ / shown_name(*file)).string(), name.location, diagnostics_);
    if (!source) return;
    Value object = read_jsonc(source, diagnostics_);
    check_format(object, diagnostics_);
    stack_.push_back(*file);
    if (check_members(object)) collect(object);
    stack_.pop_back();
  }

  bool may_include(const fs::path& file, const Value& name) {
    const auto refuse = [&](std::string why) {
      diagnostics_.error(name.location, std::move(why));
      return false;
    };
    if (std::find(stack_.begin(), stack_.end(), file) != stack_.end())
      return refuse(fmt::format("\"{}\" includes itself: {}", name.text, chain(file)));
    if (seen_.contains(file)) return false;
    if (stack_.size() > std::size_t(IncludeLimits::depth))
      return refuse(fmt::format("more than {} files include each other in a row", IncludeLimits::depth));
    if (seen_.size() >= std::size_t(IncludeLimits::files))
      return refuse(fmt::format("more than {} files are included", IncludeLimits::files));
    seen_.insert(file);
    return true;
  }

  // Relative to the scene's folder.
  std::string shown_name(const fs::path& file) const { return file.lexically_relative(folder_).string(); }

  // "a.jsonc -> b.jsonc -> a.jsonc"
  std::string chain(const fs::path& file) const {
    std::string result;
    for (auto at = std::find(stack_.begin(), stack_.end(), file); at != stack_.end(); ++at)
      result += shown_name(*at) + " -> ";
    return result + shown_name(file);
  }

  bool check_members(const Value& object) {
    if (object.kind != Value::Kind::Object) {
      diagnostics_.error(object.location,
                         fmt::format("an included file: expected an object, found {}", object.kind_name()));
      return false;
    }
    for (const Member& member : object.members)
      if (!is_shared_section(member.key) && member.key != "include" && member.key != "format")
        diagnostics_.error(member.key_location,
                           fmt::format("an included file has no \"{}\"; known: format, include, materials, models; "
                                       "the rest belongs into the scene itself",
                                       member.key));
    return true;
  }

  void add_section(Member& member) {
    if (member.value.kind != Value::Kind::Object) {
      diagnostics_.error(member.value.location, fmt::format("\"{}\": expected an object of named {}, found {}",
                                                            member.key, member.key, member.value.kind_name()));
      return;
    }
    const auto [section, is_new] = sections_.try_emplace(member.key);
    if (is_new) {
      section->second.key = member.key;
      section->second.key_location = member.key_location;
      section->second.value.kind = Value::Kind::Object;
      section->second.value.location = member.value.location;
    }
    for (Member& definition : member.value.members) add_definition(section->second.value, definition, member.key);
  }

  void add_definition(Value& section, Member& definition, const std::string& section_name) {
    const auto [earlier, is_new] = first_places_.try_emplace({section_name, definition.key}, definition.key_location);
    if (is_new) {
      section.members.push_back(std::move(definition));
      return;
    }
    const Location& first = earlier->second;
    diagnostics_.error(definition.key_location,
                       fmt::format("\"{}\" stands twice in \"{}\"; first at {}:{}:{}", definition.key, section_name,
                                   first.source->name, first.line(), first.column()));
  }

  fs::path folder_;  // the scene's, canonical
  fs::path shown_folder_;
  std::vector<fs::path> stack_;  // the files we are in, canonical
  Diagnostics& diagnostics_;
  std::set<fs::path> seen_;  // included so far
  std::map<std::string, Member> sections_;
  std::map<std::pair<std::string, std::string>, Location> first_places_;
};

void refuse_include(Value& scene, Diagnostics& diagnostics) {
  if (const std::optional<Member> include = take_include(scene))
    diagnostics.error(include->key_location, "a scene from standard input has no folder to include from");
}

}  // namespace

Value read_scene_file(const std::string& path, Diagnostics& diagnostics) {
  const auto source = load_scene_text(path, diagnostics);
  if (!source) return {};
  Value scene = read_jsonc(source, diagnostics);
  check_format(scene, diagnostics);
  if (!scene.find("include")) return scene;
  std::error_code status;
  const fs::path file = fs::canonical(path, status);
  if (path == "-" || status) {
    refuse_include(scene, diagnostics);
    return scene;
  }
  Includer includer(file, fs::path(path).parent_path(), diagnostics);
  includer.collect(scene);
  includer.store(scene);
  return scene;
}

}  // namespace meristem
