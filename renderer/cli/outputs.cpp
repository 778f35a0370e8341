#include "renderer/cli/outputs.h"

#include "renderer/cli/console.h"
#include "renderer/cli/exit_code.h"
#include "renderer/denoise/denoise.h"
#include "renderer/film/film_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace meristem {

namespace {

bool is_exr(const std::string& path) { return !is_film_file(path) && image_format(path) == ImageFormat::Exr; }
bool is_display_image(const std::string& path) { return !is_film_file(path) && image_format(path) != ImageFormat::Exr; }

void report_clamped(const std::string& path, std::size_t values) {
  if (values > 0)
    print_error(fmt::format("warning: {}: {} values clamped to the range of a half; --float keeps them", path, values));
}

ExrPart denoised_part(const Image& image, bool half) {
  return {"denoised", {"denoised.R", "denoised.G", "denoised.B", "denoised.A"}, image, half, true};
}

}  // namespace

bool is_film_file(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return extension == ".film";
}

void check_extension(const std::string& path) {
  if (is_film_file(path)) return;
  try {
    image_format(path);
  } catch (const FileError& error) {
    throw FileError(fmt::format("{}, or .film", error.what()));
  }
}

void check_targets(const std::string& input, const std::vector<std::string>& targets) {
  const auto place = [](const std::string& path) {
    std::error_code error;
    const std::filesystem::path followed = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
    return error ? path : followed.string();
  };
  std::vector<std::string> taken;
  if (!input.empty() && input != "-") taken.push_back(place(input));
  const std::size_t inputs = taken.size();
  for (const std::string& path : targets) {
    if (path.empty()) continue;
    const auto same = std::ranges::find(taken, place(path));
    if (same != taken.end())
      throw UsageError(std::size_t(same - taken.begin()) < inputs
                           ? fmt::format("{} would be written over: it is what the command reads", path)
                           : fmt::format("{} is named for two outputs", path));
    taken.push_back(place(path));
  }
}

// What could not be written while the rest was.
class Outputs::Failures {
 public:
  template <class Writing>
  void attempt(const Writing& writing) {
    try {
      writing();
    } catch (const FileError& error) {
      text_ += fmt::format("{}{}", text_.empty() ? "" : "\nerror: ", error.what());
    }
  }
  void throw_if_any() const {
    if (!text_.empty()) throw FileError(text_);
  }

 private:
  std::string text_;
};

Outputs::Outputs(OutputOptions options) : options_(std::move(options)) {
  if (needs_image_module()) check_image_module();
  for (const std::string& path : options_.files) check_writable(path);
  if (std::ranges::any_of(options_.files, is_display_image) || !options_.view.empty() || !options_.display.empty())
    transform_.emplace(options_.view, options_.exposure, options_.display);
}

bool Outputs::needs_image_module() const {
  return std::ranges::any_of(
      options_.files, [](const std::string& path) { return !is_film_file(path) && needs_module(image_format(path)); });
}

void Outputs::write(const Film& film, const FilmInfo& info, const AdaptiveState& adaptive) const {
  if (options_.denoise && !denoise::can_denoise(film))
    throw UsageError("--denoise: the film was rendered without --denoise and lacks what this needs");
  const bool denoise = options_.denoise && !std::ranges::all_of(options_.files, is_film_file);
  const Image denoised = denoise ? denoise::denoised(film) : Image{};
  Metadata metadata = info.metadata;
  if (denoise) metadata.emplace_back("meristem:denoised", "display images and the part \"denoised\" of EXR files");
  Failures failures;
  for (const std::string& path : options_.files)
    if (is_film_file(path)) failures.attempt([&] { write_film_file(path, film, info, adaptive); });
  write_display_images(film, denoised, metadata, failures);
  write_exr_files(film, info, denoised, metadata, failures);
  failures.throw_if_any();
}

// `denoised` may be empty.
void Outputs::write_display_images(const Film& film, const Image& denoised, const Metadata& metadata,
                                   Failures& failures) const {
  const WriteOptions how{.bits = options_.bits,
                         .dither = transform_ && !transform_->is_data(),
                         .x0 = film.window().x0,
                         .y0 = film.window().y0};
  Image shown;
  for (const std::string& path : options_.files) {
    if (!is_display_image(path)) continue;
    if (shown.pixels.empty()) {
      shown = denoised.pixels.empty() ? film.develop() : denoised;
      transform_->apply(shown.pixels.data(), shown.width, shown.height, shown.channels);
    }
    failures.attempt([&] { write_image(path, shown, metadata, how); });
  }
}

void Outputs::write_exr_files(const Film& film, const FilmInfo& info, const Image& denoised, const Metadata& metadata,
                              Failures& failures) const {
  const PixelWindow& window = film.window();
  const ExrFrame frame{window.x0, window.y0, info.frame_width, info.frame_height};
  std::vector<ExrPart> parts;
  for (const std::string& path : options_.files) {
    if (!is_exr(path)) continue;
    if (parts.empty()) {
      parts = film_parts(film, info.names, options_.half);
      if (!denoised.pixels.empty()) parts.insert(parts.begin() + 1, denoised_part(denoised, options_.half));
    }
    failures.attempt([&] { report_clamped(path, write_exr_parts(path, parts, frame, metadata)); });
  }
}

}  // namespace meristem
