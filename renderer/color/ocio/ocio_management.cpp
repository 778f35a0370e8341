#include "renderer/color/color_management.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <strings.h>

namespace meristem {

namespace ocio = OCIO_NAMESPACE;

namespace {

constexpr const char* working_space = "Linear Rec.709 (sRGB)";
// As configurations call it: of ACES 1.3, of ACES 1.2, aliases of both, of Blender, of Nuke and older Blender.
constexpr const char* working_names[] = {working_space, "Utility - Linear - sRGB", "lin_rec709",
                                         "lin_srgb",    "Linear Rec.709",          "Linear"};

struct Display {
  const char* name;
  const char* from_xyz;  // OpenColorIO's transform to its code values
};
// The first is the default.
constexpr Display displays[] = {{"sRGB", "DISPLAY - CIE-XYZ-D65_to_sRGB"},
                                {"Rec.1886", "DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709"},
                                {"P3-D65", "DISPLAY - CIE-XYZ-D65_to_G2.6-P3-D65"}};

ocio::BuiltinTransformRcPtr builtin(const char* style,
                                    ocio::TransformDirection direction = ocio::TRANSFORM_DIR_FORWARD) {
  ocio::BuiltinTransformRcPtr transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  transform->setDirection(direction);
  return transform;
}

ocio::ColorSpaceRcPtr scene_space(const char* name, const ocio::ConstTransformRcPtr& to_reference) {
  ocio::ColorSpaceRcPtr space = ocio::ColorSpace::Create(ocio::REFERENCE_SPACE_SCENE);
  space->setName(name);
  space->setBitDepth(ocio::BIT_DEPTH_F32);
  if (to_reference) space->setTransform(to_reference, ocio::COLORSPACE_DIR_TO_REFERENCE);
  return space;
}

// The scene reference is ACES2065-1: all of OpenColorIO's camera and output transforms start or end there.
void add_scene_spaces(ocio::Config& config) {
  ocio::GroupTransformRcPtr rec709 = ocio::GroupTransform::Create();
  rec709->appendTransform(builtin("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD", ocio::TRANSFORM_DIR_INVERSE));
  rec709->appendTransform(builtin("ACEScg_to_ACES2065-1"));
  config.addColorSpace(scene_space("ACES2065-1", nullptr));
  config.addColorSpace(scene_space("ACEScg", builtin("ACEScg_to_ACES2065-1")));
  config.addColorSpace(scene_space(working_space, rec709));
  const ocio::ColorSpaceRcPtr raw = scene_space("Raw", nullptr);
  raw->setIsData(true);
  config.addColorSpace(raw);
  config.setRole(ocio::ROLE_SCENE_LINEAR, working_space);
  config.setRole("aces_interchange", "ACES2065-1");
  config.setRole(ocio::ROLE_DEFAULT, "Raw");
}

void add_view(ocio::Config& config, const char* name, const char* aces_to_xyz) {
  ocio::ViewTransformRcPtr transform = ocio::ViewTransform::Create(ocio::REFERENCE_SPACE_SCENE);
  transform->setName(name);
  transform->setTransform(builtin(aces_to_xyz), ocio::VIEWTRANSFORM_DIR_FROM_REFERENCE);
  config.addViewTransform(transform);
  for (const Display& d : displays) config.addDisplayView(d.name, name, name, d.name, "", "", "");
}

// The display reference is CIE XYZ with the white D65; a display's space leads from there to code values.
void add_displays(ocio::Config& config) {
  for (const Display& d : displays) {
    ocio::ColorSpaceRcPtr space = ocio::ColorSpace::Create(ocio::REFERENCE_SPACE_DISPLAY);
    space->setName(d.name);
    space->setTransform(builtin(d.from_xyz), ocio::COLORSPACE_DIR_FROM_REFERENCE);
    config.addColorSpace(space);
  }
  add_view(config, "ACES SDR", "ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - SDR-VIDEO_1.0");
  add_view(config, "sRGB", "UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD");
  for (const Display& d : displays) config.addDisplayView(d.name, "Raw", "Raw", "");
}

ocio::ConstConfigRcPtr built_in_config() {
  ocio::ConfigRcPtr config = ocio::Config::Create();
  config->setVersion(2, 0);
  add_scene_spaces(*config);
  add_displays(*config);
  config->validate();
  return config;
}

bool environment_has_config() {
  const char* path = std::getenv("OCIO");
  return path && *path;
}

ocio::ConstConfigRcPtr current_config() {
  return environment_has_config() ? ocio::Config::CreateFromEnv() : built_in_config();
}

std::vector<std::string> displays_of(const ocio::Config& config) {
  std::vector<std::string> names{config.getDefaultDisplay()};
  for (int i = 0; i < config.getNumDisplays(); ++i)
    if (const std::string name = config.getDisplay(i); name != names[0]) names.push_back(name);
  return names;
}

std::vector<std::string> views_of(const ocio::Config& config, const char* display) {
  std::vector<std::string> names{config.getDefaultView(display)};
  for (int i = 0; i < config.getNumViews(display); ++i)
    if (const std::string name = config.getView(display, i); name != names[0]) names.push_back(name);
  return names;
}

// The one that is wanted, in any case; the first if none is.
std::string chosen(const std::string& what, const std::vector<std::string>& names, const std::string& wanted) {
  if (wanted.empty()) return names[0];
  for (const std::string& name : names)
    if (strcasecmp(name.c_str(), wanted.c_str()) == 0) return name;
  throw ColorError(fmt::format("no {} named \"{}\"; known: {}", what, wanted, fmt::join(names, ", ")));
}

// The working space in the words of `config`; null if it has none for it.
const char* known_working_space(const ocio::Config& config) {
  for (const char* name : working_names)
    if (config.getColorSpace(name)) return name;
  return nullptr;
}

// Our working space to the space `config` calls scene_linear. Null: it knows ours.
ocio::ConstCPUProcessorRcPtr to_scene_linear(const ocio::ConstConfigRcPtr& config) {
  if (known_working_space(*config)) return nullptr;
  if (!config->hasRole("aces_interchange") || !config->hasRole(ocio::ROLE_SCENE_LINEAR))
    throw ColorError(
        fmt::format("the configuration that OCIO names does not say what linear Rec.709 is: it has no colour space {}, "
                    "nor the roles aces_interchange and scene_linear",
                    fmt::join(working_names, ", ")));
  return ocio::Config::GetProcessorFromConfigs(built_in_config(), working_space, config, ocio::ROLE_SCENE_LINEAR)
      ->getDefaultCPUProcessor();
}

ocio::ConstCPUProcessorRcPtr to_display(const ocio::ConstConfigRcPtr& config, const std::string& display,
                                        const std::string& view, float exposure) {
  ocio::MatrixTransformRcPtr gain = ocio::MatrixTransform::Create();
  const double factor = std::exp2(double(exposure));
  const double matrix[16] = {factor, 0, 0, 0, 0, factor, 0, 0, 0, 0, factor, 0, 0, 0, 0, 1};
  gain->setMatrix(matrix);
  ocio::DisplayViewTransformRcPtr show = ocio::DisplayViewTransform::Create();
  const char* const known = known_working_space(*config);
  show->setSrc(known ? known : ocio::ROLE_SCENE_LINEAR);
  show->setDisplay(display.c_str());
  show->setView(view.c_str());
  ocio::GroupTransformRcPtr both = ocio::GroupTransform::Create();
  both->appendTransform(gain);
  both->appendTransform(show);
  // Without loss: the default optimisation may replace power functions by fast approximations.
  return config->getProcessor(both)->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);
}

template <class Work>
auto with_color_errors(const Work& work) {
  try {
    return work();
  } catch (const ocio::Exception& error) {
    throw ColorError(fmt::format("OpenColorIO: {}", error.what()));
  }
}

class OcioTransform final : public ColorTransform {
 public:
  OcioTransform(ocio::ConstCPUProcessorRcPtr scene_linear, ocio::ConstCPUProcessorRcPtr display, bool is_data)
      : scene_linear_(std::move(scene_linear)), display_(std::move(display)), is_data_(is_data) {}
  bool is_data() const override { return is_data_; }
  void apply(float* pixels, int width, int height, int channels) const override {
    ocio::PackedImageDesc image(pixels, width, height, channels);
    if (scene_linear_) scene_linear_->apply(image);
    display_->apply(image);
  }

 private:
  const ocio::ConstCPUProcessorRcPtr scene_linear_, display_;
  const bool is_data_;
};

class OcioManagement final : public ColorManagement {
 public:
  std::unique_ptr<const ColorTransform> display_transform(const std::string& view, float exposure,
                                                          const std::string& display) const override {
    return with_color_errors([&] {
      const ocio::ConstConfigRcPtr config = current_config();
      const std::string shown_on = chosen("display", displays_of(*config), display);
      const std::string name =
          chosen(fmt::format("view of the display {}", shown_on), views_of(*config, shown_on.c_str()), view);
      const ocio::ConstColorSpaceRcPtr space =
          config->getColorSpace(config->getDisplayViewColorSpaceName(shown_on.c_str(), name.c_str()));
      return std::make_unique<const OcioTransform>(
          to_scene_linear(config), to_display(config, shown_on, name, exposure), space && space->isData());
    });
  }
  std::vector<std::string> views() const override {
    return with_color_errors([] {
      const ocio::ConstConfigRcPtr config = current_config();
      return views_of(*config, config->getDefaultDisplay());
    });
  }
};

}  // namespace

}  // namespace meristem

const meristem::ColorManagement* meristem_color_management() {
  static const meristem::OcioManagement management;
  return &management;
}
