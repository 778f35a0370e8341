#include "geometry/cells/expansion.h"

#include "geometry/cells/done_faces.h"
#include "geometry/cells/fading.h"
#include "geometry/cells/gather.h"
#include "geometry/cells/level_of_detail.h"
#include "geometry/cells/position_lattice.h"
#include "geometry/cells/region_extent.h"

#include <algorithm>
#include <chrono>
#include <numeric>

namespace meristem {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// How an expansion goes on after some steps.
enum class Next { Step, Split, Finish };

// Carries a cell through steps until it is final or worth splitting.
class Expander {
 public:
  Expander(const Model& model, CellMesh cell, int level, const UvReaders& uv_readers)
      : model_(model), cell_(std::move(cell)), level_(level), first_level_(level), uv_readers_(uv_readers) {}

  Expansion run() {
    result_.work.resize(std::size_t(model_.levels()));
    begin_squares();
    is_final_ = freeze_vertices(model_, cell_, level_);
    is_leaf_ = makes_one_leaf();
    Next next = Next::Step;
    while ((next = decide()) == Next::Step) apply_step();
    if (next == Next::Finish)
      finish();
    else
      split();
    return std::move(result_);
  }

 private:
  // Whether all that is expected to come of the cell makes a leaf, or of each of its faces alone.
  bool makes_one_leaf() const {
    const double most = 2.0 * model_.settings().leaf_faces;
    double total = 0;
    for (std::uint32_t f = 0; f < cell_.owned_faces && total <= most; ++f)
      total += wanted_faces(model_, cell_, f, level_);
    return total <= most;
  }
  bool each_face_makes_a_leaf() const {
    bool all = true;
    for (std::uint32_t f = 0; f < cell_.owned_faces && all; ++f)
      all = wanted_faces(model_, cell_, f, level_) <= model_.settings().leaf_faces;
    return all;
  }

  Next decide() {
    if (is_final_ || level_ == model_.levels()) return Next::Finish;
    // Less may come of it than was expected while it still grew
    is_leaf_ = is_leaf_ || makes_one_leaf();
    if (is_leaf_) return Next::Step;
    if (model_.step(level_).drops_faces()) return Next::Step;  // who knows what will be left
    if (faces_of_child(model_, cell_, level_) > model_.settings().leaf_faces) return Next::Split;
    const bool may_split = level_ > first_level_ || cell_.owned_faces > model_.settings().inner_faces;
    if (!may_split) return Next::Step;
    if (has_many_thinning_buds()) return Next::Split;
    const double after = double(cell_.owned_faces) * (model_.step(level_).refines() ? 4 : 2);
    return after > model_.settings().inner_faces || each_face_makes_a_leaf() ? Next::Split : Next::Step;
  }

  // Of a plant: every branch can be met alone, before it brings its twigs along.
  bool has_many_thinning_buds() const {
    constexpr int many = 16;
    const Step& step = model_.step(level_);
    int buds = 0;
    for (std::uint32_t f = 0; f < cell_.owned_faces && step.thins() && buds < many; ++f)
      buds += step.grows(cell_.mesh.origins[cell_.mesh.face_origins[f]].symbol);
    return buds >= many;
  }

  // The faces from which the run of refinements at the end starts: they become the leaf's grids.
  void begin_squares() {
    squares_ = {};
    for (std::uint32_t f = 0; f < cell_.owned_faces; ++f) squares_.corners.push_back(cell_.mesh.corner_count(f));
  }

  void apply_step() {
    const auto start = std::chrono::steady_clock::now();
    const Step& step = model_.step(level_);
    if (step.refines())
      begin_fading(model_, cell_, level_);
    else
      leave_out_small_growth(model_, cell_, level_);
    CellMesh out;
    step.apply(cell_, model_.halo_rings(level_ + 1), out);
    out.footprint = cell_.footprint;
    cell_ = std::move(out);
    const std::optional<RefineOptions> refinement = step.refinement();
    if (refinement && refinement->scheme == Scheme::CatmullClark)
      ++squares_.refinements;
    else
      begin_squares();  // triangles of triangles make no squares either
    StepWork& work = result_.work[std::size_t(level_)];
    work = {cell_.owned_faces, seconds_since(start)};
    result_.faces += cell_.owned_faces;
    ++level_;
    if (level_ == model_.levels()) return;
    is_final_ = cell_.owned_faces == 0 || freeze_vertices(model_, cell_, level_);
    if (is_leaf_ && !is_final_) take_done();
  }

  // Triangles make no squares: they go on together.
  void take_done() {
    if (cell_.mesh.corner_count(0) == 3 && model_.step(level_ - 1).refines()) return;
    if (model_.makes_quads_of_triangles_later(level_)) return;
    if (auto done = take_done_faces(model_, cell_, level_, squares_)) done_.push_back(std::move(*done));
  }

  void finish() {
    if (cell_.owned_faces == 0 || cell_.mesh.corner_count(0) != 4) squares_ = {};
    if (model_.settings().keeps_leaf_meshes) {
      result_.leaf.emplace();
      result_.mesh = std::move(cell_);
    } else {
      result_.leaf = tessellate(model_, cell_, level_, squares_, done_, uv_readers_);
    }
  }

  void split() {
    auto inner = std::make_unique<InnerCell>();
    inner->level = level_;
    inner->cell = std::move(cell_);
    inner->faces_around = VertexFaces(inner->cell.mesh);
    make_children(model_, *inner);
    inner->packed = PackedArrays::out_of(inner->cell.mesh);
    inner->cell.mesh.shrink_to_fit();
    result_.inner = std::move(inner);
  }

  const Model& model_;
  CellMesh cell_;
  int level_;
  const int first_level_;
  const UvReaders& uv_readers_;
  bool is_leaf_ = false, is_final_ = false;
  Squares squares_;
  std::vector<DoneFaces> done_;
  Expansion result_;
};

}  // namespace

std::size_t InnerCell::bytes() const {
  return sizeof(*this) + cell.mesh.bytes() + packed.bytes() + cell.rings.capacity() + faces_around.bytes() +
         child_starts.capacity() * 4 + child_faces.capacity() * 4 + child_bounds.capacity() * sizeof(Bounds3f) +
         child_keys.capacity() * 8;
}

CellMesh InnerCell::whole() const {
  CellMesh result = cell;
  result.mesh = packed.back_in(cell.mesh);
  return result;
}

CellMesh root_cell(const Model& model, const Footprint* footprint, Key individual) {
  CellMesh cell = model.base();
  cell.footprint = footprint;
  if (individual == 0) return cell;
  for (Key& key : cell.mesh.face_keys) key = hash_keys(key, individual);
  for (Key& key : cell.mesh.vertex_keys) key = hash_keys(key, individual);
  for (FaceOrigin& origin : cell.mesh.origins) origin.key = hash_keys(origin.key, individual);
  return cell;
}

CellMesh child_cell(const Model& model, const InnerCell& parent, std::size_t child) {
  CellMesh cell = gather_cell(parent.cell.mesh, parent.faces_around, parent.faces_of_child(child),
                              model.halo_rings(parent.level), &parent.packed);
  cell.footprint = parent.cell.footprint;
  return cell;
}

Expansion expand(const Model& model, CellMesh cell, int level, const UvReaders& uv_readers) {
  return Expander(model, std::move(cell), level, uv_readers).run();
}

namespace {

std::vector<std::uint32_t> all_faces(const Mesh& mesh) {
  std::vector<std::uint32_t> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), 0u);
  return faces;
}

}  // namespace

Bounds3f model_bounds(const Model& model) { return model.bounds(); }

Bounds3f model_bounds(const Model& model, const Footprint* footprint, Key individual, int derived_levels) {
  const CellMesh cell = root_cell(model, footprint, individual);
  return round_outwards(region_bounds(model, cell, Adjacency(cell.mesh), all_faces(cell.mesh), 0, derived_levels));
}

}  // namespace meristem
