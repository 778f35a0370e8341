#include "geometry/cells/level_of_detail.h"

#include "geometry/cells/fading.h"
#include "geometry/cells/position_lattice.h"
#include "geometry/cells/tessellation.h"
#include "geometry/cells/thinning.h"
#include "geometry/cells/uv_lattice.h"
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

// A face on which something grows, and how large that is.
class Bud {
 public:
  Bud(const Model& model, const CellMesh& cell, std::uint32_t f, int level)
      : model_(model), origin_(origin_of(cell.mesh, f)), level_(level) {
    const Mesh& mesh = cell.mesh;
    Vec3d center;
    for (std::uint32_t v : mesh.corners(f)) {
      box_.extend(mesh.positions[v]);
      center += mesh.positions[v] * (1.0 / mesh.corner_count(f));
    }
    for (std::uint32_t v : mesh.corners(f)) radius_ = std::max(radius_, length(mesh.positions[v] - center));
    if (!mesh.enlargements.empty()) enlargement_ = double(mesh.enlargements[f].of_face);
    footprint_ = cell.footprint->at(center);
  }

  double radius() const { return radius_; }
  double footprint() const { return footprint_; }
  // How far what grows reaches beyond the face. Dear.
  double reach() const { return reach_up_to(INFINITY); }
  // Whether anything of it is larger than so much.
  bool exceeds(double size) const { return radius_ > size || reach_up_to(size) > size; }

 private:
  double reach_up_to(double size) const {
    return enlargement_ * model_.growth_reach(origin_, box_, radius_ / enlargement_, level_, size / enlargement_);
  }

  const Model& model_;
  const FaceOrigin& origin_;
  const int level_;
  Bounds3d box_;
  double radius_ = 0, enlargement_ = 1, footprint_ = 0;
};

// Whether something grows on the face at `level` or later that could be seen.
bool has_visible_growth(const Model& model, const CellMesh& cell, std::uint32_t f, int level) {
  const std::int32_t symbol = origin_of(cell.mesh, f).symbol;
  const int growing = model.growing_step(symbol, level);
  if (growing == model.levels()) return false;
  if (model.step(growing).thins()) return true;
  const Bud bud(model, cell, f, level);
  const bool may_be_enlarged = model.step(growing).thinning(symbol) > 0;
  return bud.exceeds(bud.footprint() / (may_be_enlarged ? largest_enlargement : 1));
}

// What becomes of a bud whose symbol thins below so many footprints, and of what grows on it if it is kept. Twice as
// fine as usual where it is small: a convex outline of few vertices on a curve covers less than the curve.
Thinned thin_bud(const Bud& bud, double pixels, Key key, Enlargement& enlargement) {
  constexpr double most_detail = 2;
  const double wanted = pixels * bud.footprint();
  if (bud.radius() >= 2 * most_detail * wanted) return {};
  const double size = bud.radius() + bud.reach();
  enlargement.detail = float(std::clamp(2 * most_detail * wanted / size, 1.0, most_detail));
  const Thinned result = thin(size / wanted, uniform_double(hash_keys(key, thinning_tag)));
  enlargement.of_growth =
      float(std::clamp(double(enlargement.of_face) * result.enlargement, smallest_enlargement, largest_enlargement));
  return result;
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
  bool is_time() const { return candidates_ > 0 && level_ < model_.levels() && model_.step(level_).refines(); }

  void freeze() {
    mesh_.frozen.resize(mesh_.vertex_count());
    const LimitSurface surface = shown_surface(cell_, model_.smoothing(level_));
    const std::vector<Vec2d> uv = vertex_uv(mesh_);
    const UvLattice uv_lattice(mesh_, uv);
    const PositionLattice lattice(model_, cell_);
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
      if (is_candidate_[v]) {
        const FadingVertex shown = faded(mesh_, v, Vec3f(surface.positions[v]), Vec3f(surface.normals[v]),
                                         Vec2f{float(uv[v].x), float(uv[v].y)});
        mesh_.frozen[v] = {true, false, lattice.round(v, shown.position), shown.normal, uv_lattice.round(v, shown.uv)};
      }
    if (!has_seams(mesh_)) return;
    for (std::size_t c = 0; c < mesh_.corner_uv.size(); ++c) {
      const std::uint32_t v = mesh_.corner_vertices[c];
      if (!is_candidate_[v]) continue;
      const Vec2f own = uv_lattice.round(v, {float(mesh_.corner_uv[c].x), float(mesh_.corner_uv[c].y)});
      mesh_.corner_uv[c] = {double(own.x), double(own.y)};
    }
  }

  void freeze_in_boxes(const FrozenBox& visit) {
    mesh_.frozen.resize(mesh_.vertex_count());
    std::vector<Bounds3d> boxes(mesh_.vertex_count());
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.corners(f);
      if (std::ranges::none_of(corners, [&](std::uint32_t v) { return is_candidate_[v]; })) continue;
      Bounds3d box;
      for (std::uint32_t v : corners) box.extend(mesh_.positions[v]);
      for (std::uint32_t v : corners) boxes[v].extend(box);
    }
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
      if (is_candidate_[v]) {
        mesh_.frozen[v] = {true, false, Vec3f(mesh_.positions[v]), {}, {}};
        visit(v, boxes[v]);
      }
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

namespace {

// `freeze` does what is to be done once it is known what freezes.
template <class Freeze>
bool freeze_by(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted, const Freeze& freeze) {
  if (wanted) wanted->assign(cell.mesh.vertex_count(), std::uint8_t(model.trailing_refinements(level)));
  if (!cell.footprint) return false;
  measure_nominal_scale(model, cell, level);
  if (model.drops_faces_later(level)) return false;  // which of the faces will be shown is not known yet
  Freezing freezing(model, cell, level, wanted);
  // A triangle that is done is shown as Catmull-Clark would cut it, which is known when that comes next: until then all
  // go on, and those that are done make nothing but copies.
  if (freezing.find_candidates() && !model.makes_quads_of_triangles_later(level)) return true;
  if (freezing.is_time()) freeze(freezing);
  return false;
}

}  // namespace

bool freeze_vertices(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted) {
  return freeze_by(model, cell, level, wanted, [](Freezing& f) { f.freeze(); });
}

bool freeze_in_boxes(const Model& model, CellMesh& cell, int level, std::vector<std::uint8_t>* wanted,
                     const FrozenBox& visit) {
  return freeze_by(model, cell, level, wanted, [&](Freezing& f) { f.freeze_in_boxes(visit); });
}

void leave_out_small_growth(const Model& model, CellMesh& cell, int level) {
  if (!cell.footprint) return;
  Mesh& mesh = cell.mesh;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const FaceOrigin& origin = origin_of(mesh, f);
    if (!model.step(level).grows(origin.symbol)) continue;
    bool is_kept = has_visible_growth(model, cell, f, level);
    const double pixels = model.step(level).thinning(origin.symbol);
    if (is_kept && pixels > 0) {
      Enlargement e = mesh.enlargements.empty() ? Enlargement{} : mesh.enlargements[f];
      is_kept = thin_bud(Bud(model, cell, f, level), pixels, mesh.face_keys[f], e).is_kept;
      if (is_kept && (e.of_growth != e.of_face || e.detail != 1)) mesh.enlargements.resize(mesh.face_count());
      if (is_kept && !mesh.enlargements.empty()) mesh.enlargements[f] = e;
    }
    if (is_kept) continue;
    FaceOrigin terminal = origin;
    terminal.symbol = omitted_symbol(origin.symbol);
    mesh.face_origins[f] = std::uint32_t(mesh.origins.size());
    mesh.origins.push_back(terminal);
  }
}

double share_of_level(const Model& model, double scale, double footprint, int level) {
  if (is_fine_enough(model, scale, footprint, level)) return 1;
  const double excess =
      std::max(scale / (std::numbers::sqrt2 * footprint), model.remaining_offset(level, scale) / footprint) - 1;
  return std::clamp(excess, 0.0, 1.0);
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
    const double detail = mesh.enlargements.empty() ? 1 : double(mesh.enlargements[f].detail);
    const double diagonal = model.quantum().round(detail * mean_diagonal(mesh, f));
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
