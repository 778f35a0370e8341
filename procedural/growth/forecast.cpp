#include "procedural/growth/forecast.h"

#include "procedural/growth/grow_step.h"

#include <set>

namespace meristem {

namespace {

// Catmull-Clark makes as many quadrilaterals of a polygon as it has corners; Loop makes four triangles of a triangle.
std::uint32_t refined_corners(const Step& step) { return step.max_children(3) == 3 ? 4 : 3; }

FaceCensus census_of(const Mesh& mesh) {
  FaceCensus census;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    ++census[{mesh.origins[mesh.face_origins[f]].symbol, mesh.corner_count(f)}];
  return census;
}

FaceCensus after_refinement(const Step& step, const FaceCensus& before) {
  FaceCensus after;
  for (const auto& [kind, count] : before)
    after[{kind.first, refined_corners(step)}] += count * step.max_children(kind.second);
  return after;
}

// The kinds of faces there may be after a grow step, not their numbers. Whatever may stay, stays.
FaceCensus kinds_after_growth(const GrowStep& step, const FaceCensus& before, std::set<const Production*>& reported,
                              Diagnostics& diagnostics) {
  FaceCensus after = before;
  for (const auto& [kind, count] : before)
    for (const Production& p : step.rules().of(kind.first)) {
      const std::string refusal = p.part().shape->refusal(kind.second);
      if (!refusal.empty()) {
        if (reported.insert(&p).second) diagnostics.error(p.location(), refusal);
        continue;
      }
      const NamedFaces grown = sample_growth(p.part(), kind.second);
      for (std::uint32_t f = 0; f < grown.face_count(); ++f)
        after[{p.successor(grown.names[f]).symbol(), std::uint32_t(grown.face(f).size())}] = 1;
    }
  return after;
}

}  // namespace

double estimated_faces(const Mesh& base, const Extent& extent, std::span<const std::unique_ptr<Step>> steps) {
  FaceCensus faces = census_of(base);
  Extent region = extent;
  for (const auto& step : steps) {
    if (const auto* grow = dynamic_cast<const GrowStep*>(step.get()))
      faces = grow->forecast(faces, region);
    else if (step->refines())
      faces = after_refinement(*step, faces);
    region = step->bound(region);
  }
  double total = 0;
  for (const auto& [kind, count] : faces) total += count;
  return total;
}

void check_corner_counts(const Mesh& base, std::span<const std::unique_ptr<Step>> steps, Diagnostics& diagnostics) {
  FaceCensus faces = census_of(base);
  std::set<const Production*> reported;
  for (const auto& step : steps) {
    if (const auto* grow = dynamic_cast<const GrowStep*>(step.get()))
      faces = kinds_after_growth(*grow, faces, reported, diagnostics);
    else if (step->refines())
      faces = after_refinement(*step, faces);
  }
}

}  // namespace meristem
