#include "procedural/subdivision/subdivide.h"

#include "procedural/subdivision/drop_border_step.h"

namespace meristem {

std::vector<std::unique_ptr<Step>> read_subdivide(Params& params, int first_level, Key step_key) {
  const int count =
      params.integer("subdivide", 1, {0, 15, ""}, "levels of refinement; each makes four faces of a quad");
  const int scheme =
      params.choice("scheme", 0, {"catmull_clark", "loop"}, "refinement and smoothing; loop needs triangles");
  const int boundary = params.choice(
      "boundary", 0, {"edge_and_corner", "edge", "none"},
      "at open borders: keep the corners of single faces; round them; or show no face that touches the border");
  const int creasing =
      params.choice("creasing", 0, {"uniform", "chaikin"},
                    "sharpness of creases falls by 1 a level; chaikin: and nears that of the creases they meet");
  std::shared_ptr<const Expression> place;
  const char* place_doc = "displacement of every new vertex, a vector in metres; without it: plain smoothing";
  if (params.has("place") || params.describing())
    place = params.vector_expression("place", "0", placement_symbols(), place_doc);
  else
    params.raw("place", false, "", place_doc);

  std::vector<std::unique_ptr<Step>> steps;
  const bool drops_border = boundary == 2;
  if (drops_border && count > 0) steps.push_back(std::make_unique<DropBorderStep>());
  for (int i = 0; i < count; ++i)
    steps.push_back(std::make_unique<SubdivideStep>(
        SubdivideStep::Settings{{scheme == 0 ? Scheme::CatmullClark : Scheme::Loop,
                                 boundary == 0 ? BoundaryRule::EdgeAndCorner : BoundaryRule::EdgeOnly,
                                 creasing == 0 ? Creasing::Uniform : Creasing::Chaikin},
                                place,
                                first_level + i,
                                hash_keys(step_key, Key(i)),
                                Quantum()}));
  return steps;
}

}  // namespace meristem
