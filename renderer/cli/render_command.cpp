#include "renderer/cli/render_command.h"

#include "geometry/base/parallel.h"
#include "geometry/base/process_memory.h"
#include "renderer/cli/console.h"
#include "renderer/cli/film_identity.h"
#include "renderer/cli/render_metadata.h"
#include "renderer/denoise/denoise.h"
#include "renderer/image/texture.h"
#include "renderer/report/statistics.h"
#include "renderer/session/interruption.h"
#include "renderer/session/process_clock.h"
#include "renderer/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <thread>

namespace meristem {

namespace fs = std::filesystem;

namespace {

const char* mode_name(ExpandMode mode) {
  switch (mode) {
    case ExpandMode::Lazy: return "lazy";
    case ExpandMode::Eager: return "eager";
    case ExpandMode::Flat: return "flat";
  }
  return "";
}

OutputOptions outputs_of(const RenderOptions& options) {
  OutputOptions outputs = options.outputs;
  const std::string stem = options.scene == "-" ? "image" : fs::path(options.scene).stem().string();
  if (outputs.files.empty()) outputs.files = {stem + ".exr", stem + ".png"};
  return outputs;
}

// Where the film is kept while there is more to do: a film file that was asked for, or one beside the first image.
std::string film_path(const std::vector<std::string>& files) {
  const auto asked_for = std::ranges::find_if(files, is_film_file);
  return asked_for != files.end() ? *asked_for : fs::path(files[0]).replace_extension(".film").string();
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
  const std::vector<std::string> textures = texture_faults();
  for (const std::string& fault : textures) print_error("warning: " + fault);
  return s.image.nonfinite > 0 || s.expansion.failed > 0 || !textures.empty();
}

// Opens the module that some formats need while rays are traced: from the first report of progress on, when the first
// pixel stands, since the dynamic linker's lock would hold up the libraries that are still starting.
class ImageModule {
 public:
  void want() {
    if (!opening_.joinable()) opening_ = std::jthread(open_image_module);
  }

 private:
  std::jthread opening_;
};

// One image: loads the scene, renders it, writes what was asked for, now and then and at the end.
class ImageRender {
 public:
  ImageRender(const RenderOptions& options, const SceneLoader& load, OutputOptions outputs)
      : options_(options),
        film_path_(film_path(outputs.files)),
        outputs_(std::move(outputs)),
        threads_(options.load.threads > 0 ? options.load.threads : default_thread_count()),
        limit_(threads_) {
    std::vector<std::string> targets = outputs_.files();
    targets.insert(targets.end(), {options.statistics, options.trace});
    check_targets(options.scene, targets);
    check_writable(film_path_);
    if (!options.statistics.empty()) check_writable(options.statistics);
    if (!options.trace.empty()) check_writable(options.trace);
    if (!options.trace.empty() && options.load.expand == ExpandMode::Flat)
      throw UsageError("--trace shows the expansion of cells; --expand flat has none");
    const double loading_s = process_age_s();
    LoadOptions load_options = options.load;
    load_options.record = options.profile || !options.trace.empty();
    if (options.outputs.denoise)
      load_options.aovs.insert(load_options.aovs.end(), denoise::wanted_aovs().begin(), denoise::wanted_aovs().end());
    loaded_ = load(options.scene, load_options);
    load_s_ = process_age_s() - loading_s;
    if (options.sample_range) settings().samples = int(options.sample_range->last - options.sample_range->first);
    if (!options.quiet) print_diagnostics(loaded_.warnings);
    check_settings();
    interruption_.emplace();  // until here a signal ends the program
  }
  ImageRender(const ImageRender&) = delete;
  ImageRender& operator=(const ImageRender&) = delete;

  // Returns an exit code.
  int run() {
    ProgressDisplay display(style() == ProgressDisplay::Style::Json ? stdout : stderr, style());
    RenderSession session(*loaded_.scene, session_options(display));
    session_ = &session;
    if (options_.checkpoint_s || options_.resume) identity();  // before a file can change
    if (options_.resume) resume();
    last_snapshot_s_ = process_age_s();
    const SessionResult result = session.render();
    display.clear();
    return finish(result);
  }

 private:
  RenderSettings& settings() { return loaded_.scene->settings; }
  const RenderSettings& settings() const { return loaded_.scene->settings; }

  void check_settings() const {
    const PixelWindow whole{0, 0, settings().width, settings().height},
        window = options_.crop ? options_.crop->intersected(whole) : whole;
    if (window.empty())
      throw UsageError(
          fmt::format("--crop lies outside the image of {} x {} pixels", settings().width, settings().height));
    check_film_fits(window);
    if (options_.sample_range && settings().noise > 0)
      throw UsageError("--sample-range takes all samples of its range; it does not go together with noise");
  }

  static void check_film_fits(const PixelWindow& window) {
    constexpr double gibibyte = 1 << 30;
    const double film = double(window.width()) * double(window.height()) * double(Film::least_bytes_a_pixel),
                 memory = double(machine_memory_bytes());
    if (memory > 0 && film > memory)
      throw UsageError(
          fmt::format("an image of {} x {} pixels takes at least {:.3g} GiB while it is rendered, and this machine has "
                      "{:.3g}; render it in parts with --crop",
                      window.width(), window.height(), film / gibibyte, memory / gibibyte));
  }

  ProgressDisplay::Style style() const {
    if (options_.progress) return *options_.progress;
    return options_.quiet ? ProgressDisplay::Style::None : ProgressDisplay::style_for(stderr);
  }

  std::uint32_t first_sample() const { return options_.sample_range ? options_.sample_range->first : 0; }

  SessionOptions session_options(ProgressDisplay& display) {
    SessionOptions result;
    result.threads = threads_;
    result.crop = options_.crop;
    result.first_sample = first_sample();
    if (options_.time_limit_s) result.time_limit_s = *options_.time_limit_s;
    result.cancel = &interruption_->requested();
    result.progress = [this, &display](const RenderProgress& progress) {
      if (outputs_.needs_image_module()) image_module_.want();
      display.update(progress);
      memory_.add({process_age_s(), resident_set_bytes()});
    };
    result.snapshot_due = [this] { return snapshot_is_due(); };
    result.snapshot = [this] { take_snapshot(); };
    return result;
  }

  const FilmIdentity& identity() {
    if (identity_.empty()) identity_ = film_identity(options_, loaded_, session_->film().window());
    return identity_;
  }

  void resume() {
    if (!fs::exists(film_path_)) {
      if (!options_.quiet) print_error(fmt::format("nothing to resume: there is no {}", film_path_));
      return;
    }
    FilmFile file = read_film_file(film_path_);
    if (const std::string difference = identity_difference(file.info.identity, identity()); !difference.empty())
      throw UsageError(fmt::format("cannot resume from {}: {}", film_path_, difference));
    if (file.info.ranges.size() != 1 || file.info.ranges[0].first != first_sample())
      throw UsageError(
          fmt::format("cannot resume from {}: it does not begin at sample {}", film_path_, first_sample()));
    if (const std::uint32_t taken = file.info.ranges[0].last - first_sample();
        taken > std::uint32_t(settings().samples))
      throw UsageError(
          fmt::format("cannot resume from {}: pixels have up to {} samples already, more than the {} wanted",
                      film_path_, taken, settings().samples));
    history_ = std::move(file.info.history);
    samples_before_ = file.film.total_samples();
    session_->resume(std::move(file.film), std::move(file.adaptive));
    if (!options_.quiet)
      print_error(fmt::format("going on from {} with {} samples", film_path_, format_count(samples_before_)));
  }

  bool snapshot_is_due() {
    const bool asked_for = interruption_->take_snapshot_request();
    return asked_for || (options_.checkpoint_s && process_age_s() - last_snapshot_s_ >= *options_.checkpoint_s);
  }

  void take_snapshot() {
    SessionResult so_far;
    so_far.samples = session_->film().total_samples();
    const RenderStatistics s = statistics(so_far, loaded_.scene->intersector->statistics());
    write_everything(s, "snapshot", true);
    last_snapshot_s_ = process_age_s();
    if (options_.verbose) print_error(fmt::format("snapshot: wrote {}", film_path_));
  }

  // The images, and what is needed to go on.
  void write_everything(const RenderStatistics& s, const char* end, bool keep_film) {
    const FilmInfo now = info(s, end);
    if (keep_film && !film_is_output()) {
      write_film_file(film_path_, session_->film(), now, session_->adaptive());
      film_written_ = true;
    }
    outputs_.write(session_->film(), now, session_->adaptive());
  }

  bool film_is_output() const { return std::ranges::find(outputs_.files(), film_path_) != outputs_.files().end(); }

  FilmInfo info(const RenderStatistics& s, const char* end) {
    const RenderSettings& r = settings();
    FilmInfo result{identity(), {sample_range()}, r.width, r.height, loaded_.scene->names, {}, history_};
    result.history.push_back(history_line(s, samples_before_, end));
    result.metadata = render_metadata(s, *loaded_.scene, options_, result, end);
    return result;
  }

  // Of the samples that the film has; pixels that had fewer are left to whoever goes on.
  SampleRange sample_range() const {
    const PixelWindow& w = session_->film().window();
    std::uint32_t most = 0;
    for (int y = w.y0; y < w.y1; ++y)
      for (int x = w.x0; x < w.x1; ++x) most = std::max(most, session_->film().samples(x, y));
    return {first_sample(), first_sample() + most};
  }

  RenderStatistics statistics(const SessionResult& result, ExpansionStatistics expansion) const {
    const Film& film = session_->film();
    const Image image = film.develop();
    RenderStatistics s;
    s.scene = options_.scene;
    s.scene_sha256 = loaded_.sha256;
    s.command = options_.command_line;
    s.expand = mode_name(options_.load.expand);
    s.load_s = load_s_;
    s.threads = threads_;
    s.render_s = result.render_s;
    s.first_pixel_s = result.first_pixel_s;
    s.rays = result.rays;
    s.queues = result.queues;
    s.samples = settings().samples;
    s.samples_taken = result.samples;
    s.interrupted = result.end == RenderEnd::Cancelled;
    s.image = {image.width, image.height, film.nonfinite_samples(), image_sha256(image)};
    s.expansion = std::move(expansion);
    s.wall_s = process_age_s();
    s.peak_rss_bytes = peak_resident_bytes();
    return s;
  }

  // Writes the files, then the reports.
  int finish(const SessionResult& result) {
    std::optional<Recording> recorded = recording();
    const int interrupted =
        result.end == RenderEnd::Cancelled ? int(ExitCode::Interrupted) + interruption_->signal() : 0;
    if (result.samples == 0 && result.end != RenderEnd::Complete) {
      print_error("interrupted before the first pixel: nothing was written");
      return interrupted ? interrupted : int(ExitCode::Limit);
    }
    ExpansionStatistics expansion = loaded_.scene->intersector->statistics();
    loaded_.scene->intersector.reset();  // images are made in the memory that geometry took
    RenderStatistics s = statistics(result, std::move(expansion));
    try {
      write_everything(s, end_name(result.end), result.end != RenderEnd::Complete);
    } catch (const FileError&) {
      if (result.end == RenderEnd::Complete && !film_is_output()) keep_film(s);
      throw;
    }
    if (result.end == RenderEnd::Complete) remove_film();
    s.wall_s = process_age_s();
    s.peak_rss_bytes = peak_resident_bytes();
    s.recording = std::move(recorded);
    if (!options_.statistics.empty()) write_file(options_.statistics, statistics_json(s));
    if (!options_.trace.empty()) write_file(options_.trace, chrome_trace(*s.recording, load_s_, s.render_s));
    report(s, result.end);
    const bool faults = report_faults(s);
    if (interrupted) return interrupted;
    return int(faults || result.end == RenderEnd::TimeLimit ? ExitCode::Limit : ExitCode::Done);
  }

  // Nothing if nothing was recorded.
  std::optional<Recording> recording() const {
    std::optional<ExpansionProfile> profile = loaded_.scene->intersector->profile();
    if (!profile) return {};
    const double start_s = process_age_s() - profile->duration_s;
    return Recording{std::move(*profile), start_s, memory_};
  }

  // So that what was rendered is not lost with an image that could not be written.
  void keep_film(const RenderStatistics& s) {
    try {
      write_film_file(film_path_, session_->film(), info(s, end_name(RenderEnd::Complete)), session_->adaptive());
      print_error(
          fmt::format("all samples are kept: the same command with --resume writes the images from {}", film_path_));
    } catch (const FileError&) {  // there is no place for it either
    }
  }

  // The film file has served, unless it was asked for.
  void remove_film() const {
    std::error_code ignored;
    if ((film_written_ || samples_before_ > 0) && !film_is_output()) fs::remove(film_path_, ignored);
  }

  void report(const RenderStatistics& s, RenderEnd end) const {
    if (options_.quiet) return;
    print_error(summary(s));
    if (options_.verbose) print_error(details(s));
    for (const std::string& path : outputs_.files()) print_error(fmt::format("wrote {}", path));
    if (end != RenderEnd::Complete)
      print_error(fmt::format("{}; the same command with --resume goes on from {}",
                              end == RenderEnd::TimeLimit ? "the time is up" : "interrupted", film_path_));
  }

  const RenderOptions& options_;
  const std::string film_path_;
  const Outputs outputs_;
  const int threads_;
  const ThreadLimit limit_;
  LoadedScene loaded_;
  double load_s_ = 0;
  std::optional<Interruption> interruption_;
  ImageModule image_module_;
  MemorySamples memory_;
  RenderSession* session_ = nullptr;  // while it runs
  FilmIdentity identity_;             // empty until somebody asks
  std::vector<std::string> history_;  // of the runs before
  std::uint64_t samples_before_ = 0;  // that these took
  double last_snapshot_s_ = 0;
  bool film_written_ = false;
};

// "a.exr" to "a.0007.exr"; a run of # in the name is where the number goes, not one in the name of a folder.
std::string numbered(const std::string& path, int frame) {
  const std::size_t name = path.size() - fs::path(path).filename().string().size(), first = path.find('#', name);
  if (first == std::string::npos) {
    const fs::path p(path);
    return (p.parent_path() / fmt::format("{}.{:04}{}", p.stem().string(), frame, p.extension().string())).string();
  }
  const std::size_t end = std::min(path.find_first_not_of('#', first), path.size());
  return path.substr(0, first) + fmt::format("{:0{}}", frame, end - first) + path.substr(end);
}

// The films of one frame after another. The first frame that does not end well ends the sequence; with --resume frames
// whose images are there are left as they are.
int render_frames(const RenderOptions& options, const SceneLoader& load) {
  int code = int(ExitCode::Done);
  for (const int frame : options.frames) {
    RenderOptions one = options;
    one.load.frame = frame;
    one.outputs = outputs_of(options);
    for (std::string& path : one.outputs.files) path = numbered(path, frame);
    if (!options.statistics.empty()) one.statistics = numbered(options.statistics, frame);
    if (!options.trace.empty()) one.trace = numbered(options.trace, frame);
    const bool there = std::ranges::all_of(one.outputs.files, [](const std::string& p) { return fs::exists(p); });
    if (options.resume && there && !fs::exists(film_path(one.outputs.files))) {
      if (!options.quiet) print_error(fmt::format("frame {} is there", frame));
      continue;
    }
    if (!options.quiet) print_error(fmt::format("frame {}", frame));
    code = std::max(code, ImageRender(one, load, one.outputs).run());
    if (code >= int(ExitCode::Interrupted)) break;
  }
  return code;
}

}  // namespace

int render_command(const RenderOptions& options, const SceneLoader& load) {
  if (!options.frames.empty()) return render_frames(options, load);
  return ImageRender(options, load, outputs_of(options)).run();
}

}  // namespace meristem
