#include "geometry/cells/gather.h"

#include "geometry/base/check.h"
#include "geometry/base/scratch.h"
#include "geometry/cells/extract.h"
#include "geometry/cells/face_blocks.h"
#include "geometry/cells/level_of_detail.h"
#include "geometry/cells/look_ahead.h"
#include "geometry/cells/numbering.h"
#include "geometry/cells/region_extent.h"
#include "geometry/mesh/adjacency.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace meristem {

namespace {

constexpr std::uint32_t none = ~std::uint32_t(0);

// Walks around vertices of a mesh, from face to face over shared edges, counter-clockwise.
class VertexWalk {
 public:
  VertexWalk(const Mesh& mesh, const VertexFaces& faces_around) : mesh_(mesh), faces_around_(faces_around) {}

  // Calls visit(face) for the other faces around corner k of face f: counter-clockwise from f, and if a boundary stops
  // the walk, clockwise from f. Returns how many.
  template <class Visit>
  std::uint32_t around(std::uint32_t f, std::uint32_t k, Visit visit) const {
    const std::uint32_t v = mesh_.corner_vertices[mesh_.face_starts[f] + k];
    std::uint32_t visited = 0;
    for (std::uint32_t g = next(f, v, true); g != f; g = next(g, v, true)) {
      if (g != none) {
        visit(g), ++visited;
        continue;
      }
      for (std::uint32_t h = next(f, v, false); h != none; h = next(h, v, false)) visit(h), ++visited;
      break;
    }
    return visited;
  }

 private:
  // The corner after v in a face, or the one before it.
  std::uint32_t beside(std::uint32_t f, std::uint32_t v, bool after) const {
    const auto corners = mesh_.corners(f);
    const std::size_t n = corners.size(), k = std::size_t(std::ranges::find(corners, v) - corners.begin());
    return corners[(k + (after ? 1 : n - 1)) % n];
  }

  // The face on the other side of the edge of f that enters (counter-clockwise) or leaves v; none beyond a boundary.
  std::uint32_t next(std::uint32_t f, std::uint32_t v, bool counter_clockwise) const {
    const std::uint32_t end = beside(f, v, !counter_clockwise);
    for (std::uint32_t g : faces_around_.of(v))
      if (g != f && beside(g, v, counter_clockwise) == end) return g;
    return none;
  }

  const Mesh& mesh_;
  const VertexFaces& faces_around_;
};

// A union of small sets of faces: groups that should stand in one cell, none of more than `most` faces.
class Groups {
 public:
  Groups(std::uint32_t count, std::uint32_t most) : parent_(count), size_(count, 1), most_(most) {
    for (std::uint32_t i = 0; i < count; ++i) parent_[i] = i;
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a == b || size_[a] + size_[b] > most_) return;
    parent_[std::max(a, b)] = std::min(a, b);
    size_[std::min(a, b)] += size_[std::max(a, b)];
  }

 private:
  std::vector<std::uint32_t> parent_, size_;  // the size of a set stands at the face that names it
  const std::uint32_t most_;
};

std::vector<std::pair<FaceBlock, std::uint32_t>> faces_by_block(const Mesh& mesh, std::uint32_t faces, double edges) {
  const FaceBlocks blocks(mesh, edges);
  std::vector<std::pair<FaceBlock, std::uint32_t>> result;
  result.reserve(faces);
  for (std::uint32_t f = 0; f < faces; ++f) result.push_back({blocks.of(f), f});
  std::ranges::sort(result);
  return result;
}

// In proportion to how many rays meet the box.
class ChildMaker {
 public:
  ChildMaker(const Model& model, InnerCell& inner)
      : model_(model),
        inner_(inner),
        mesh_(inner.cell.mesh),
        child_faces_(faces_of_child(model, inner.cell, inner.level)) {}

  void run() {
    if (child_faces_ > model_.settings().leaf_faces) {
      add_blocks();
      return find_bounds();
    }
    std::vector<std::uint32_t> bud_of = find_bud_neighbors();
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> buds;  // by the smallest face of the group
    for (std::uint32_t f = 0; f < inner_.cell.owned_faces; ++f)
      if (bud_of[f] != none) buds[bud_of[f]].push_back(f);
    FaceBlock block{};
    for (const auto& [next, f] : faces_in_order()) {
      if (next != block) close_run();  // the next one may lie anywhere
      block = next;
      if (bud_of[f] == none)
        add_plain(f);
      else if (buds[bud_of[f]].front() == f) {
        close_run();
        for (std::uint32_t g : buds[bud_of[f]]) run_.push_back(g);
        close_run();
      }
    }
    close_run();
    find_bounds();
  }

 private:
  void add_blocks() {
    const std::uint32_t faces = inner_.cell.owned_faces;
    double all = 0;
    for (std::uint32_t f = 0; f < faces; ++f) all += wanted_faces(model_, inner_.cell, f, inner_.level);
    const double edges = std::max(1.0, std::round(std::sqrt(child_faces_ * faces / all)));
    FaceBlock block{};
    for (const auto& [next, face] : faces_by_block(mesh_, faces, edges)) {
      if (next != block) close_run();
      block = next;
      add_plain(face);
    }
    close_run();
  }

  // A wide base lists its faces row by row: runs of them would be strips that have several times as much halo as faces
  // of their own. So square by square, unless such squares hold few. What is refined lies in squares already.
  std::vector<std::pair<FaceBlock, std::uint32_t>> faces_in_order() const {
    if (inner_.level == 0 && bud_share_ == 0) {
      constexpr double edges = 22, few = edges * edges / 4;
      auto by_block = faces_by_block(mesh_, inner_.cell.owned_faces, edges);
      double blocks = 1;
      for (std::size_t i = 1; i < by_block.size(); ++i) blocks += by_block[i].first != by_block[i - 1].first;
      if (double(by_block.size()) >= few * blocks) return by_block;
    }
    std::vector<std::pair<FaceBlock, std::uint32_t>> order(inner_.cell.owned_faces);
    for (std::uint32_t f = 0; f < order.size(); ++f) order[f] = {{}, f};
    return order;
  }

  bool is_bud(std::uint32_t f) const {
    return model_.grows_later(mesh_.origins[mesh_.face_origins[f]].symbol, inner_.level);
  }

  // A bud without neighbours reaches nobody's smoothing: it may stand with others in one cell, as far as sizes allow.
  bool is_alone(std::uint32_t f) const {
    const auto corners = mesh_.corners(f);
    return std::all_of(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return inner_.faces_around.of(v).size() == 1; });
  }

  // For owned faces that still grow or touch one that does: the name of their group. Buds that share a neighbour share
  // a group, unless it becomes too large: where they stand in a lattice, all of a mesh would be one group, and a cell
  // that is too large to go on as a whole would have itself as its only child, without end.
  std::vector<std::uint32_t> find_bud_neighbors() const {
    std::vector<std::uint32_t> group(mesh_.face_count(), none);
    Groups groups(mesh_.face_count(), model_.settings().inner_faces);
    for (std::uint32_t bud = 0; bud < mesh_.face_count(); ++bud) {
      if (!is_bud(bud) || is_alone(bud)) continue;
      group[bud] = bud;
      for (std::uint32_t v : mesh_.corners(bud))
        for (std::uint32_t g : inner_.faces_around.of(v)) {
          group[g] = bud;
          if (is_small_bud_cluster()) groups.join(g, bud);
        }
    }
    for (std::uint32_t f = 0; f < inner_.cell.owned_faces; ++f)
      if (group[f] != none) group[f] = is_small_bud_cluster() ? groups.find(f) : is_bud(f) ? f : group[f];
    return group;
  }

  // Where every face of a dense surface grows (spikes on a cactus), joining neighbours would join everything: then each
  // face stands alone.
  bool is_small_bud_cluster() const { return bud_share_ < 0.5; }

  void add_plain(std::uint32_t f) {
    const double faces = wanted_faces(model_, inner_.cell, f, inner_.level);
    if (!run_.empty() && run_faces_ + faces > most_in_child()) close_run();
    run_.push_back(f);
    run_faces_ += faces;
  }

  // A block may hold somewhat more than others.
  double most_in_child() const {
    return child_faces_ > model_.settings().leaf_faces ? 1.5 * child_faces_ : child_faces_;
  }

  void close_run() {
    if (run_.empty()) return;
    inner_.child_faces.insert(inner_.child_faces.end(), run_.begin(), run_.end());
    inner_.child_starts.push_back(std::uint32_t(inner_.child_faces.size()));
    inner_.child_keys.push_back(mesh_.face_keys[run_.front()]);
    run_.clear();
    run_faces_ = 0;
  }

  // By looking ahead; where steps can derive what grows, or too much does, by what is known without.
  void find_bounds() {
    const std::size_t count = inner_.child_keys.size();
    if (!has_lone_buds_) {
      std::vector<std::uint32_t> group_of(inner_.cell.owned_faces);
      for (std::size_t child = 0; child < count; ++child)
        for (std::uint32_t f : inner_.faces_of_child(child)) group_of[f] = std::uint32_t(child);
      if (const auto outlooks = look_ahead(model_, inner_.cell, inner_.level, group_of, count))
        return join_neighbors(*outlooks);
    }
    const Adjacency adjacency(mesh_);
    constexpr int derived_levels = 2;  // a branch and its twigs; more is dear, and most branches are never met
    for (std::size_t child = 0; child < count; ++child)
      inner_.child_bounds.push_back(round_outwards(
          region_bounds(model_, inner_.cell, adjacency, inner_.faces_of_child(child), inner_.level, derived_levels)));
  }

  // Children that follow each other become one as long as they make one leaf and their common box is not much larger
  // for a ray than those of the children.
  void join_neighbors(const std::vector<Outlook>& outlooks) {
    constexpr double worth_joining = 1.25;
    std::vector<std::uint32_t> starts;
    std::vector<Key> keys;
    Outlook joined;
    double area = 0;
    std::size_t faces = 0;  // that are joined
    for (std::size_t child = 0; child < outlooks.size(); ++child) {
      Outlook next = outlooks[child];
      // Faces of which nothing remains are no reason to take in any number of them, nor those of which less comes than
      // was expected: a child must be less than its parent, or small enough to go on as a whole
      const std::size_t more = inner_.faces_of_child(child).size();
      next.faces = std::max(next.faces, double(more));
      Bounds3d both = joined.bounds;
      both.extend(next.bounds);
      const double next_area = next.bounds.surface_area();
      const bool joins = !starts.empty() && joined.faces + next.faces <= model_.settings().leaf_faces &&
                         faces + more <= model_.settings().inner_faces &&
                         both.surface_area() <= worth_joining * (area + next_area);
      if (!joins) {
        if (!starts.empty()) inner_.child_bounds.push_back(round_outwards(joined.bounds));
        starts.push_back(inner_.child_starts[child]);
        keys.push_back(inner_.child_keys[child]);
        joined = {};
        area = 0;
        faces = 0;
        both = next.bounds;
      }
      joined = {both, joined.faces + next.faces};
      faces += more;
      area += next_area;
    }
    inner_.child_bounds.push_back(round_outwards(joined.bounds));
    starts.push_back(inner_.child_starts.back());
    inner_.child_starts = std::move(starts);
    inner_.child_keys = std::move(keys);
  }

  bool find_lone_buds() const {
    for (std::uint32_t f = 0; f < inner_.cell.owned_faces; ++f)
      if (is_bud(f) && is_alone(f)) return true;
    return false;
  }

  double find_bud_share() const {
    std::uint32_t buds = 0;
    for (std::uint32_t f = 0; f < inner_.cell.owned_faces; ++f) buds += is_bud(f);
    return double(buds) / inner_.cell.owned_faces;
  }

  const Model& model_;
  InnerCell& inner_;
  const Mesh& mesh_;
  const double child_faces_;  // that may come of one
  const double bud_share_ = find_bud_share();
  const bool has_lone_buds_ = find_lone_buds();
  std::vector<std::uint32_t> run_;
  double run_faces_ = 0;
};

}  // namespace

CellMesh gather_cell(const Mesh& mesh, const VertexFaces& faces_around, std::span<const std::uint32_t> owned, int rings,
                     const PackedArrays* packed) {
  const VertexWalk walk(mesh, faces_around);
  Numbering faces;
  for (std::uint32_t f : owned) faces.add(f);
  CellMesh cell;
  cell.owned_faces = std::uint32_t(owned.size());
  cell.rings.assign(owned.size(), 0);
  std::size_t begin = 0;
  Scratch<std::uint8_t> is_done(mesh.vertex_count(), 0);  // all faces around the vertex are in the cell
  for (int ring = 1; ring <= rings; ++ring) {
    const std::size_t end = faces.indices().size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t f = faces.indices()[i];
      for (std::uint32_t k = 0; k < mesh.corner_count(f); ++k) {
        const std::uint32_t v = mesh.corner_vertices[mesh.face_starts[f] + k];
        if (is_done[v]) continue;
        const std::uint32_t visited = walk.around(f, k, [&](std::uint32_t g) {
          if (faces.add(g).is_new) cell.rings.push_back(std::uint8_t(ring));
        });
        is_done[v] = visited + 1 == faces_around.of(v).size();
      }
    }
    begin = end;
  }
  cell.mesh = packed ? extract_faces(mesh, *packed, faces.indices()) : extract_faces(mesh, faces.indices());
  return cell;
}

double faces_of_child(const Model& model, const CellMesh& cell, int level) {
  const double leaf_faces = model.settings().leaf_faces;
  const bool only_refines = model.trailing_refinements(level) == model.levels() - level;
  if (!model.settings().keeps_leaf_meshes || !only_refines) return leaf_faces;
  constexpr double many = 1024;
  double leaves = 0;
  for (std::uint32_t f = 0; f < cell.owned_faces; ++f) leaves += wanted_faces(model, cell, f, level) / leaf_faces;
  return leaves > many && cell.owned_faces > many ? leaf_faces * std::sqrt(leaves) : leaf_faces;
}

void make_children(const Model& model, InnerCell& inner) { ChildMaker(model, inner).run(); }

}  // namespace meristem
