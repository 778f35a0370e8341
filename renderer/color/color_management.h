// ColorManagement: what needs OpenColorIO, behind a module that is opened at first use.
//
// OpenColorIO and its libraries take the dynamic linker some 5 ms, twice where the program starts itself anew
// (geometry/base/huge_pages.h), and a render into EXR files needs none of them. So renderer/color/ocio is not part of
// the program but of meristem_color.so (geometry/base/module.h).
#pragma once

#include "renderer/color/color.h"

namespace meristem {

// From scene-linear Rec.709 to display values, as DisplayTransform. Any thread.
class ColorTransform {
 public:
  virtual ~ColorTransform() = default;
  virtual bool is_data() const = 0;
  virtual void apply(float* pixels, int width, int height, int channels) const = 0;
};

// As DisplayTransform's constructor and views(); throws ColorErrors. Any thread.
class ColorManagement {
 public:
  virtual std::unique_ptr<const ColorTransform> display_transform(const std::string& view, float exposure,
                                                                  const std::string& display) const = 0;
  virtual std::vector<std::string> views() const = 0;

 protected:
  ~ColorManagement() = default;
};

}  // namespace meristem

// What the module exports. Never null; lives as long as the module.
extern "C" const meristem::ColorManagement* meristem_color_management();
