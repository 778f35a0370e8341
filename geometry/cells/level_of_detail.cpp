#include "geometry/cells/level_of_detail.h"

#include "geometry/cells/tessellation.h"
#include "geometry/mesh/refine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meristem {

namespace {

const FaceOrigin& origin_of(const Mesh& mesh, std::uint32_t f) { return mesh.origins[mesh.face_origins[f]]; }

double mean_diagonal(const Mesh& mesh, std::uint32_t f) {
  const auto c = mesh.corners(f);
  const auto p = [&](std::size_t i) { return mesh.positions[c[i]]; };
  if (c.size() == 4) return 0.5 * (length(p(2) - p(0)) + length(p(3) - p(1)));
  double sum = 0;
  for (std::size_t i = 0; i < c.size(); ++i) sum += length(p((i + 1) % c.size()) - p(i));
  return sum / double(c.size()) * (c.size() > 4 ? 2 : 1);  // a large polygon is about as wide as two of its edges
}

// Whether something grows on the face at `level` or later that could be seen.
bool has_visible_growth(const Model& model, const CellMesh& cell, std::uint32_t f, int level) {
  const Mesh& mesh = cell.mesh;
  const FaceOrigin& origin = origin_of(mesh, f);
  if (!model.grows_later(origin.symbol, level)) return false;
  if (model.thins_later(origin.symbol, level)) return true;
  Bounds3d box;
  Vec3d center;
  for (std::uint32_t v : mesh.corners(f)) {
    box.extend(mesh.positions[v]);
    center += mesh.positions[v] * (1.0 / mesh.corner_count(f));
  }
  double radius = 0;
  for (std::uint32_t v : mesh.corners(f)) radius = std::max(radius, length(mesh.positions[v] - center));
  const double footprint = cell.footprint->at(center);
  return radius > footprint || model.growth_reach(origin, box, radius, level) > footprint;
}

// The footprint is the wanted length of edges; the scale is a diagonal.
bool is_fine_enough(const Model& model, double scale, double footprint, int level) {
  return scale <= std::numbers::sqrt2 * footprint && model.remaining_offset(level, scale) <= footprint;
}

int refinements_until_fine(const Model& model, double scale, double footprint, int level) {
  int count = 0;
  for (; level < model.levels() && !is_fine_enough(model, scale, footprint, level); ++level) {
    if (!model.step(level).refines()) continue;
    scale *= 0.5;
    ++count;
  }
  return count;
}

bool is_frozen(const Mesh& mesh, std::uint32_t v) { return !mesh.frozen.empty() && mesh.frozen[v].is_frozen; }

// Calls visit(v) once for every vertex of the owned faces.
template <class Visit>
void for_each_owned_vertex(const CellMesh& cell, Visit visit) {
  std::vector<bool> seen(cell.mesh.vertex_count(), false);
  for (std::uint32_t c = 0; c < cell.mesh.face_starts[cell.owned_faces]; ++c) {
    const std::uint32_t v = cell.mesh.corner_vertices[c];
    if (!seen[v]) visit(v);
    seen[v] = true;
  }
}

// One pass of freezing over a cell.
class Freezing {
 public:
  Freezing(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted)
      : model_(model),
        cell_(cell),
        mesh_(cell.mesh),
        level_(level),
        wanted_(wanted),
        is_candidate_(cell.mesh.vertex_count(), false) {}

  // Returns whether every owned vertex is frozen or a candidate.
  bool find_candidates() {
    std::size_t active = 0;
    for_each_owned_vertex(cell_, [&](std::uint32_t v) {
      if (wanted_) (*wanted_)[v] = 0;
      if (is_frozen(mesh_, v)) return;
      const double scale = mesh_.nominal_scale[v], footprint = cell_.footprint->at(mesh_.positions[v]);
      is_candidate_[v] = is_fine_enough(model_, scale, footprint, level_);
      if (wanted_ && !is_candidate_[v])
        (*wanted_)[v] = std::uint8_t(refinements_until_fine(model_, scale, footprint, level_));
      candidates_ += is_candidate_[v];
      active += !is_candidate_[v];
    });
    if (candidates_ > 0) active += withdraw_growing();
    return active == 0;
  }

  // Growth moves no vertex: until the next refinement there is no haste.
  void freeze() {
    if (candidates_ == 0 || level_ == model_.levels() || !model_.step(level_).refines()) return;
    mesh_.frozen.resize(mesh_.vertex_count());
    const LimitSurface surface = shown_surface(cell_, model_.smoothing(level_));
    const std::vector<Vec2d> uv = vertex_uv(mesh_);
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
      if (is_candidate_[v])
        mesh_.frozen[v] = {true, false, Vec3f(surface.positions[v]), Vec3f(surface.normals[v]),
                           Vec2f{float(uv[v].x), float(uv[v].y)}};
  }

 private:
  // Corners of faces on which something visible will grow stay active; returns how many.
  std::size_t withdraw_growing() {
    std::size_t withdrawn = 0;
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.corners(f);
      if (std::none_of(corners.begin(), corners.end(), [&](auto v) { return is_candidate_[v]; })) continue;
      if (!has_visible_growth(model_, cell_, f, level_)) continue;
      for (std::uint32_t v : corners) {
        withdrawn += is_candidate_[v];
        is_candidate_[v] = false;
      }
    }
    candidates_ -= withdrawn;
    return withdrawn;
  }

  const Model& model_;
  CellMesh& cell_;
  Mesh& mesh_;
  const int level_;
  std::vector<std::uint8_t>* const wanted_;
  std::vector<bool> is_candidate_;
  std::size_t candidates_ = 0;
};

// Of a face that still grows, where its step thins by itself; infinity elsewhere.
double thinned_faces(const Model& model, const CellMesh& cell, std::uint32_t face, int level) {
  const FaceOrigin& origin = origin_of(cell.mesh, face);
  while (!model.step(level).grows(origin.symbol)) ++level;
  if (!model.step(level).thins()) return INFINITY;
  const double footprint = cell.footprint->at(cell.mesh.positions[cell.mesh.corners(face)[0]]);
  return model.step(level).thinned_faces(origin, footprint, model.estimated_faces(4, -1, level + 1));
}

}  // namespace

bool freeze_vertices(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted) {
  if (wanted) wanted->assign(cell.mesh.vertex_count(), std::uint8_t(model.trailing_refinements(level)));
  if (!cell.footprint) return false;
  measure_nominal_scale(model, cell, level);
  if (model.drops_faces_later(level)) return false;  // which of the faces will be shown is not known yet
  Freezing freezing(model, cell, level, wanted);
  if (freezing.find_candidates()) return true;
  freezing.freeze();
  return false;
}

void leave_out_small_growth(const Model& model, CellMesh& cell, int level) {
  if (!cell.footprint) return;
  Mesh& mesh = cell.mesh;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const FaceOrigin& origin = origin_of(mesh, f);
    if (!model.step(level).grows(origin.symbol) || has_visible_growth(model, cell, f, level)) continue;
    FaceOrigin terminal = origin;
    terminal.symbol = omitted_symbol(origin.symbol);
    mesh.face_origins[f] = std::uint32_t(mesh.origins.size());
    mesh.origins.push_back(terminal);
  }
}

double wanted_faces(const Model& model, const CellMesh& cell, std::uint32_t face, int level) {
  const Mesh& mesh = cell.mesh;
  const FaceOrigin& origin = origin_of(mesh, face);
  const std::uint32_t n = mesh.corner_count(face);
  const double all = model.estimated_faces(n, origin.symbol, level);
  if (!cell.footprint || all <= 1) return all;
  if (model.grows_later(origin.symbol, level)) return std::min(all, thinned_faces(model, cell, face, level));
  int refinements = 0;
  for (std::uint32_t v : mesh.corners(face))
    if (!is_frozen(mesh, v))
      refinements = std::max(refinements, refinements_until_fine(model, mesh.nominal_scale[v],
                                                                 cell.footprint->at(mesh.positions[v]), level));
  double faces = 1;
  for (int i = level; i < model.levels() && refinements > 0; ++i) {
    if (!model.step(i).refines()) continue;
    faces *= model.step(i).max_children(faces == 1 ? n : 4);
    --refinements;
  }
  return faces;
}

void measure_nominal_scale(const Model& model, CellMesh& cell, int level) {
  if (!cell.footprint) return;
  Mesh& mesh = cell.mesh;
  if (model.is_two_refinements_in(level)) mesh.nominal_scale.clear();
  mesh.nominal_scale.resize(mesh.vertex_count(), 0);
  if (std::none_of(mesh.nominal_scale.begin(), mesh.nominal_scale.end(), [](double s) { return s == 0; })) return;
  // Diagonals on the model's grid, so that their sums need no order
  std::vector<double> sums(mesh.vertex_count(), 0);
  std::vector<std::uint32_t> counts(mesh.vertex_count(), 0);
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.corners(f);
    if (std::none_of(corners.begin(), corners.end(), [&](auto v) { return mesh.nominal_scale[v] == 0; })) continue;
    const double diagonal = model.quantum().round(mean_diagonal(mesh, f));
    for (std::uint32_t v : corners) {
      sums[v] += diagonal;
      ++counts[v];
    }
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.nominal_scale[v] == 0 && counts[v] > 0)
      mesh.nominal_scale[v] = std::max(sums[v] / counts[v], model.quantum().step());
}

}  // namespace meristem
