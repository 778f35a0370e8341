#include "procedural/subdivision/subdivide.h"

namespace meristem {

std::vector<std::unique_ptr<Step>> read_subdivide(Params& params, int first_level, Key step_key) {
  const int count =
      params.integer("subdivide", 1, {0, 15, ""}, "levels of refinement; each makes four faces of a quad");
  const int scheme =
      params.choice("scheme", 0, {"catmull_clark", "loop"}, "refinement and smoothing; loop needs triangles");
  const int boundary = params.choice("boundary", 0, {"edge_and_corner", "edge"},
                                     "at open borders: keep the corners of single faces, or round them");
  std::shared_ptr<const Expression> place;
  const char* place_doc = "displacement of every new vertex, a vector in metres; without it: plain smoothing";
  if (params.has("place") || params.describing())
    place = params.vector_expression("place", "0", placement_symbols(), place_doc);
  else
    params.raw("place", false, "", place_doc);

  std::vector<std::unique_ptr<Step>> steps;
  for (int i = 0; i < count; ++i)
    steps.push_back(std::make_unique<SubdivideStep>(
        SubdivideStep::Settings{{scheme == 0 ? Scheme::CatmullClark : Scheme::Loop,
                                 boundary == 0 ? BoundaryRule::EdgeAndCorner : BoundaryRule::EdgeOnly},
                                place,
                                first_level + i,
                                hash_keys(step_key, Key(i)),
                                Quantum()}));
  return steps;
}

}  // namespace meristem
