#include "renderer/report/comparison.h"

#include "renderer/language/json_writer.h"
#include "renderer/language/jsonc_reader.h"
#include "renderer/language/scene_text.h"
#include "renderer/report/child_process.h"
#include "renderer/report/json_value.h"
#include "renderer/report/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <signal.h>

namespace meristem {

namespace {

constexpr std::array modes{"lazy", "eager", "flat"};
constexpr int faults_code = 3;  // of `meristem render`: a limit was reached or cells failed; the image was written

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "meristem-compare-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw FileError(fmt::format("cannot make {}: {}", name, std::strerror(errno)));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// What one rendering wrote of itself.
struct Run {
  double first_pixel_s, wall_s, load_s, render_s, peak_rss_bytes, faces, cells;
  std::string sha256;
};

double number_at(const Value& object, const char* key) {
  const Value* v = object.find(key);
  return v ? v->number : 0;
}

Run read_run(const std::string& path) {
  Diagnostics diagnostics;
  const auto source = load_scene_text(path, diagnostics);
  diagnostics.throw_if_errors();
  const Value stats = read_jsonc(source, diagnostics);
  diagnostics.throw_if_errors();
  const Value none, *expansion = stats.find("expansion"), *image = stats.find("image");
  const Value* digest = image ? image->find("sha256") : nullptr;
  return {number_at(stats, "first_pixel_s"),
          number_at(stats, "wall_s"),
          number_at(stats, "load_s"),
          number_at(stats, "render_s"),
          number_at(stats, "peak_rss_bytes"),
          number_at(expansion ? *expansion : none, "faces"),
          number_at(expansion ? *expansion : none, "cells_expanded"),
          digest ? digest->text : ""};
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

double median_of(const std::vector<Run>& runs, double Run::*figure) {
  std::vector<double> values;
  for (const Run& run : runs) values.push_back(run.*figure);
  return median(values);
}

void fill_medians(ModeFigures& figures, const std::vector<Run>& runs) {
  figures.runs = int(runs.size());
  if (runs.empty()) return;
  figures.first_pixel_s = median_of(runs, &Run::first_pixel_s);
  figures.wall_s = median_of(runs, &Run::wall_s);
  figures.load_s = median_of(runs, &Run::load_s);
  figures.render_s = median_of(runs, &Run::render_s);
  figures.peak_rss_bytes = std::uint64_t(median_of(runs, &Run::peak_rss_bytes));
  figures.faces = std::uint64_t(median_of(runs, &Run::faces));
  figures.cells = std::uint64_t(median_of(runs, &Run::cells));
  figures.reproducible = std::ranges::all_of(runs, [&](const Run& r) { return r.sha256 == runs[0].sha256; });
}

int render(const ComparisonOptions& options, const std::string& mode, const std::string& image,
           const std::string& stats) {
  std::vector<std::string> arguments{options.program, "render",  options.scene, "--expand", mode,     "-o",
                                     image,           "--float", "--stats",     stats,      "--quiet"};
  arguments.insert(arguments.end(), options.render_options.begin(), options.render_options.end());
  return run_child(arguments);
}

bool was_interrupted(int exit_code) { return exit_code == 128 + SIGINT || exit_code == 128 + SIGTERM; }
bool gave_an_image(int exit_code) { return exit_code == 0 || exit_code == faults_code; }

std::string image_name(const char* mode) { return fmt::format("{}.exr", mode); }

// All runs of all modes in turn; the last image of each mode stays in the folder.
std::array<std::vector<Run>, modes.size()> render_all(const ComparisonOptions& options, const TemporaryFolder& folder,
                                                      Comparison& comparison) {
  std::array<std::vector<Run>, modes.size()> runs;
  for (int run = 1; run <= options.runs; ++run)
    for (std::size_t m = 0; m < modes.size(); ++m) {
      ModeFigures& figures = comparison.modes[m];
      if (figures.exit_code != 0) continue;
      if (options.starting) options.starting(figures.mode, run);
      const std::string stats = folder.file("stats.json");
      const int code = render(options, figures.mode, folder.file(image_name(modes[m])), stats);
      figures.faults |= code == faults_code;
      if (gave_an_image(code))
        runs[m].push_back(read_run(stats));
      else
        figures.exit_code = code;
      if (was_interrupted(code)) return runs;
    }
  return runs;
}

void compare_images(const TemporaryFolder& folder, Comparison& comparison) {
  if (comparison.modes[0].runs == 0) return;
  const Image lazy = read_image(folder.file(image_name(modes[0])));
  comparison.pixels = std::uint64_t(lazy.width) * std::uint64_t(lazy.height);
  for (std::size_t m = 1; m < modes.size(); ++m)
    if (comparison.modes[m].runs > 0)
      comparison.modes[m].difference = image_difference(lazy, read_image(folder.file(image_name(modes[m]))));
}

std::string difference_columns(const ModeFigures& m) {
  if (!m.difference) return fmt::format("{:>12} {:>12} {:>12}", "-", "-", "-");
  return fmt::format("{:>12.3g} {:>12.3g} {:>12}", m.difference->max, m.difference->rms,
                     format_count(m.difference->differing));
}

std::string table_row(const ModeFigures& m) {
  if (m.runs == 0)
    return m.exit_code ? fmt::format("{:<6} failed with exit code {}\n", m.mode, m.exit_code)
                       : fmt::format("{:<6} not run\n", m.mode);
  return fmt::format("{:<6} {:>10.2f} s {:>8.2f} s {:>12} {:>16} {}\n", m.mode, m.first_pixel_s, m.wall_s,
                     format_bytes(m.peak_rss_bytes), format_count(m.faces), difference_columns(m));
}

Value difference_value(const std::optional<ImageDifference>& d) {
  if (!d) return {};
  return json::object({{"max", json::number(d->max)},
                       {"rms", json::number(d->rms)},
                       {"differing_pixels", json::count(d->differing)},
                       {"nonfinite_values", json::count(d->nonfinite)}});
}

Value mode_value(const ModeFigures& m) {
  return json::object({{"mode", json::text(m.mode)},
                       {"exit_code", json::number(m.exit_code)},
                       {"runs", json::number(m.runs)},
                       {"first_pixel_s", json::number(m.first_pixel_s)},
                       {"wall_s", json::number(m.wall_s)},
                       {"load_s", json::number(m.load_s)},
                       {"render_s", json::number(m.render_s)},
                       {"peak_rss_bytes", json::count(m.peak_rss_bytes)},
                       {"faces", json::count(m.faces)},
                       {"cells", json::count(m.cells)},
                       {"faults", json::boolean(m.faults)},
                       {"reproducible", json::boolean(m.reproducible)},
                       {"difference_from_lazy", difference_value(m.difference)}});
}

}  // namespace

int Comparison::exit_code() const {
  for (const ModeFigures& m : modes)
    if (m.exit_code != 0) return m.exit_code;
  return std::ranges::any_of(modes, &ModeFigures::faults) ? faults_code : 0;
}

Comparison compare_modes(const ComparisonOptions& options) {
  Comparison comparison;
  comparison.scene = options.scene;
  for (const char* mode : modes) comparison.modes.push_back({.mode = mode});
  const TemporaryFolder folder;
  const auto runs = render_all(options, folder, comparison);
  for (std::size_t m = 0; m < modes.size(); ++m) fill_medians(comparison.modes[m], runs[m]);
  compare_images(folder, comparison);
  return comparison;
}

std::string comparison_table(const Comparison& comparison) {
  std::string table = fmt::format("{:<6} {:>12} {:>10} {:>12} {:>16} {:>12} {:>12} {:>12}\n", "mode", "first pixel",
                                  "wall", "peak memory", "faces expanded", "max diff", "RMS diff", "pixels diff");
  for (const ModeFigures& m : comparison.modes) table += table_row(m);
  for (const ModeFigures& m : comparison.modes) {
    if (m.difference && m.difference->nonfinite > 0)
      table +=
          fmt::format("{}: {} values are not finite in it or in lazy\n", m.mode, format_count(m.difference->nonfinite));
    if (m.faults) table += fmt::format("{}: rendered with faults\n", m.mode);
    if (!m.reproducible) table += fmt::format("{}: the runs did not give the same bits\n", m.mode);
  }
  return table;
}

std::string comparison_json(const Comparison& comparison) {
  std::vector<Value> list;
  for (const ModeFigures& m : comparison.modes) list.push_back(mode_value(m));
  return to_json(json::object({{"scene", json::text(comparison.scene)},
                               {"pixels", json::count(comparison.pixels)},
                               {"modes", json::array(std::move(list))}})) +
         "\n";
}

}  // namespace meristem
