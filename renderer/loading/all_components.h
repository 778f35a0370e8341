// Every component of the program, by kind. Made at first use, then read-only: any thread.
#pragma once

#include "procedural/growth/base_shape.h"
#include "procedural/growth/template.h"
#include "renderer/language/catalogue.h"
#include "renderer/scene/interfaces.h"

namespace meristem {

struct Components {
  CameraRegistry cameras{"camera", true};
  LightRegistry lights{"light", true};
  MaterialRegistry materials{"material"};
  IntegratorRegistry integrators{"integrator"};
  SamplerRegistry samplers{"sampler"};
  FilterRegistry filters{"filter"};
  BaseRegistry bases{"base", true};
  TemplateRegistry templates;

  Components();
};

const Components& all_components();

// All of them with the steps and the sections of a scene file: for `describe`, the schema and the manual.
const Catalogue& catalogue();

}  // namespace meristem
