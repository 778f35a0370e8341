#include "geometry/cells/expansion.h"

#include "tests/support/leaf_quads.h"
#include "tests/support/test_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>

namespace meristem {
namespace {

Mesh creased_cube() {
  Mesh mesh = shapes::cube();
  shapes::crease(mesh, 0, 1, 2.3f);
  shapes::crease(mesh, 1, 3, 10);
  return mesh;
}

TEST(Expansion, SurfaceDoesNotDependOnTheCut) {
  struct {
    const char* name;
    Mesh mesh;
  } cages[] = {{"cube", shapes::cube()},
               {"prism", shapes::prism(8)},
               {"tetrahedron", shapes::tetrahedron()},
               {"open grid", shapes::bumpy_grid(3)},
               {"creased", creased_cube()}};
  for (const auto& cage : cages)
    for (double amplitude : {0.0, 0.3}) {  // 0: the limit surface
      const auto whole = quads_of(leaves_of(*bumpy_model(cage.mesh, 5, amplitude, {1u << 20, 1u << 20})));
      for (const CellSettings settings :
           {CellSettings{4, 16}, CellSettings{16, 64}, CellSettings{64, 16}, CellSettings{256, 1024}}) {
        int cells = 0;
        const auto cut = quads_of(leaves_of(*bumpy_model(cage.mesh, 5, amplitude, settings), &cells));
        EXPECT_GT(cells, 1) << cage.name;
        EXPECT_TRUE(cut == whole) << cage.name << " amplitude " << amplitude << " leaf " << settings.leaf_faces;
      }
    }
}

TEST(Expansion, LeavesOfAClosedModelFitEdgeToEdge) {
  const auto leaves = leaves_of(*bumpy_model(shapes::prism(8), 4, 0.4, {16, 64}));
  std::map<Edge, int> edges;  // directed: every edge must be met once in each direction
  for (const auto& q : quads_of(leaves))
    for (int k = 0; k < 4; ++k) ++edges[{q[std::size_t(k)], q[std::size_t((k + 1) % 4)]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

TEST(Expansion, BoundsContainWhatGrowsInThem) {
  int cells = 0;
  for (double amplitude : {0.0, 0.1, 0.5, 1.0})
    for (const Mesh& base : {shapes::cube(), shapes::prism(8), shapes::tetrahedron(), shapes::bumpy_grid(3),
                             creased_cube(), shapes::prism(3)})
      for (const CellSettings settings : {CellSettings{4, 16}, CellSettings{16, 64}}) {
        const auto model = bumpy_model(base, 5, amplitude, settings);
        EXPECT_EQ(count_outside(*model, root_cell(*model), 0, model_bounds(*model), cells), 0);
      }
  EXPECT_GT(cells, 10000);
}

// Fine at a corner, coarse elsewhere.
class CornerFootprint final : public Footprint {
 public:
  double at(Vec3d p) const override { return 0.003 + 0.03 * length(p - Vec3d{1, 1, 1}); }
};

TEST(Expansion, BoundsContainWhatComesOfAMeshThatIsBoundedInParts) {
  const CornerFootprint corner;
  for (const Footprint* footprint : {static_cast<const Footprint*>(nullptr), static_cast<const Footprint*>(&corner)}) {
    const auto model = bumpy_model(shapes::cube(), footprint ? 9 : 7, 0.5, {16, 1u << 16});
    const CellMesh root = root_cell(*model, footprint);
    const Expansion e = expand(*model, root, 0);
    ASSERT_TRUE(e.inner);
    EXPECT_GT(e.inner->cell.owned_faces, 1024u);
    int cells = 0;
    EXPECT_EQ(count_outside(*model, root, 0, model_bounds(*model), cells), 0);
    EXPECT_GT(cells, 100);
  }
}

// As BumpyStep, and counts the faces that it is given.
class CountingStep final : public Step {
 public:
  explicit CountingStep(std::atomic<std::uint64_t>& faces) : bumpy_(0.2, 1), faces_(faces) {}
  std::string name() const override { return bumpy_.name(); }
  int halo_rings(int rings_after) const override { return bumpy_.halo_rings(rings_after); }
  std::uint32_t max_children(std::uint32_t corners) const override { return bumpy_.max_children(corners); }
  bool displaces() const override { return true; }
  bool refines() const override { return true; }
  std::optional<RefineOptions> refinement() const override { return bumpy_.refinement(); }
  void set_quantum(const Quantum& quantum) override { bumpy_.set_quantum(quantum); }
  void apply(const CellMesh& in, int rings_after, CellMesh& out) const override {
    faces_ += in.mesh.face_count();
    bumpy_.apply(in, rings_after, out);
  }
  Extent bound(const Extent& e) const override { return bumpy_.bound(e); }

 private:
  BumpyStep bumpy_;
  std::atomic<std::uint64_t>& faces_;
};

// Row by row a part of 512 faces, two rows and a half, would have a halo of six rows.
TEST(Expansion, WideGroundIsBoundedSquareBySquare) {
  Mesh base = shapes::bumpy_grid(200);
  for (Vec3d& p : base.positions) p.y = 0;
  std::atomic<std::uint64_t> faces = 0;
  std::vector<std::unique_ptr<Step>> steps;
  for (int i = 0; i < 4; ++i) steps.push_back(std::make_unique<CountingStep>(faces));
  const Model model("wide", base, std::move(steps), {.leaf_faces = 256, .inner_faces = 8192});
  const Expansion e = expand(model, root_cell(model), 0);
  ASSERT_TRUE(e.inner);
  EXPECT_EQ(e.inner->level, 0);
  EXPECT_GE(faces, base.face_count()) << "it was looked ahead";
  EXPECT_LT(faces, 1.8 * base.face_count());
  const Expansion child = expand(model, child_cell(model, *e.inner, e.inner->child_count() / 2), 0);
  ASSERT_TRUE(child.leaf);
  EXPECT_TRUE(e.inner->child_bounds[e.inner->child_count() / 2].contains(child.leaf->bounds()));
}

// A run of 128 faces along a row would be 128 wide.
TEST(Expansion, ChildrenOfAWideBaseAreNoStrips) {
  Mesh base = shapes::bumpy_grid(200);
  for (Vec3d& p : base.positions) p.y = 0;
  const auto model = bumpy_model(base, 2, 0);
  const Expansion e = expand(*model, root_cell(*model), 0);
  ASSERT_TRUE(e.inner);
  EXPECT_EQ(e.inner->level, 0);
  std::set<std::uint32_t> faces(e.inner->child_faces.begin(), e.inner->child_faces.end());
  EXPECT_EQ(faces.size(), base.face_count());
  EXPECT_EQ(e.inner->child_faces.size(), base.face_count());
  for (std::size_t i = 0; i < e.inner->child_count(); ++i) {
    Bounds3d box;
    for (std::uint32_t f : e.inner->faces_of_child(i))
      for (std::uint32_t v : base.corners(f)) box.extend(base.positions[v]);
    EXPECT_LE(std::max(box.size().x, box.size().z), 50) << i;
    EXPECT_LE(e.inner->faces_of_child(i).size(), 128u);
  }
}

// The keys of the faces of all leaves, each with those of its leaf.
void add_leaves(const Model& model, const Expansion& e, std::map<Key, std::vector<Key>>& leaves, std::size_t& widest) {
  if (!e.inner) {
    const auto& keys = e.mesh.mesh.face_keys;
    const std::vector<Key> own(keys.begin(), keys.begin() + e.mesh.owned_faces);
    for (Key key : own) leaves[key] = own;
    return;
  }
  widest = std::max(widest, e.inner->child_count());
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    add_leaves(model, expand(model, child_cell(model, *e.inner, i), e.inner->level), leaves, widest);
}

// Of wide ground only what is near a ray is expanded; what its leaves are does not depend on that.
TEST(Expansion, WideGroundIsSplitTwice) {
  const Mesh base = shapes::bumpy_grid(40);
  CellSettings settings{.leaf_faces = 16, .keeps_leaf_meshes = true};
  const auto wide = bumpy_model(base, 2, 0.3, settings);
  std::map<Key, std::vector<Key>> leaves;
  std::size_t widest = 0;
  add_leaves(*wide, expand(*wide, root_cell(*wide), 0), leaves, widest);
  EXPECT_EQ(leaves.size(), 16u * base.face_count());
  EXPECT_GT(base.face_count(), 1024u);
  EXPECT_LT(widest, 200u);
  // One face of the base is one leaf, and in the order of its own refinement
  std::set<std::vector<Key>> distinct;
  for (const auto& [key, leaf] : leaves) {
    EXPECT_EQ(leaf.size(), 16u);
    distinct.insert(leaf);
  }
  EXPECT_EQ(distinct.size(), base.face_count());
}

TEST(Expansion, BoundsAreNotLoose) {
  // Without displacement the bounds are the hull of the control points: at most a cell's width away on either side.
  const auto model = bumpy_model(shapes::cube(), 6, 0, {64, 1024});
  Expansion e = expand(*model, root_cell(*model), 0);
  ASSERT_TRUE(e.inner);
  for (std::size_t i = 0; i < e.inner->child_count(); ++i) {
    const Expansion child = expand(*model, child_cell(*model, *e.inner, i), e.inner->level);
    ASSERT_TRUE(child.leaf);
    EXPECT_LT(e.inner->child_bounds[i].diagonal(), 4 * child.leaf->bounds().diagonal());
  }
}

TEST(Expansion, OneLeafIsGridsWithUnitNormals) {
  const auto leaves = leaves_of(*bumpy_model(shapes::prism(8), 3, 0, {1u << 20, 1u << 20}));
  ASSERT_EQ(leaves.size(), 1u);
  EXPECT_EQ(leaves[0].grids.size(), 8u + 2 * 8);   // eight quads, and two octagons of eight quads each
  EXPECT_EQ(leaves[0].face_count, (8u + 4) * 64);  // quads give 4^3, an octagon gives 8 * 4^2
  for (const PackedAttributes& a : leaves[0].attributes) EXPECT_NEAR(length(a.normal.unpack()), 1, 1e-5);
}

TEST(Expansion, SmoothModelsEndOnTheirLimitSurface) {
  // The vertices after two levels are among those after three.
  const auto coarse = leaves_of(*bumpy_model(shapes::prism(8), 2, 0, {16, 64}));
  const auto fine = leaves_of(*bumpy_model(shapes::prism(8), 3, 0, {16, 64}));
  for (const Tessellation& t : coarse)
    for (std::size_t v = 0; v < t.positions.size(); ++v) {
      float position_error = 1, normal_error = 1;
      for (const Tessellation& u : fine)
        for (std::size_t w = 0; w < u.positions.size(); ++w)
          if (const float error = length(u.positions[w] - t.positions[v]); error < position_error) {
            position_error = error;
            normal_error = length(u.attributes[w].normal.unpack() - t.attributes[v].normal.unpack());
          }
      EXPECT_LT(position_error, 1e-6f);
      EXPECT_LT(normal_error, 1e-6f);
    }
}

TEST(Expansion, DisplacedModelsKeepTheirVertices) {
  // As good as no displacement, but the vertices stay where the last step put them.
  const auto model = bumpy_model(shapes::cube(), 1, 1e-9);
  const auto leaves = leaves_of(*model);
  ASSERT_EQ(leaves.size(), 1u);
  EXPECT_NEAR(leaves[0].bounds().upper.x, 1, 1e-6);  // the face point; its limit is nearer to the centre
}

}  // namespace
}  // namespace meristem
