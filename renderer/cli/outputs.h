// The image files of a render or a merge: what the user asked for, checked beforehand, written as often as there is
// something new to see.
#pragma once

#include "renderer/color/color.h"
#include "renderer/film/film_file.h"

#include <optional>
#include <string>
#include <vector>

namespace meristem {

struct OutputOptions {
  std::vector<std::string> files;  // by extension: exr, png, jpg, tif, film
  std::string display, view;       // of display images; empty: the default
  float exposure = 0;              // stops, of display images
  bool half = true;                // the beauty in EXR files; else floats
  int bits = 8;                    // a channel in PNG and TIFF
  bool denoise = false;            // display images show the picture denoised; EXR files have it as a part
};

// Whether the name ends in .film, in either case.
bool is_film_file(const std::string& path);

// Throws FileError if the extension is none that can be written.
void check_extension(const std::string& path);

// The files that a command is going to write. Throws UsageError if two of them are one, or one is what it reads
// (`input`; none if it is empty or "-"). Empty names are none.
void check_targets(const std::string& input, const std::vector<std::string>& targets);

class Outputs {
 public:
  // Throws the FileError or ColorError that writing would meet as far as that is known beforehand.
  explicit Outputs(OutputOptions options);

  const std::vector<std::string>& files() const { return options_.files; }
  // Whether writing them takes the module of renderer/image.
  bool needs_image_module() const;
  // Writes every file, whole; says on standard error if values had to be clamped. Throws FileError, of all that could
  // not be written, when the others are.
  void write(const Film& film, const FilmInfo& info, const AdaptiveState& adaptive) const;

 private:
  class Failures;
  void write_display_images(const Film& film, const Image& denoised, const Metadata& metadata,
                            Failures& failures) const;
  void write_exr_files(const Film& film, const FilmInfo& info, const Image& denoised, const Metadata& metadata,
                       Failures& failures) const;

  OutputOptions options_;
  std::optional<DisplayTransform> transform_;  // if some file is a display image
};

}  // namespace meristem
