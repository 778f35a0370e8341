#include "geometry/cells/model.h"

#include "geometry/cells/position_lattice.h"
#include "geometry/cells/region_extent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

namespace meristem {

namespace {

constexpr int final_halo_rings = 1;  // what vertex normals of the final mesh need

// Rings needed before every step. u, v left at corners by growth are averaged by the first refinement, which takes one
// ring more.
std::vector<int> find_halo_rings(const std::vector<std::unique_ptr<Step>>& steps) {
  std::vector<int> rings(steps.size() + 1, final_halo_rings);
  std::size_t first_refinement = steps.size();
  for (std::size_t i = steps.size(); i-- > 0;)
    if (steps[i]->refines()) first_refinement = i;
  for (std::size_t i = steps.size(); i-- > 0;)
    rings[i] = steps[i]->halo_rings(rings[i + 1]) + (i == first_refinement ? 1 : 0);
  return rings;
}

double reach_of(const Bounds3d& b) { return std::max(max_component(abs(b.lower)), max_component(abs(b.upper))); }

}  // namespace

Model::Model(std::string name, Mesh base, std::vector<std::unique_ptr<Step>> steps, CellSettings settings)
    : name_(std::move(name)), steps_(std::move(steps)), settings_(settings), halo_rings_(find_halo_rings(steps_)) {
  for (int level = 0; level <= levels(); ++level) faces_of_quad_.push_back(count_faces(4, false, level));
  std::vector<std::uint32_t> faces(base.face_count());
  std::iota(faces.begin(), faces.end(), 0u);
  base_extent_ = region_extent(*this, base, Adjacency(base), faces, 0);
  Extent seen_anyhow = base_extent_;
  seen_anyhow.footprint = INFINITY;
  const Bounds3d bounds = final_bounds(*this, seen_anyhow, 0);
  const double reach = reach_of(bounds);
  constexpr double furthest = 1e15;  // squares of what is traced have to be finite floats
  if (bounds.empty() || !(reach <= furthest))
    throw std::runtime_error(
        "the model has no finite bounds: wrap what may become very large, such as a quotient, in clamp(..., lo, hi)");
  constexpr double least = 1e-6;
  quantum_ = Quantum::for_reach(std::max(reach, least));
  coarsest_lattice_ =
      Quantum::for_reach(std::max(reach_of(final_bounds(*this, base_extent_, 0)), least)).step() * 0x1p22;
  for (const auto& s : steps_) {
    s->set_quantum(quantum_);
    s->set_shown_quantum(Quantum(coarsest_lattice_));
  }
  for (Vec3d& p : base.positions) p = quantum_.round(p);
  base_.owned_faces = base.face_count();
  base_.rings.assign(base.face_count(), 0);
  base_.mesh = std::move(base);
  find_remaining_offsets();
}

const Bounds3f& Model::bounds() const {
  std::call_once(has_bounds_, [this] {
    const Mesh& mesh = base_.mesh;
    std::vector<std::uint32_t> faces(mesh.face_count());
    std::iota(faces.begin(), faces.end(), 0u);
    Extent e = region_extent(*this, mesh, Adjacency(mesh), faces, 0);
    e.footprint = INFINITY;
    bounds_ = round_outwards(final_bounds(*this, e, 0).inflated(Vec3d(PositionLattice::margin(*this))));
  });
  return bounds_;
}

// A refinement leaves half the scale; where displacement stretches the faces, up to sqrt(2) of that.
void Model::find_remaining_offsets() {
  constexpr int exponent_count = 40;
  smallest_exponent_ = int(std::ceil(std::log2(base_extent_.box.diagonal() + 1e-9))) + 1 - exponent_count;
  std::vector<Extent> extents{base_extent_};
  for (int i = 0; i < levels(); ++i) extents.push_back(step(i).bound(extents.back()));
  remaining_offsets_.assign(std::size_t(levels()) + 1, std::vector<double>(exponent_count, 0.0));
  for (int level = 0; level < levels(); ++level)
    for (int e = 0; e < exponent_count; ++e) {
      double scale = std::exp2(smallest_exponent_ + e);
      for (int i = level; i < levels(); ++i) {
        if (step(i).refines()) scale *= 0.5;
        remaining_offsets_[std::size_t(level)][std::size_t(e)] +=
            step(i).offset_bound(extents[std::size_t(i)], scale * std::numbers::sqrt2);
      }
    }
}

double Model::remaining_offset(int level, double scale) const {
  const std::vector<double>& row = remaining_offsets_[std::size_t(level)];
  const int exponent = std::ilogb(scale) + 1 - smallest_exponent_;
  return row[std::size_t(std::clamp(exponent, 0, int(row.size()) - 1))];
}

bool Model::drops_faces_later(int level) const {
  while (level < levels() && !step(level).drops_faces()) ++level;
  return level < levels();
}

bool Model::enlarges_later(int level) const {
  while (level < levels() && !step(level).enlarges()) ++level;
  return level < levels();
}

bool Model::is_two_refinements_in(int level) const {
  return level >= 2 && step(level - 1).refines() && step(level - 2).refines() &&
         (level == 2 || !step(level - 3).refines());
}

std::optional<Smoothing> Model::smoothing(int level) const {
  const bool is_refined = level > 0 && step(level - 1).refines();
  std::optional<RefineOptions> scheme;
  if (level == levels() && is_refined && !step(level - 1).displaces()) scheme = step(level - 1).refinement();
  for (int i = level; i < levels(); ++i) {
    if (!step(i).refines()) continue;
    if (step(i).displaces() || (scheme && step(i).refinement() != scheme)) return {};
    scheme = step(i).refinement();
  }
  if (!scheme) return {};
  return Smoothing{*scheme, is_refined && step(level - 1).refinement()->scheme == scheme->scheme, quantum_};
}

std::optional<Scheme> Model::next_scheme(int level) const {
  for (int i = level; i < levels(); ++i)
    if (const auto refinement = step(i).refinement()) return refinement->scheme;
  return {};
}

bool Model::makes_quads_of_triangles_later(int level) const {
  if (next_scheme(level) != Scheme::Loop) return false;
  for (int i = level; i < levels(); ++i)
    if (const auto refinement = step(i).refinement(); refinement && refinement->scheme == Scheme::CatmullClark)
      return true;
  return false;
}

double Model::growth_reach(const FaceOrigin& origin, const Bounds3d& face, double radius, int level,
                           double enough) const {
  Extent e = base_extent_;
  e.box = face;
  e.edge = 2 * radius;
  e.forget_shape();
  SymbolRange range{origin.symbol, {}, std::nextafterf(float(radius), INFINITY)};
  for (std::size_t i = 0; i < range.parameters.size(); ++i)
    range.parameters[i] = {origin.parameters[i], origin.parameters[i]};
  e.symbols = {range};
  const auto reach = [&](const Bounds3d& after) {
    return std::max(max_component(face.lower - after.lower), max_component(after.upper - face.upper));
  };
  for (; level < levels() && reach(e.box) <= enough; ++level) e = step(level).bound(e);
  return reach(final_bounds(*this, e, levels()));
}

int Model::trailing_refinements(int level) const {
  int count = 0;
  for (int i = levels(); i-- > level && step(i).refines();) ++count;
  return count;
}

int Model::growing_step(std::int32_t symbol, int level) const {
  if (symbol < 0) return levels();
  while (level < levels() && !step(level).grows(symbol)) ++level;
  return level;
}

double Model::estimated_faces(std::uint32_t corners, std::int32_t symbol, int level) const {
  const bool may_grow = grows_later(symbol, level);
  return corners == 4 && !may_grow ? faces_of_quad_[std::size_t(level)] : count_faces(corners, may_grow, level);
}

double Model::count_faces(std::uint32_t corners, bool may_grow, int level) const {
  double faces = 1;
  std::uint32_t n = corners;
  for (int i = level; i < levels() && faces < 1e18; ++i) {
    if (!step(i).refines() && !may_grow) continue;
    faces *= step(i).max_children(n);
    if (step(i).refines()) n = 4;
  }
  return faces;
}

double Model::estimated_faces() const {
  const Mesh& mesh = base_.mesh;
  double faces = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    faces += estimated_faces(mesh.corner_count(f), mesh.origins[mesh.face_origins[f]].symbol, 0);
  return faces;
}

Bounds3d final_bounds(const Model& model, Extent extent, int level) {
  for (int i = level; i < model.levels(); ++i) extent = model.step(i).bound(extent);
  extent.box = extent.smooth_box();
  // Roundings to the grid, one a level, and that of the float vertices.
  const double size = std::max(max_component(abs(extent.box.lower)), max_component(abs(extent.box.upper)));
  return extent.box.inflated(Vec3d(model.quantum().step() * (model.levels() + 1) + size * 0x1p-23));
}

}  // namespace meristem
