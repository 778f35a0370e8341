#include "renderer/loading/all_components.h"

#include "procedural/components.h"
#include "procedural/growth/grow_step.h"
#include "procedural/subdivision/subdivide.h"
#include "renderer/components.h"
#include "renderer/loading/load_model.h"
#include "renderer/loading/load_part.h"
#include "renderer/loading/load_settings.h"
#include "renderer/loading/scene_grids.h"
#include "renderer/media/expression_medium.h"

namespace meristem {

namespace {

template <class Read>
ComponentInfo info_of(const char* kind, const char* name, const char* doc, Read read) {
  return {kind, name, doc, [read] {
            std::vector<ParamInfo> infos;
            Params params(infos);
            read(params);
            return infos;
          }};
}

Catalogue make_catalogue() {
  const Components& all = all_components();
  Catalogue result;
  auto add = [&](const std::vector<ComponentInfo>& infos) {
    result.components.insert(result.components.end(), infos.begin(), infos.end());
  };
  add({info_of("model", "base", "a base mesh and the steps that refine it and let it grow", read_model),
       info_of("model", "scatter", "models strewn over the ground that another model makes", read_scatter),
       info_of("model", "group", "models placed one by one, as one model", read_group),
       info_of("grid", "file", "a field of samples from a file", read_file_grid),
       info_of("grid", "model", "a field of samples: the distance from a model", read_model_grid),
       info_of("grid", "value", "a field of samples of an expression", read_value_grid),
       info_of("section", "object", "a model placed in the world", [](Params& p) { read_object(p); }),
       info_of("section", "medium", "matter between surfaces: mist, smoke, haze",
               [](Params& p) { ExpressionMedium medium(p); }),
       info_of("section", "render", "size, quality and memory of the image", read_render)});
  add(all.bases.infos());
  add({info_of("step", "subdivide",
               "generalized subdivision: refinement by a scheme, then vertex placement by an expression",
               [](Params& p) { read_subdivide(p, 1, 0); }),
       grow_step_info(), Production::info()});
  add(all.templates.infos());
  add(all.materials.infos());
  add(all.lights.infos());
  add(all.cameras.infos());
  add(all.integrators.infos());
  add(all.samplers.infos());
  add(all.filters.infos());
  result.default_types = {{"camera", default_camera},
                          {"material", default_material},
                          {"integrator", default_integrator},
                          {"sampler", default_sampler},
                          {"filter", default_filter}};
  return result;
}

}  // namespace

Components::Components() {
  register_cameras(cameras);
  register_lights(lights);
  register_materials(materials);
  register_integrators(integrators);
  register_samplers(samplers);
  register_filters(filters);
  register_bases(bases);
  register_plants(bases);
  register_templates(templates);
}

const Components& all_components() {
  static const Components components;
  return components;
}

const Catalogue& catalogue() {
  static const Catalogue result = make_catalogue();
  return result;
}

}  // namespace meristem
