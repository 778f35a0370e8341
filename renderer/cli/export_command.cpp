#include "renderer/cli/export_command.h"

#include "renderer/cli/console.h"
#include "renderer/cli/exit_code.h"
#include "renderer/interchange/export_scene.h"
#include "renderer/interchange/material_looks.h"
#include "renderer/report/statistics.h"
#include "renderer/session/process_clock.h"

#include <fmt/format.h>

#include <cstdio>

#include <unistd.h>

namespace meristem {

namespace {

// A line that is written over, on a terminal.
class ExportProgress {
 public:
  explicit ExportProgress(bool quiet) : shown_(!quiet && ::isatty(STDERR_FILENO)) {}
  void update(double done, std::uint64_t triangles) {
    constexpr double pause_s = 0.2;
    if (!shown_ || process_age_s() - last_s_ < pause_s) return;
    last_s_ = process_age_s();
    fmt::print(stderr, "\r{:3.0f} %, {} triangles  ", 100 * done, format_count(triangles));
    std::fflush(stderr);
  }
  void clear() const {
    if (shown_ && last_s_ > 0) fmt::print(stderr, "\r{:40}\r", "");
  }

 private:
  const bool shown_;
  double last_s_ = 0;
};

std::string summary(const ExportFigures& f, const std::string& path) {
  std::string text = fmt::format("{} triangles and {} vertices of {} surfaces", format_count(f.triangles),
                                 format_count(f.vertices), format_count(f.surfaces));
  if (f.places > f.surfaces)
    text += fmt::format(", which stand in {} places: {} triangles are seen", format_count(f.places),
                        format_count(f.shown_triangles));
  text += fmt::format("\n{:.2f} s, at most {:.0f} MiB\n", process_age_s(), double(peak_resident_bytes()) / 1048576);
  for (const MaterialLook& m : f.materials)
    if (m.varies)
      text += fmt::format("material \"{}\" varies: {} of it; its other parameters are means\n", m.name,
                          path.ends_with(".obj") ? "the mean colour" : "vertices have the colour");
  return text + "wrote " + path;
}

}  // namespace

int export_command(const ExportOptions& options, const SceneLoader& load) {
  check_writable(options.output);
  LoadOptions load_options = options.load;
  load_options.check_only = load_options.keep_objects = true;
  const LoadedScene scene = load(options.scene, load_options);
  if (!options.quiet) print_diagnostics(scene.warnings);
  const auto writer =
      make_mesh_writer(options.output, MaterialLooks(*scene.scene).any_varies(), scene.scene->names.materials);
  ExportProgress progress(options.quiet);
  try {
    const ExportFigures figures =
        export_scene(scene, *writer, [&](double done, std::uint64_t triangles) { progress.update(done, triangles); });
    progress.clear();
    if (!options.quiet) print_error(summary(figures, options.output));
    return int(ExitCode::Done);
  } catch (const TooMany& error) {
    progress.clear();
    print_error(fmt::format("error: {}; --detail makes it fewer", error.what()));
    return int(ExitCode::Limit);
  }
}

}  // namespace meristem
