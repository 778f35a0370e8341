// From scene-linear light to what a display shows, by OpenColorIO (renderer/color/ocio).
//
// The configuration is made in code from OpenColorIO's built-in transforms, so no file has to be installed: the working
// space is scene-linear Rec.709 ("Linear Rec.709 (sRGB)"), with ACEScg and ACES2065-1 beside it. The displays are sRGB
// (the default), Rec.1886 and P3-D65, each with these views:
//   ACES SDR  the ACES 1.0 rendering for video: tone-mapped; the default
//   sRGB      not tone-mapped: the display's own encoding alone, light above 1 is cut off by the file
//   Raw       the values as they are
// If the environment variable OCIO names a configuration, its displays and views stand instead. It must
// have the role "aces_interchange", or know our working space by its name.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace meristem {

// Something is wrong with the configuration or the name of a view: the user's (exit code 2).
// The message says what would have been accepted.
class ColorError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class ColorTransform;

class DisplayTransform {
 public:
  // `view` and `display` by name, in any case; empty: the default. `exposure` in stops: each doubles the light before
  // the view. Throws ColorError.
  explicit DisplayTransform(const std::string& view, float exposure = 0, const std::string& display = "");
  ~DisplayTransform();
  DisplayTransform(DisplayTransform&&) noexcept;

  // Turns scene-linear Rec.709 into display values in place: `channels` (3 or 4) interleaved floats a pixel; alpha
  // stays. Any thread; about 10 million pixels a second.
  void apply(float* pixels, int width, int height, int channels) const;

  // Whether the view shows numbers as they are, such as Raw does, and not light.
  bool is_data() const;

  // The views of the default display of the configuration in use, the default first.
  static std::vector<std::string> views();

 private:
  std::unique_ptr<const ColorTransform> transform_;
};

}  // namespace meristem
