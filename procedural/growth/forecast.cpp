#include "procedural/growth/forecast.h"

#include "geometry/cells/region_extent.h"
#include "geometry/mesh/adjacency.h"
#include "procedural/growth/grow_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
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

// The kinds of faces there may be after grow steps, not their numbers. Whatever may stay, stays.
class KindsOfFaces {
 public:
  KindsOfFaces(FaceCensus faces, Diagnostics& diagnostics) : faces_(std::move(faces)), diagnostics_(diagnostics) {}

  const FaceCensus& faces() const { return faces_; }
  void refine(const Step& step) { faces_ = after_refinement(step, faces_); }
  void grow(const GrowStep& step) {
    FaceCensus after = faces_;
    for (const auto& [kind, count] : faces_)
      for (const Production& p : step.rules().of(kind.first))
        for (const auto& grown : kinds_on(p, kind.second)) after[grown] = 1;
    faces_ = std::move(after);
  }

 private:
  // What a production makes of a face with so many corners; nothing, and an error, if it cannot stand there.
  const std::vector<FaceCensus::key_type>& kinds_on(const Production& p, std::uint32_t corners) {
    const auto [known, is_new] = known_.try_emplace({&p, corners});
    if (!is_new) return known->second;
    if (const std::string refusal = p.part().shape->refusal(corners); !refusal.empty()) {
      if (reported_.insert(&p).second) diagnostics_.error(p.location(), refusal);
      return known->second;
    }
    const NamedFaces grown = sample_growth(p.part(), corners);
    for (std::uint32_t f = 0; f < grown.face_count(); ++f)
      known->second.push_back({p.successor(grown.names[f]).symbol(), std::uint32_t(grown.face(f).size())});
    return known->second;
  }

  FaceCensus faces_;
  Diagnostics& diagnostics_;
  std::map<std::pair<const Production*, std::uint32_t>, std::vector<FaceCensus::key_type>> known_;
  std::set<const Production*> reported_;
};

// Takes a forecast through steps, one by one.
class Forecast {
 public:
  Forecast(const Mesh& base, Extent extent) : faces_(census_of(base)), region_(std::move(extent)) {}

  void take(const Step& step) {
    if (const auto* grow = dynamic_cast<const GrowStep*>(&step))
      faces_ = grow->forecast(faces_, region_);
    else if (step.refines())
      faces_ = after_refinement(step, faces_);
    region_ = step.bound(region_);
  }
  double total() const {
    double total = 0;
    for (const auto& [kind, count] : faces_) total += count;
    return total;
  }

 private:
  FaceCensus faces_;
  Extent region_;
};

}  // namespace

double estimated_faces(const Mesh& base, const Extent& extent, std::span<const std::unique_ptr<Step>> steps) {
  Forecast forecast(base, extent);
  for (const auto& step : steps) forecast.take(*step);
  return forecast.total();
}

double expected_faces(const Model& model) {
  const Mesh& base = model.base().mesh;
  if (model.levels() > 0 && model.step(0).thins()) {  // it knows what comes of a bud
    double faces = 0;
    for (const std::uint32_t origin : base.face_origins)
      faces += model.step(0).thinned_faces(base.origins[origin], 0, model.estimated_faces(4, -1, 1));
    return faces;
  }
  std::vector<std::uint32_t> all(base.face_count());
  std::iota(all.begin(), all.end(), 0u);
  Forecast forecast(base, region_extent(model, base, Adjacency(base), all, 0));
  for (int level = 0; level < model.levels(); ++level) forecast.take(model.step(level));
  return forecast.total();
}

void check_corner_counts(const Mesh& base, std::span<const std::unique_ptr<Step>> steps,
                         std::span<const Location> places, Diagnostics& diagnostics) {
  KindsOfFaces kinds(census_of(base), diagnostics);
  bool is_exact = true;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Step& step = *steps[i];
    const auto* grow = dynamic_cast<const GrowStep*>(&step);
    const auto refinement = step.refinement();
    if (is_exact && refinement && refinement->scheme == Scheme::Loop) {
      const auto other = std::ranges::find_if(kinds.faces(), [](const auto& f) { return f.first.second != 3; });
      if (other != kinds.faces().end()) {
        diagnostics.error(places[i], fmt::format("the scheme loop needs triangles, and faces here have {} corners; "
                                                 "leave \"scheme\" out for that of Catmull and Clark, which takes all",
                                                 other->first.second));
        return;
      }
    }
    is_exact = is_exact && refinement;
    if (grow)
      kinds.grow(*grow);
    else if (step.refines())
      kinds.refine(step);
  }
}

}  // namespace meristem
