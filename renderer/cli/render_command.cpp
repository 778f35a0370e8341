#include "renderer/cli/render_command.h"

#include "geometry/base/parallel.h"
#include "renderer/cli/console.h"
#include "renderer/color/color.h"
#include "renderer/report/statistics.h"
#include "renderer/session/interruption.h"
#include "renderer/session/process_clock.h"
#include "renderer/session/progress.h"
#include "renderer/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <thread>

namespace meristem {

namespace {

const char* mode_name(ExpandMode mode) {
  switch (mode) {
    case ExpandMode::Lazy: return "lazy";
    case ExpandMode::Eager: return "eager";
    case ExpandMode::Flat: return "flat";
  }
  return "";
}

std::vector<std::string> outputs_of(const RenderOptions& options) {
  if (!options.outputs.empty()) return options.outputs;
  const std::string stem = options.scene == "-" ? "image" : std::filesystem::path(options.scene).stem().string();
  return {stem + ".exr", stem + ".png"};
}

bool is_display_image(const std::string& path) { return image_format(path) != ImageFormat::Exr; }

void check_outputs(const RenderOptions& options, const std::vector<std::string>& outputs) {
  check_image_support();
  for (const std::string& path : outputs) check_writable(path);
  if (!options.statistics.empty()) check_writable(options.statistics);
}

// The transform that the outputs need; none if all are scene-linear.
std::optional<DisplayTransform> display_transform(const RenderOptions& options,
                                                  const std::vector<std::string>& outputs) {
  if (options.view.empty() && std::ranges::none_of(outputs, is_display_image)) return std::nullopt;
  return DisplayTransform(options.view, options.exposure);
}

void check_crop(const RenderOptions& options, const RenderSettings& settings) {
  if (options.crop && options.crop->intersected({0, 0, settings.width, settings.height}).empty())
    throw UsageError(fmt::format("--crop lies outside the image of {} x {} pixels", settings.width, settings.height));
}

// Opens what writing the image needs while rays are traced: from the first report of progress on, when the first pixel
// stands, since the dynamic linker's lock would hold up the libraries that are still starting.
class ImageSupport {
 public:
  void want() {
    if (!opening_.joinable()) opening_ = std::jthread(open_image_support);
  }

 private:
  std::jthread opening_;
};

SessionOptions session_options(const RenderOptions& options, int threads, const Interruption& interruption,
                               ProgressDisplay& display, ImageSupport& images) {
  SessionOptions result;
  result.threads = threads;
  result.crop = options.crop;
  result.cancel = &interruption.requested();
  result.progress = [&](const RenderProgress& progress) {
    images.want();
    display.update(progress);
  };
  return result;
}

RenderStatistics gather(const RenderOptions& options, const LoadedScene& loaded, const SessionResult& result,
                        const Film& film, const Image& image) {
  RenderStatistics s;
  s.scene = options.scene;
  s.scene_sha256 = loaded.sha256;
  s.command = options.command_line;
  s.expand = mode_name(options.load.expand);
  s.render_s = result.render_s;
  s.first_pixel_s = result.first_pixel_s;
  s.rays = result.rays;
  s.samples = loaded.scene->settings.samples;
  s.samples_taken = result.samples;
  s.interrupted = result.cancelled;
  s.image = {image.width, image.height, film.nonfinite_samples(), image_sha256(image)};
  s.expansion = loaded.scene->intersector->statistics();
  return s;
}

// What the process itself says; once more after the images are written.
void take_time_and_memory(RenderStatistics& s) {
  s.wall_s = process_age_s();
  s.peak_rss_bytes = peak_resident_bytes();
}

WriteOptions placed(WriteOptions options, const PixelWindow& window, const RenderSettings& settings) {
  options.x = window.x0;
  options.y = window.y0;
  options.full_width = settings.width;
  options.full_height = settings.height;
  return options;
}

void write_one(const std::string& path, const Image& image, const Metadata& metadata, const WriteOptions& options) {
  if (const std::size_t clamped = write_image(path, image, metadata, options); clamped > 0)
    print_error(
        fmt::format("warning: {}: {} values clamped to the range of a half; --float keeps them", path, clamped));
}

void write_images(const std::vector<std::string>& outputs, const Image& image,
                  const std::optional<DisplayTransform>& transform, const Metadata& metadata,
                  const WriteOptions& options) {
  Image shown;
  if (transform && std::ranges::any_of(outputs, is_display_image)) {
    shown = image;
    transform->apply(shown.pixels.data(), shown.width, shown.height, shown.channels);
  }
  for (const std::string& path : outputs) write_one(path, is_display_image(path) ? shown : image, metadata, options);
}

// Says what broke while rendering; true if anything did.
bool report_faults(const RenderStatistics& s) {
  if (s.image.nonfinite > 0)
    print_error(
        fmt::format("warning: {} samples were not finite and left out of the image", format_count(s.image.nonfinite)));
  if (s.expansion.failed > 0)
    print_error(fmt::format("warning: {} cells are drawn as their bounds or reach beyond them",
                            format_count(s.expansion.failed)));
  for (const std::string& defect : s.expansion.defects) print_error("warning: " + defect);
  if (s.expansion.invalid_rays > 0)
    print_error(
        fmt::format("warning: {} rays were not finite and hit nothing", format_count(s.expansion.invalid_rays)));
  return s.image.nonfinite > 0 || s.expansion.failed > 0;
}

void report_done(const RenderOptions& options, const RenderStatistics& s, const std::vector<std::string>& outputs) {
  if (options.quiet) return;
  print_error(summary(s));
  if (options.verbose) print_error(details(s));
  for (const std::string& path : outputs) print_error(fmt::format("wrote {}", path));
}

}  // namespace

int render_command(const RenderOptions& options, const SceneLoader& load) {
  const std::vector<std::string> outputs = outputs_of(options);
  check_outputs(options, outputs);
  const std::optional<DisplayTransform> transform = display_transform(options, outputs);
  const int threads = options.load.threads > 0 ? options.load.threads : default_thread_count();
  const ThreadLimit limit(threads);

  const double loading_s = process_age_s();
  const LoadedScene loaded = load(options.scene, options.load);
  const double load_s = process_age_s() - loading_s;
  if (!options.quiet) print_diagnostics(loaded.warnings);
  check_crop(options, loaded.scene->settings);

  const Interruption interruption;
  std::optional<ProgressDisplay> display;
  display.emplace(stderr, options.quiet ? ProgressDisplay::Style::None : ProgressDisplay::style_for(stderr));
  ImageSupport images;
  RenderSession session(*loaded.scene, session_options(options, threads, interruption, *display, images));
  const SessionResult result = session.render();
  display.reset();
  const int interrupted = result.cancelled ? int(ExitCode::Interrupted) + interruption.signal() : 0;
  if (result.samples == 0 && interrupted) {
    print_error("interrupted before the first pixel: nothing was written");
    return interrupted;
  }

  const Image image = session.film().develop();
  RenderStatistics statistics = gather(options, loaded, result, session.film(), image);
  statistics.load_s = load_s;
  statistics.threads = threads;
  take_time_and_memory(statistics);
  write_images(outputs, image, transform, image_metadata(statistics),
               placed(options.write, session.film().window(), loaded.scene->settings));
  take_time_and_memory(statistics);
  if (!options.statistics.empty()) write_file(options.statistics, statistics_json(statistics));
  report_done(options, statistics, outputs);
  const bool faults = report_faults(statistics);
  return interrupted ? interrupted : int(faults ? ExitCode::Limit : ExitCode::Done);
}

}  // namespace meristem
