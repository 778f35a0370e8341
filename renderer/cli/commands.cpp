#include "renderer/cli/commands.h"

#include "renderer/cli/console.h"
#include "renderer/cli/outputs.h"
#include "renderer/language/describe.h"
#include "renderer/language/json_writer.h"
#include "renderer/language/schema.h"
#include "renderer/loading/all_components.h"
#include "renderer/report/page.h"
#include "renderer/report/profile_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace meristem {

namespace {

// Of faces, of which nobody wants to know the last one.
std::string rounded_count(double count) {
  if (count < 1e6) return fmt::format("{:.0f}", count);
  return count < 1e9 ? fmt::format("{:.3g} million", count / 1e6) : fmt::format("{:.2g}", count);
}

std::string scene_summary(const std::string& path, const LoadedScene& loaded) {
  const Scene& scene = *loaded.scene;
  const RenderSettings& settings = scene.settings;
  const Bounds3f bounds = scene.intersector->bounds();
  std::string text = fmt::format("{}: no errors, {} warnings\n", path, loaded.warnings.size());
  text += fmt::format("  image      {} x {} pixels, {} samples, {} bounces\n", settings.width, settings.height,
                      settings.samples, settings.max_depth);
  text += fmt::format("  lights     {}\n  materials  {}\n", scene.lights.size(), scene.materials.size());
  for (const auto& [name, faces] : loaded.models)
    text += fmt::format("  model      {}: {} faces in full, estimated\n", name, rounded_count(faces));
  if (!bounds.empty())
    text += fmt::format("  bounds     [{:.4g}, {:.4g}, {:.4g}] to [{:.4g}, {:.4g}, {:.4g}]\n", bounds.lower.x,
                        bounds.lower.y, bounds.lower.z, bounds.upper.x, bounds.upper.y, bounds.upper.z);
  return text + fmt::format("  sha256     {}\n", loaded.sha256);
}

// The texts of the member "hints" of statistics.
std::vector<std::string> hint_texts(const Value& statistics) {
  std::vector<std::string> texts;
  if (const Value* hints = statistics.find("hints"))
    for (const Value& hint : hints->items)
      if (const Value* text = hint.find("text")) texts.push_back(text->text);
  return texts;
}

}  // namespace

int compare_command(const CompareOptions& options) {
  if (options.scene == "-") throw UsageError("compare reads the scene several times: it needs a file");
  check_targets(options.scene, {options.page});
  if (!options.page.empty()) check_writable(options.page);
  ComparisonOptions comparison_options;
  comparison_options.scene = options.scene;
  comparison_options.runs = options.runs;
  comparison_options.budgets = options.budgets;
  comparison_options.record = !options.page.empty();
  comparison_options.render_options = options.render_options;
  comparison_options.starting = [&](const std::string& name, int run) {
    print_error(run > 0 ? fmt::format("rendering {} (run {} of {})", name, run, options.runs)
                        : fmt::format("recording {}", name));
  };
  const Comparison comparison = compare_modes(comparison_options);
  if (std::ranges::all_of(comparison.variants, [](const Variant& v) { return v.runs.empty(); }))
    return comparison.exit_code();  // why has been said
  print_result(options.json ? comparison_json(comparison) : comparison_table(comparison));
  if (!options.page.empty()) {
    write_file(options.page, report_page(comparison_page_data(comparison, options.command_line)));
    print_error("wrote " + options.page);
  }
  return comparison.exit_code();
}

int profile_command(const ProfileOptions& options) {
  if (options.scene == "-") throw UsageError("profile starts another process: it needs a file");
  const std::string page =
      options.page.empty() ? std::filesystem::path(options.scene).stem().string() + ".html" : options.page;
  check_targets(options.scene, {page, options.statistics, options.trace});
  check_writable(page);
  if (!options.statistics.empty()) check_writable(options.statistics);
  ProfileRunOptions run_options;
  run_options.scene = options.scene;
  run_options.render_options = options.render_options;
  run_options.trace = options.trace;
  run_options.command = options.command_line;
  ProfileRun run = run_profile(run_options);
  if (run.statistics.kind == Value::Kind::Null) return run.exit_code;
  for (const std::string& text : hint_texts(run.statistics)) print_result("- " + text);
  if (!options.statistics.empty()) write_file(options.statistics, to_json(run.statistics) + "\n");
  write_file(page, report_page(run.page_data));
  print_error("wrote " + page);
  return run.exit_code;
}

int check_command(const std::string& path, const SceneLoader& load) {
  LoadOptions options;
  options.check_only = true;
  const LoadedScene loaded = load(path, options);
  print_diagnostics(loaded.warnings);
  print_result(scene_summary(path, loaded));
  return int(ExitCode::Done);
}

int describe_command(const std::string& name) {
  const std::string page = describe(catalogue(), name);
  if (page.empty()) {
    const std::vector<std::string> names = described_names(catalogue());
    const std::string_view near = nearest_name(name, names);
    throw UsageError(fmt::format("nothing is named \"{}\"{}; `meristem describe` lists what there is", name,
                                 near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near)));
  }
  print_result(page);
  return int(ExitCode::Done);
}

std::vector<std::string> component_names() { return described_names(catalogue()); }

int describe_markdown_command() {
  print_result(markdown(catalogue()));
  return int(ExitCode::Done);
}

int schema_command() {
  print_result(json_schema(catalogue()));
  return int(ExitCode::Done);
}

}  // namespace meristem
