#include "geometry/cells/look_ahead.h"

#include "geometry/base/parallel.h"
#include "geometry/cells/face_blocks.h"
#include "geometry/cells/fading.h"
#include "geometry/cells/group_rings.h"
#include "geometry/cells/level_of_detail.h"
#include "geometry/cells/position_lattice.h"
#include "geometry/mesh/refine.h"
#include "geometry/mesh/rings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meristem {

namespace {

// Levels that are left to analysis.
constexpr int analysed_refinements = 3;
// Faces of a mesh that are refined together; of a wide one in squares, which have the less halo the larger they are.
constexpr std::uint32_t part_faces = 512, square_faces = 2048;
constexpr double square_edges = 44;
static_assert(square_edges * square_edges <= square_faces);

// `is_halved`: what comes of the faces is that of a mesh that Catmull-Clark refines next.
Extent extent_of(const Ring1& ring1, const Ring2& ring2, bool is_halved) {
  Extent e;
  e.box = ring1.box;
  if (is_halved) e.refined_box = ring1.refined_box;
  e.edge = ring2.edge;
  e.edge_sum = 2 * ring2.edge;
  e.contraction = e.next_contraction = ring1.contraction;
  auto outwards = [](double lower, double upper) {
    return Interval{std::nextafterf(float(lower), -INFINITY), std::nextafterf(float(upper), INFINITY)};
  };
  e.u = outwards(ring2.lower_uv.x, ring2.upper_uv.x);
  e.v = outwards(ring2.lower_uv.y, ring2.upper_uv.y);
  return e;
}

// A cell's mesh carried on, every owned face labelled with its group.
class Lookahead {
 public:
  Lookahead(const Model& model, const CellMesh& cell, int level, std::span<const std::uint32_t> group_of)
      : model_(model), ahead_(cell), level_(level), grown_level_(model.levels() - model.trailing_refinements(level)) {
    ahead_.labels.assign(group_of.begin(), group_of.end());
  }

  // Until only refinements follow or nothing finer is wanted; whether that was reached. Growth moves no vertex, so that
  // it does not matter when before a refinement they freeze.
  bool grow() {
    while (level_ < grown_level_ && ahead_.owned_faces < most_faces_) {
      if (model_.step(level_).refines()) {
        is_final_ = freeze_vertices(model_, ahead_, level_);
        if (is_final_) return true;
      } else {
        measure_nominal_scale(model_, ahead_, level_);
        leave_out_small_growth(model_, ahead_, level_);
      }
      apply_step();
    }
    return level_ >= grown_level_;
  }

  void add_faces(std::span<Outlook> groups) {
    measure_nominal_scale(model_, ahead_, level_);
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      groups[ahead_.labels[f]].faces += is_final_ ? 1 : wanted_faces(model_, ahead_, f, level_);
  }

  // Refines a grown mesh part by part: threads that wait for it may take one, and what comes of a part is still in the
  // processor's cache when it is bounded.
  void refine_and_bound(std::span<Outlook> groups) {
    const std::vector<std::vector<std::uint32_t>> parts = parts_of(groups.size());
    if (parts.size() == 1) return refine_and_bound_together(groups);
    std::vector<std::uint32_t> part_of(groups.size()), place(groups.size());
    for (std::uint32_t i = 0; i < parts.size(); ++i)
      for (std::uint32_t k = 0; k < parts[i].size(); ++k) part_of[parts[i][k]] = i, place[parts[i][k]] = k;
    std::vector<std::vector<std::uint32_t>> faces(parts.size());
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f) faces[part_of[ahead_.labels[f]]].push_back(f);
    const VertexFaces faces_around(ahead_.mesh);
    parallel_for(parts.size(), [&](std::size_t i) {
      std::vector<Outlook> own(parts[i].size());
      for (std::size_t k = 0; k < own.size(); ++k) own[k] = groups[parts[i][k]];
      part(faces[i], place, faces_around).refine_and_bound_together(own);
      for (std::size_t k = 0; k < own.size(); ++k) groups[parts[i][k]] = own[k];
    });
  }

 private:
  Lookahead(const Lookahead& whole, CellMesh part)
      : model_(whole.model_),
        ahead_(std::move(part)),
        level_(whole.level_),
        grown_level_(whole.grown_level_),
        most_faces_(whole.most_faces_ * ahead_.owned_faces / whole.ahead_.owned_faces),
        is_final_(whole.is_final_) {}

  // The groups of each part: such as follow each other, or, on a wide base, lie in one square of its faces. In rows
  // across it a part would have several times as much halo as faces of its own; what is refined lies in squares anyway.
  std::vector<std::vector<std::uint32_t>> parts_of(std::size_t group_count) const {
    std::vector<std::uint32_t> sizes(group_count, 0), firsts(group_count, 0);
    for (std::uint32_t f = ahead_.owned_faces; f-- > 0;) {
      ++sizes[ahead_.labels[f]];
      firsts[ahead_.labels[f]] = f;
    }
    std::vector<std::pair<FaceBlock, std::uint32_t>> order(group_count);
    for (std::uint32_t g = 0; g < group_count; ++g) order[g] = {{}, g};
    const bool is_wide = is_base_ && ahead_.owned_faces > square_faces && sort_by_square(firsts, order);
    const std::uint32_t most = is_wide ? square_faces : part_faces;
    std::vector<std::vector<std::uint32_t>> parts(1);
    std::uint32_t faces = 0;
    FaceBlock block = order.front().first;
    for (const auto& [next, group] : order) {
      if (faces >= most || (next != block && faces >= most / 2)) {
        parts.emplace_back();
        faces = 0;
      }
      block = next;
      parts.back().push_back(group);
      faces += sizes[group];
    }
    return parts;
  }

  // False, and nothing is sorted, if squares of so many edges of the first face hold few faces.
  bool sort_by_square(std::span<const std::uint32_t> firsts,
                      std::vector<std::pair<FaceBlock, std::uint32_t>>& order) const {
    const FaceBlocks blocks(ahead_.mesh, square_edges);
    auto sorted = order;
    for (auto& [block, group] : sorted) block = blocks.of(firsts[group]);
    std::ranges::sort(sorted);
    std::size_t count = 1;
    for (std::size_t i = 1; i < sorted.size(); ++i) count += sorted[i].first != sorted[i - 1].first;
    constexpr std::size_t few = square_faces / 4;
    if (ahead_.owned_faces < few * count) return false;
    order = std::move(sorted);
    return true;
  }

  // With its halo, and groups labelled anew by their places in it.
  Lookahead part(std::span<const std::uint32_t> faces, std::span<const std::uint32_t> place,
                 const VertexFaces& faces_around) const {
    CellMesh part = cell_of_faces(ahead_, faces, model_.halo_rings(level_), faces_around);
    for (std::uint32_t& label : part.labels) label = place[label];
    return {*this, std::move(part)};
  }

  // Before displacement at least once, so that all faces are quads (or triangles). A group that analysis is good enough
  // for is not carried further with those that want finer faces.
  void refine_and_bound_together(std::span<Outlook> groups) {
    bool is_refined = !is_displaced_later();
    while (true) {
      std::vector<std::uint8_t> wanted;
      is_final_ = is_final_ || level_ == model_.levels() || freeze(groups, wanted);
      if (is_final_ || ahead_.owned_faces >= most_faces_) break;
      if (is_refined && bound_fine_groups(groups, wanted)) return;
      apply_step();
      is_refined = true;
    }
    add_bounds(groups, std::vector<bool>(groups.size(), true));
  }

  // Where levels fade, a vertex is drawn towards the place where it was shown, which has to be known then.
  bool freeze(std::span<Outlook> groups, std::vector<std::uint8_t>& wanted) {
    if (fades(ahead_)) return freeze_vertices(model_, ahead_, level_, &wanted);
    std::vector<Bounds3d> frozen;  // by vertex
    const bool is_final = freeze_in_boxes(model_, ahead_, level_, &wanted, [&](std::uint32_t v, const Bounds3d& box) {
      frozen.resize(ahead_.mesh.vertex_count());
      frozen[v] = box.inflated(Vec3d(2 * model_.quantum().step()));
    });
    if (frozen.empty()) return is_final;
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      for (std::uint32_t v : ahead_.mesh.corners(f))
        if (!frozen[v].empty()) groups[ahead_.labels[f]].bounds.extend(frozen[v]);
    return is_final;
  }

  // Bounds groups whose vertices want no more refinements than analysis may carry, and takes them out of the mesh, if
  // they are enough to be worth it; returns whether no others are left.
  bool bound_fine_groups(std::span<Outlook> groups, const std::vector<std::uint8_t>& wanted) {
    constexpr double worth_taking = 0.25;
    std::vector<bool> is_fine(groups.size(), true);
    std::vector<std::uint32_t> others;
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      for (std::uint32_t v : ahead_.mesh.corners(f))
        if (wanted[v] > analysed_refinements) is_fine[ahead_.labels[f]] = false;
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      if (!is_fine[ahead_.labels[f]]) others.push_back(f);
    if (double(others.size()) > (1 - worth_taking) * ahead_.owned_faces) return false;
    add_bounds(groups, is_fine);
    if (others.empty()) return true;
    ahead_ = cell_of_faces(ahead_, others, model_.halo_rings(level_));
    return false;
  }

  // Of those of the groups that have faces left.
  void add_bounds(std::span<Outlook> groups, const std::vector<bool>& is_asked) const {
    const GroupRings rings =
        rings_of_groups(ahead_.mesh, std::span(ahead_.labels).first(ahead_.owned_faces), groups.size());
    // Of a mesh that is final nothing moves any more, but towards the limit surface
    const int level = is_final_ ? model_.levels() : level_;
    const bool is_halved = is_by_catmull_clark();
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (is_asked[g] && !rings.ring1[g].box.empty())
        groups[g].bounds.extend(final_bounds(model_, extent_of(rings.ring1[g], rings.ring2[g], is_halved), level));
    add_frozen(groups, is_asked);
  }

  // Whether Catmull-Clark makes what is shown of the mesh, or it is shown as it is.
  bool is_by_catmull_clark() const {
    std::optional<RefineOptions> scheme;
    if (!is_final_ && level_ < model_.levels())
      scheme = model_.step(level_).refinement();
    else if (const auto smoothing = model_.smoothing(level_))
      scheme = smoothing->scheme;
    return !scheme || scheme->scheme == Scheme::CatmullClark;
  }

  void apply_step() {
    if (model_.step(level_).refines()) begin_fading(model_, ahead_, level_);
    CellMesh out;
    model_.step(level_).apply(ahead_, model_.halo_rings(level_ + 1), out);
    out.footprint = ahead_.footprint;
    ahead_ = std::move(out);
    ++level_;
  }

  bool is_displaced_later() const {
    for (int level = level_; level < model_.levels(); ++level)
      if (model_.step(level).displaces()) return true;
    return false;
  }

  // Vertices that later levels would move, but which are shown where they are.
  void add_frozen(std::span<Outlook> groups, const std::vector<bool>& is_asked) const {
    const Mesh& mesh = ahead_.mesh;
    if (mesh.frozen.empty() && mesh.fading.empty()) return;
    std::vector<Bounds3d> frozen(groups.size());
    for (std::uint32_t f = 0; f < ahead_.owned_faces; ++f)
      for (std::uint32_t v : mesh.corners(f)) extend_by_earlier_levels(mesh, v, frozen[ahead_.labels[f]]);
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (is_asked[g] && !frozen[g].empty())
        groups[g].bounds.extend(frozen[g].inflated(Vec3d(model_.quantum().step())));
  }

  const Model& model_;
  CellMesh ahead_;
  int level_;
  const int grown_level_;
  const double most_faces_ = 1 << 18;                           // it is carried no further where it has more
  const bool is_base_ = level_ == 0 && level_ >= grown_level_;  // nothing has grown or been refined
  bool is_final_ = false;
};

}  // namespace

std::optional<std::vector<Outlook>> look_ahead(const Model& model, const CellMesh& cell, int level,
                                               std::span<const std::uint32_t> group_of, std::size_t group_count) {
  Lookahead ahead(model, cell, level, group_of);
  if (!ahead.grow()) return {};
  std::vector<Outlook> groups(group_count);
  ahead.add_faces(groups);
  ahead.refine_and_bound(groups);
  for (Outlook& group : groups) group.bounds = group.bounds.inflated(Vec3d(PositionLattice::margin(model)));
  return groups;
}

}  // namespace meristem
