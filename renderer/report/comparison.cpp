#include "renderer/report/comparison.h"

#include "renderer/color/color.h"
#include "renderer/language/jsonc_reader.h"
#include "renderer/language/scene_text.h"
#include "renderer/report/child_process.h"
#include "renderer/report/flip.h"
#include "renderer/report/statistics.h"
#include "renderer/report/temporary_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <signal.h>

namespace meristem {

namespace {

constexpr int usage_code = 2;   // of `meristem render`: the scene or an option is wrong
constexpr int faults_code = 3;  // of `meristem render`: a limit was reached or cells failed; the image was written
constexpr std::uint64_t no_limit = std::uint64_t(1) << 50;

double number_at(const Value& object, const char* key) {
  const Value* v = object.find(key);
  return v ? v->number : 0;
}

RunFigures run_figures(const Value& stats) {
  const Value none, *expansion = stats.find("expansion"), *image = stats.find("image");
  const Value& e = expansion ? *expansion : none;
  const Value* digest = image ? image->find("sha256") : nullptr;
  RunFigures run;
  run.first_pixel_s = number_at(stats, "first_pixel_s");
  run.wall_s = number_at(stats, "wall_s");
  run.load_s = number_at(stats, "load_s");
  run.render_s = number_at(stats, "render_s");
  run.peak_rss_bytes = std::uint64_t(number_at(stats, "peak_rss_bytes"));
  run.resident_bytes_peak = std::uint64_t(number_at(e, "resident_bytes_peak"));
  run.faces = std::uint64_t(number_at(e, "faces"));
  run.cells = std::uint64_t(number_at(e, "cells_expanded"));
  run.image_sha256 = digest ? digest->text : "";
  return run;
}

template <class T>
double median_of(const std::vector<RunFigures>& runs, T RunFigures::*figure) {
  std::vector<double> values;
  for (const RunFigures& run : runs) values.push_back(double(run.*figure));
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

bool was_interrupted(int exit_code) { return exit_code == 128 + SIGINT || exit_code == 128 + SIGTERM; }
bool gave_an_image(int exit_code) { return exit_code == 0 || exit_code == faults_code; }

std::string budget_name(const BudgetChoice& b) {
  return b.bytes ? fmt::format("lazy {}", format_bytes(b.bytes)) : fmt::format("lazy {:.3g} %", b.share * 100);
}

std::vector<Variant> variants_of(const ComparisonOptions& options) {
  std::vector<Variant> list{{.name = "lazy", .mode = "lazy"}};
  if (!options.budgets.empty()) list[0].budget.bytes = no_limit;
  for (const BudgetChoice& b : options.budgets) list.push_back({.name = budget_name(b), .mode = "lazy", .budget = b});
  list.push_back({.name = "eager", .mode = "eager"});
  list.push_back({.name = "flat", .mode = "flat"});
  return list;
}

// Renders the variants; their last images stay in a folder while it lives.
class Renderings {
 public:
  Renderings(const ComparisonOptions& options, Comparison& comparison) : options_(options), comparison_(comparison) {}

  void run() {
    for (int run = 1; run <= options_.runs; ++run)
      for (std::size_t i = 0; i < variants().size(); ++i)
        if (!measure(i, run)) return;
    for (std::size_t i = 0; options_.record && i < variants().size(); ++i)
      if (variants()[i].mode != "flat" && !record(i)) return;
  }

  void compare_images() {
    if (variants()[0].runs.empty()) return;
    const Image reference = read_image(image_file(0));
    comparison_.pixels = std::uint64_t(reference.width) * std::uint64_t(reference.height);
    const DisplayTransform transform("");
    const auto shown = [&](Image image) {
      transform.apply(image.pixels.data(), image.width, image.height, image.channels);
      return image;
    };
    variants()[0].shown = shown(reference);
    for (std::size_t i = 1; i < variants().size(); ++i) {
      Variant& v = variants()[i];
      if (v.runs.empty()) continue;
      const Image image = read_image(image_file(i));
      v.difference = image_difference(reference, image);
      v.shown = shown(image);
      if (v.difference->identical()) continue;
      v.flip = flip(*variants()[0].shown, *v.shown);
      v.flip_mean = mean_value(*v.flip);
    }
  }

 private:
  std::vector<Variant>& variants() { return comparison_.variants; }
  std::string image_file(std::size_t variant) const { return folder_.file(fmt::format("{}.exr", variant)); }

  int render(const Variant& v, const std::string& image, const std::string& stats, bool recorded) const {
    std::vector<std::string> arguments{options_.program, "render",  options_.scene, "--expand", v.mode, "-o", image,
                                       "--float",        "--stats", stats,          "--quiet"};
    arguments.insert(arguments.end(), options_.render_options.begin(), options_.render_options.end());
    if (v.budget.bytes) arguments.insert(arguments.end(), {"--budget", std::to_string(v.budget.bytes)});
    if (recorded) arguments.push_back("--profile");
    return run_child(arguments);
  }

  // False if the user wants no more, or the first rendering says that all of them would fail.
  bool measure(std::size_t i, int run) {
    Variant& v = variants()[i];
    if (v.exit_code != 0 || !resolve_budget(v)) return true;
    if (options_.starting) options_.starting(v.name, run);
    const std::string stats = folder_.file("stats.json");
    const int code = render(v, image_file(i), stats, false);
    v.faults |= code == faults_code;
    if (gave_an_image(code))
      v.runs.push_back(run_figures(read_statistics(stats)));
    else
      v.exit_code = code;
    return !was_interrupted(code) && !(code == usage_code && i == 0);
  }

  bool record(std::size_t i) {
    Variant& v = variants()[i];
    if (v.runs.empty()) return true;
    if (options_.starting) options_.starting(v.name, 0);
    const std::string stats = folder_.file("stats.json");
    const int code = render(v, folder_.file("recorded.exr"), stats, true);
    if (gave_an_image(code)) v.statistics = read_statistics(stats);
    return !was_interrupted(code);
  }

  // A share becomes bytes once the first variant, without limit, tells what there is to share.
  bool resolve_budget(Variant& v) {
    if (v.budget.share <= 0 || v.budget.bytes) return true;
    if (variants()[0].runs.empty()) return false;
    v.budget.bytes =
        std::max<std::uint64_t>(1, std::uint64_t(v.budget.share * double(variants()[0].runs[0].resident_bytes_peak)));
    v.name += fmt::format(" ({})", format_bytes(v.budget.bytes));
    return true;
  }

  const ComparisonOptions& options_;
  Comparison& comparison_;
  const TemporaryFolder folder_;
};

}  // namespace

Value read_statistics(const std::string& path) {
  Diagnostics diagnostics;
  const auto source = load_scene_text(path, diagnostics);
  diagnostics.throw_if_errors();
  Value stats = read_jsonc(source, diagnostics);
  diagnostics.throw_if_errors();
  return stats;
}

double Variant::median(double RunFigures::*figure) const { return median_of(runs, figure); }
std::uint64_t Variant::median(std::uint64_t RunFigures::*figure) const {
  return std::uint64_t(median_of(runs, figure));
}

bool Variant::reproducible() const {
  return std::ranges::all_of(runs, [&](const RunFigures& r) { return r.image_sha256 == runs[0].image_sha256; });
}

int Comparison::exit_code() const {
  for (const Variant& v : variants)
    if (v.exit_code != 0) return v.exit_code;
  return std::ranges::any_of(variants, &Variant::faults) ? faults_code : 0;
}

Comparison compare_modes(const ComparisonOptions& options) {
  Comparison comparison;
  comparison.scene = options.scene;
  comparison.variants = variants_of(options);
  Renderings renderings(options, comparison);
  renderings.run();
  renderings.compare_images();
  return comparison;
}

}  // namespace meristem
