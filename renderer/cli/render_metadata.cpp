#include "renderer/cli/render_metadata.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <ctime>

namespace meristem {

namespace {

std::tm now_utc() { return fmt::gmtime(std::time(nullptr)); }

std::string range_text(const std::vector<SampleRange>& ranges) {
  std::vector<std::string> texts;
  for (const SampleRange& r : ranges) texts.push_back(fmt::format("{}:{}", r.first, r.last));
  return fmt::format("{}", fmt::join(texts, ","));
}

std::string matrix_text(const CameraMatrices::Matrix& matrix) {
  std::array<float, 16> numbers;
  std::ranges::transform(matrix, numbers.begin(), [](double x) { return float(x) + 0.f; });  // -0 becomes 0
  return fmt::format("{}", fmt::join(numbers, " "));
}

void replace(Metadata& metadata, const std::string& name, std::string value) {
  const auto at = std::ranges::find(metadata, name, &std::pair<std::string, std::string>::first);
  if (at == metadata.end())
    metadata.emplace_back(name, std::move(value));
  else
    at->second = std::move(value);
}

// What films and their merges say alike.
void add_samples_and_history(Metadata& metadata, const FilmInfo& info) {
  replace(metadata, "DateTime", fmt::format("{:%Y:%m:%d %H:%M:%S}", now_utc()));
  replace(metadata, "meristem:sample_range", range_text(info.ranges));
  replace(metadata, "meristem:history", fmt::format("{}", fmt::join(info.history, "\n")));
}

}  // namespace

const char* end_name(RenderEnd end) {
  switch (end) {
    case RenderEnd::Complete: return "complete";
    case RenderEnd::TimeLimit: return "time limit";
    case RenderEnd::Cancelled: return "interrupted";
  }
  return "";
}

std::string history_line(const RenderStatistics& s, std::uint64_t before, const char* end) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}: {} samples in {:.1f} s, {}", now_utc(), s.samples_taken - before, s.wall_s,
                     end);
}

Metadata render_metadata(const RenderStatistics& s, const Scene& scene, const RenderOptions& options,
                         const FilmInfo& info, const char* end) {
  const RenderSettings& settings = scene.settings;
  Metadata metadata = image_metadata(s);
  const auto add = [&](const char* name, const auto& value) {
    metadata.emplace_back(fmt::format("meristem:{}", name), fmt::format("{}", value));
  };
  add("scene", s.scene);
  add("camera", options.load.camera);
  add("set", fmt::format("{}", fmt::join(options.load.set, " ")));
  if (options.load.frame) add("frame", *options.load.frame);
  add("seed", settings.seed);
  add("max_depth", settings.max_depth);
  add("noise", settings.noise);
  add("samples_taken", s.samples_taken);
  add("expand", s.expand);
  add("budget_bytes", settings.budget_bytes);
  add("ray_order", s.queues ? "queued" : "depth-first");
  add("threads", s.threads);
  add("load_seconds", fmt::format("{:.3f}", s.load_s));
  add("render_seconds", fmt::format("{:.3f}", s.render_s));
  add("rays", s.total_rays());
  add("cells_expanded", s.expansion.cells_expanded);
  add("cells_reexpanded", s.expansion.reexpanded);
  add("cells_evicted", s.expansion.evicted);
  add("faces", s.expansion.faces);
  add("ended", end);
  if (const auto matrices = scene.camera->matrices(settings.width, settings.height)) {
    metadata.emplace_back("worldToCamera", matrix_text(matrices->world_to_camera));
    if (matrices->world_to_picture) metadata.emplace_back("worldToNDC", matrix_text(*matrices->world_to_picture));
  }
  add_samples_and_history(metadata, info);
  return metadata;
}

Metadata merged_metadata(const FilmInfo& info, const std::string& command_line) {
  Metadata metadata = info.metadata;
  for (const char* of_one_run :
       {"seconds", "peak_rss_bytes", "samples_taken", "threads", "load_seconds", "render_seconds", "rays",
        "cells_expanded", "cells_reexpanded", "cells_evicted", "faces", "budget_bytes", "ray_order"})
    std::erase_if(metadata, [&](const auto& m) { return m.first == fmt::format("meristem:{}", of_one_run); });
  replace(metadata, "meristem:command", command_line);
  replace(metadata, "meristem:ended", "merged");
  std::uint64_t samples = 0;
  for (const SampleRange& r : info.ranges) samples += r.last - r.first;
  replace(metadata, "meristem:samples", fmt::format("{}", samples));
  add_samples_and_history(metadata, info);
  return metadata;
}

}  // namespace meristem
