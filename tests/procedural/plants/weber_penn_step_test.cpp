// Trees as meshes: closed stems, the same bits in whatever cells, inside their bounds.
#include "tests/procedural/plants/plant_support.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace meristem::test {
namespace {

const std::string small_trees[] = {
    R"("species": "quaking_aspen", "branches": [0, 9, 5], "leaves": 4)",
    R"("species": "black_tupelo", "branches": [0, 6, 4, 3], "leaves": 3, "leaf_shape": "maple_5_lobes")",
    R"("species": "weeping_willow", "branches": [0, 6, 4, 9], "leaves": 3)",
    R"("species": "california_black_oak", "branches": [0, 7, 6], "leaves": 4, "leaf_shape": "oak_3_lobes")",
    R"("levels": 1, "leaves": -6, "taper": [2.2], "seg_splits": [2], "split_angle": [30], "curve_res": [6])",
    R"("levels": 2, "branches": [0, -7], "seg_splits": [1, 1], "taper": [0, 3], "base_splits": 4, "split_angle": [0, 5],
       "split_angle_v": [0, 5], "leaves": 2)",
};

// Meshes every stem alone.
void expect_closed_stems(const WeberPennParameters& p, Key key, bool is_smoothed) {
  for_each_stem(p, trunk_of(p, key), [&](const Stem& stem) {
    Mesh mesh;
    const Quantum quantum(0x1p-35);
    PlantMesh out(mesh, quantum, quantum, true, 1);
    out.begin_bud(stem.bud().key);
    StemDetail detail;
    detail.sides = stem.bud().level == 0 ? 16 : stem.bud().level == 1 ? 8 : 4;
    detail.is_smoothed = is_smoothed;
    mesh_stem(stem, p, detail, {0, 0}, out);
    out.finish();
    ASSERT_EQ(manifold_defect(mesh), "");
    ASSERT_TRUE(is_closed(mesh));
    ASSERT_EQ(euler_characteristic(mesh), 2);
    ASSERT_EQ(mesh.corner_uv.size(), mesh.corner_vertices.size());
    const StemReach reach = stem_reach(p, stem.bud().level, stem.bud().length, stem.bud().radius);
    const double most = reach.axis + 0.2 * stem.segment_length() + 2 * 1.5 * reach.radius * (1 + p.lobe_depth);
    for (Vec3d v : mesh.positions) ASSERT_LE(length(v - stem.bud().frame.origin), most);
  });
}

TEST(WeberPennStep, EveryStemIsOneClosedManifold) {
  for (const std::string& tree : small_trees) {
    SCOPED_TRACE(tree);
    const WeberPennParameters p = parameters_of(tree);
    for (Key key = 0; key < 6; ++key) {
      expect_closed_stems(p, key, key % 2);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(WeberPennStep, AWholeTreeIsAManifoldWithDistinctKeys) {
  for (const std::string& tree : small_trees) {
    const auto model = tree_model(tree, 5);
    const Mesh mesh = grown(*model, model->levels());
    EXPECT_EQ(manifold_defect(mesh), "") << tree;
    EXPECT_EQ(std::set<Key>(mesh.face_keys.begin(), mesh.face_keys.end()).size(), mesh.face_count());
    EXPECT_EQ(std::set<Key>(mesh.vertex_keys.begin(), mesh.vertex_keys.end()).size(), mesh.vertex_count());
    for (Vec3d p : mesh.positions) ASSERT_EQ(p, model->quantum().round(p));
  }
}

TEST(WeberPennStep, RootsLieInsideTheParent) {
  // Aspen without bends: the root of a branch is no further from the trunk's axis than the trunk is thick there
  const auto model = tree_model(
      R"("species": "quaking_aspen", "curve_v": [0], "bend_v": [0], "branches": [0, 20, 0], "leaves": 0,
         "scale_v": 0)");
  const Mesh mesh = grown(*model, 2);
  int roots = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (mesh.corner_count(f) != 8) continue;  // the root polygon of a branch
    ++roots;
    for (std::uint32_t v : mesh.corners(f)) {
      const Vec3d p = mesh.positions[v];
      EXPECT_LE(std::hypot(p.x, p.z), tapered_radius(1, 13, 0.195, p.y / 13) * 1.35);
    }
  }
  EXPECT_EQ(roots, 20);
}

// The final surface as a set of triangles, however it was cut.
using Triangle = std::array<float, 9>;
void add_surface(const Tessellation& t, std::vector<Triangle>& all) {
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3f p = t.positions[a], q = t.positions[b], r = t.positions[c];
    all.push_back({p.x, p.y, p.z, q.x, q.y, q.z, r.x, r.y, r.z});
  };
  for (const auto& [a, b, c] : t.triangles) add(a, b, c);
  for (const Tessellation::Grid& g : t.grids)
    for (std::uint32_t j = 0; j + 1 < g.height; ++j)
      for (std::uint32_t i = 0; i + 1 < g.width; ++i) {
        const std::uint32_t v = g.first_vertex + j * g.width + i;
        add(v, v + 1, v + g.width);
        add(v + 1, v + g.width + 1, v + g.width);
      }
}

double half_area(const Bounds3f& b) {
  const Vec3d s(b.size());
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

struct Walk {
  std::vector<Triangle> surface;
  int cells = 0, outside = 0;
  Bounds3f bounds;  // of the surface
};

// Returns the bounds of the surface that comes of the cell.
Bounds3f walk(const Model& model, CellMesh cell, int level, const Bounds3f& bounds, Walk& result) {
  ++result.cells;
  const Expansion e = expand(model, std::move(cell), level);
  Bounds3f real;
  if (e.leaf) {
    real = e.leaf->bounds();
    add_surface(*e.leaf, result.surface);
  } else {
    for (std::size_t i = 0; i < e.inner->child_count(); ++i)
      real.extend(walk(model, child_cell(model, *e.inner, i), e.inner->level, e.inner->child_bounds[i], result));
  }
  result.outside += !bounds.contains(real);
  return real;
}

Walk walk_whole(const Model& model, const Footprint* footprint = nullptr, Key individual = 0) {
  Walk result;
  const Bounds3f derived = model_bounds(model, footprint, individual, model.levels());
  EXPECT_TRUE(model_bounds(model).contains(derived));
  result.bounds = walk(model, root_cell(model, footprint, individual), 0, derived, result);
  std::sort(result.surface.begin(), result.surface.end());
  return result;
}

TEST(WeberPennStep, GrowsTheSameBitsInWhateverCellsAndInsideItsBounds) {
  int cells = 0;
  for (const std::string& tree : small_trees)
    for (const int subdivisions : {0, 1}) {
      const char* bark = "N*.2*clamp(p1, 0, scale)*snoise(P/(p1 + .01))";
      const Walk whole = walk_whole(*tree_model(tree, 1, subdivisions, {1u << 20, 1u << 20}, bark));
      const Walk cut = walk_whole(*tree_model(tree, 1, subdivisions, {16, 16}, bark));
      EXPECT_EQ(whole.outside, 0) << tree;
      EXPECT_EQ(cut.outside, 0) << tree;
      EXPECT_TRUE(whole.surface == cut.surface) << tree << subdivisions;
      EXPECT_GE(cut.cells, whole.cells);
      cells += cut.cells;
    }
  EXPECT_GT(cells, 500);
}

TEST(WeberPennStep, BoundsOfIndividualsContainAndAreClose) {
  for (const PlantSpecies& species : plant_species()) {
    if (expected_children(species.parameters, 3) > 100) continue;  // a willow takes a second
    double box = 0, rough = 0, real = 0;
    const auto model = tree_model(fmt::format(R"("species": "{}")", species.name), 0, 1);
    for (const double footprint : {0.3, 2.0, 20.0}) {
      const ConstantFootprint seen(footprint);
      for (Key individual = 1; individual < 3; ++individual) {
        const Walk tree = walk_whole(*model, &seen, individual);
        EXPECT_EQ(tree.outside, 0) << species.name << " " << footprint;
        if (footprint > 1) continue;
        const Bounds3f of_branches = model_bounds(*model, &seen, individual, 2);
        EXPECT_TRUE(of_branches.contains(tree.bounds)) << species.name;
        box += half_area(model_bounds(*model, &seen, individual, model->levels()));
        rough += half_area(of_branches);
        real += half_area(tree.bounds);
      }
    }
    EXPECT_LT(box, 1.5 * real) << species.name;
    EXPECT_LT(rough, 8 * real) << species.name;  // a weeping willow; others less than 3
  }
}

TEST(WeberPennStep, PlacementReadsTheRadiusOfTheStem) {
  const std::string pole =
      R"("levels": 1, "leaves": 0, "scale_v": 0, "curve_v": [0], "bend_v": [0], "curve_res": [10])";
  const auto smooth = tree_model(pole, 0, 1), moved = tree_model(pole, 0, 1, {}, "[0, 0, clamp(p1, 0, 1)]");
  const Mesh before = grown(*smooth, 2), after = grown(*moved, 2);
  ASSERT_EQ(before.vertex_count(), after.vertex_count());
  for (std::uint32_t v = 0; v < before.vertex_count(); ++v) {
    const Vec3d offset = after.positions[v] - before.positions[v];
    const double z = std::clamp(before.positions[v].y / 13, 0.0, 1.0);
    // The cone's radius, here or at the next ring above
    EXPECT_LE(offset.z, 0.195 * (1 - z) + 1e-3);
    EXPECT_GE(offset.z, 0.195 * (1 - z) - 0.05);
    EXPECT_NEAR(length(offset), offset.z, 1e-6);
  }
}

TEST(WeberPennStep, BoundsOfAStepContainWhatItMakes) {
  for (const std::string& tree : small_trees)
    for (Key seed = 0; seed < 6; ++seed) {
      const auto model = tree_model(tree, seed);
      Extent bound = extent_of(model->base().mesh);
      for (int level = 0; level < model->levels(); ++level) {
        bound = model->step(level).bound(bound);
        const Extent truth = extent_of(grown(*model, level + 1));
        ASSERT_TRUE(bound.box.contains(truth.box)) << tree << seed << " " << level;
        ASSERT_GE(bound.edge, truth.edge) << tree << seed << " " << level;
        ASSERT_LE(bound.u.lower, truth.u.lower);
        ASSERT_GE(bound.u.upper, truth.u.upper);
        ASSERT_LE(bound.v.lower, truth.v.lower);
        ASSERT_GE(bound.v.upper, truth.v.upper);
        for (const SymbolRange& t : truth.symbols)
          for (const SymbolRange& b : bound.symbols) {
            if (b.symbol != t.symbol) continue;
            ASSERT_GE(b.radius, t.radius);
            for (int i : {0, 1}) {
              ASSERT_LE(b.parameters[std::size_t(i)].lower, t.parameters[std::size_t(i)].lower);
              ASSERT_GE(b.parameters[std::size_t(i)].upper, t.parameters[std::size_t(i)].upper);
            }
          }
      }
    }
}

}  // namespace
}  // namespace meristem::test
