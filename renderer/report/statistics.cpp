#include "renderer/report/statistics.h"

#include "geometry/base/sha256.h"
#include "renderer/language/json_value.h"
#include "renderer/language/json_writer.h"
#include "renderer/report/hints.h"
#include "renderer/report/version.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace meristem {

namespace {

static_assert(std::endian::native == std::endian::little, "image_sha256 hashes floats as they lie in memory");

Value seconds(double s) { return json::number(std::round(s * 1e6) / 1e6); }

Value rays_value(const RenderStatistics& s) {
  return json::object({{"camera", json::count(s.rays.camera)},
                       {"bounce", json::count(s.rays.bounce)},
                       {"shadow", json::count(s.rays.shadow)},
                       {"total", json::count(s.total_rays())}});
}

Value queues_value(const QueueStatistics& q) {
  return json::object({{"waits", json::count(q.waits)},
                       {"served", json::count(q.served)},
                       {"paths_peak", json::count(q.paths_peak)},
                       {"bytes_peak", json::count(q.bytes_peak)}});
}

Value image_value(const ImageStatistics& i) {
  return json::object({{"width", json::number(i.width)},
                       {"height", json::number(i.height)},
                       {"nonfinite", json::count(i.nonfinite)},
                       {"sha256", json::text(i.sha256)}});
}

Value step_value(const StepStatistics& s) {
  return json::object({{"model", json::text(s.model)},
                       {"step", json::text(s.step)},
                       {"cells", json::count(s.cells)},
                       {"faces", json::count(s.faces)},
                       {"time_s", seconds(s.time_s)}});
}

Value expansion_value(const ExpansionStatistics& e) {
  std::vector<Value> steps;
  for (const StepStatistics& step : e.by_step) steps.push_back(step_value(step));
  std::vector<Value> defects;
  for (const std::string& defect : e.defects) defects.push_back(json::text(defect));
  return json::object({{"cells_expanded", json::count(e.cells_expanded)},
                       {"reexpanded", json::count(e.reexpanded)},
                       {"read_back", json::count(e.read_back)},
                       {"scratch_bytes", json::count(e.scratch_bytes)},
                       {"evicted", json::count(e.evicted)},
                       {"failed", json::count(e.failed)},
                       {"faces", json::count(e.faces)},
                       {"time_s", seconds(e.time_s)},
                       {"waits", json::count(e.waits)},
                       {"invalid_rays", json::count(e.invalid_rays)},
                       {"resident_bytes_peak", json::count(e.resident_bytes_peak)},
                       {"limbo_bytes_peak", json::count(e.limbo_bytes_peak)},
                       {"plan_bytes", json::count(e.plan_bytes)},
                       {"total_bytes_peak", json::count(e.total_bytes_peak)},
                       {"defects", json::array(std::move(defects))},
                       {"by_step", json::array(std::move(steps))}});
}

Value hints_value(const std::vector<Hint>& hints) {
  std::vector<Value> list;
  for (const Hint& hint : hints)
    list.push_back(json::object({{"about", json::text(hint.about)},
                                 {"text", json::text(hint.text)},
                                 {"advice", json::boolean(hint.is_advice)}}));
  return json::array(std::move(list));
}

std::string format_rate(double per_second) {
  return per_second >= 1e6 ? fmt::format("{:.2f} M/s", per_second * 1e-6)
                           : fmt::format("{:.1f} k/s", per_second * 1e-3);
}

}  // namespace

std::string image_sha256(const Image& image) {
  Sha256 hash;
  hash.update(image.pixels.data(), image.pixels.size() * sizeof(float));
  return hash.finish();
}

PhaseTimes statistics_phases(const RenderStatistics& s) {
  return phase_times(s.recording->expansion, s.load_s, s.render_s, s.threads, s.expand != "lazy");
}

std::string statistics_json(const RenderStatistics& s) { return to_json(statistics_value(s)) + "\n"; }

Value statistics_value(const RenderStatistics& s) {
  Value value = json::object({{"version", json::text(version)},
                              {"scene", json::text(s.scene)},
                              {"scene_sha256", json::text(s.scene_sha256)},
                              {"command", json::text(s.command)},
                              {"expand", json::text(s.expand)},
                              {"wall_s", seconds(s.wall_s)},
                              {"first_pixel_s", s.first_pixel_s ? seconds(*s.first_pixel_s) : Value{}},
                              {"load_s", seconds(s.load_s)},
                              {"render_s", seconds(s.render_s)},
                              {"peak_rss_bytes", json::count(s.peak_rss_bytes)},
                              {"threads", json::number(s.threads)},
                              {"rays", rays_value(s)},
                              {"rays_per_s", json::number(std::round(s.rays_per_s()))},
                              {"ray_order", json::text(s.queues ? "queued" : "depth-first")},
                              {"ray_queues", s.queues ? queues_value(*s.queues) : Value{}},
                              {"samples", json::number(s.samples)},
                              {"samples_taken", json::count(s.samples_taken)},
                              {"interrupted", json::boolean(s.interrupted)},
                              {"image", image_value(s.image)},
                              {"expansion", expansion_value(s.expansion)}});
  if (!s.recording) return value;
  value.members.push_back({"profile", {}, recording_value(*s.recording, statistics_phases(s))});
  value.members.push_back({"hints", {}, hints_value(hints_of(s))});
  return value;
}

namespace {

// "16", or "5.86 of 4096" where the render was stopped, or its noise was low enough.
std::string samples_text(const RenderStatistics& s) {
  const double pixels = double(s.image.width) * double(s.image.height), mean = double(s.samples_taken) / pixels;
  return mean < s.samples ? fmt::format("{:.3g} of {}", mean, s.samples) : fmt::format("{}", s.samples);
}

}  // namespace

std::string summary(const RenderStatistics& s) {
  std::string text = fmt::format(
      "{} x {} pixels, {} samples in {:.2f} s (first pixel {}), {} rays at {}, {} at most", s.image.width,
      s.image.height, samples_text(s), s.wall_s, s.first_pixel_s ? fmt::format("{:.2f} s", *s.first_pixel_s) : "never",
      format_count(s.total_rays()), format_rate(s.rays_per_s()), format_bytes(s.peak_rss_bytes));
  if (s.expansion.cells_expanded > 0)
    text += fmt::format("; expanded {} cells to {} faces", format_count(s.expansion.cells_expanded),
                        format_count(s.expansion.faces));
  return text;
}

std::string details(const RenderStatistics& s) {
  const ExpansionStatistics& e = s.expansion;
  std::string text = fmt::format("threads {}, load {:.2f} s, render {:.2f} s\n", s.threads, s.load_s, s.render_s);
  text += fmt::format("rays: camera {}, bounce {}, shadow {}\n", format_count(s.rays.camera),
                      format_count(s.rays.bounce), format_count(s.rays.shadow));
  if (s.queues)
    text += fmt::format(
        "queued: at most {} paths at once in {}; {} times one waited, {} times a cell served {} of them\n",
        format_count(s.queues->paths_peak), format_bytes(s.queues->bytes_peak), format_count(s.queues->waits),
        format_count(s.queues->served), format_count(s.queues->waits / std::max<std::uint64_t>(s.queues->served, 1)));
  text += fmt::format(
      "cells: expanded {} (again {}), evicted {}, failed {}; at most {} resident, {} leaving, {} in all\n",
      format_count(e.cells_expanded), format_count(e.reexpanded), format_count(e.evicted), format_count(e.failed),
      format_bytes(e.resident_bytes_peak), format_bytes(e.limbo_bytes_peak), format_bytes(e.total_bytes_peak));
  if (e.scratch_bytes > 0)
    text += fmt::format("scratch file: {}, read back {}\n", format_bytes(e.scratch_bytes), format_count(e.read_back));
  if (e.plan_bytes > 0) text += fmt::format("shared refinement plans: {}\n", format_bytes(e.plan_bytes));
  for (const StepStatistics& step : e.by_step)
    text += fmt::format("  {:<16} {:<28} {:>12} cells {:>14} faces {:>9.3f} s\n", step.model, step.step,
                        format_count(step.cells), format_count(step.faces), step.time_s);
  return text;
}

Metadata image_metadata(const RenderStatistics& s) {
  return {{"Software", fmt::format("Meristem {}", version)},
          {"meristem:version", version},
          {"meristem:scene_sha256", s.scene_sha256},
          {"meristem:command", s.command},
          {"meristem:samples", fmt::format("{}", s.samples)},
          {"meristem:seconds", fmt::format("{:.3f}", s.wall_s)},
          {"meristem:peak_rss_bytes", fmt::format("{}", s.peak_rss_bytes)}};
}

std::string format_bytes(std::uint64_t bytes) {
  const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  double value = double(bytes);
  std::size_t unit = 0;
  for (; value >= 1024 && unit + 1 < std::size(units); ++unit) value /= 1024;
  return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, units[unit]);
}

std::string format_count(std::uint64_t n) {
  std::string digits = fmt::format("{}", n);
  for (std::size_t end = digits.size(); end > 3;) digits.insert(end -= 3, ",");
  return digits;
}

}  // namespace meristem
