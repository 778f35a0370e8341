#include "tests/procedural/growth/random_rules.h"

#include "geometry/cells/extract.h"

#include <gtest/gtest.h>

#include <tuple>

namespace meristem::test {
namespace {

const std::string stem =
    R"json({ "grow": 3, "rules": { "shoot(len)": { "template": "segment", "length": "len", "faces": {
    "cap": "shoot(len*0.5)" } } } })json";

TEST(GrowStep, ReplacesTheCapByASegmentEachStep) {
  const Derivation d(octagon, {stem});
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  ASSERT_EQ(d.steps.size(), 3u);
  for (std::size_t i = 0; i <= 3; ++i) {
    const Mesh mesh = d.grown(i).mesh;
    EXPECT_EQ(mesh.face_count(), 10 + 8 * i);
    EXPECT_EQ(mesh.vertex_count(), 16 + 8 * i);
    const auto caps = faces_with(mesh, d.symbols->find("shoot"));
    ASSERT_EQ(caps.size(), 1u);
    EXPECT_EQ(mesh.origins[mesh.face_origins[caps[0]]].parameters[0], std::pow(0.5f, float(i)));
    // 1 + 1 + 1/2 + 1/4
    EXPECT_NEAR(face_frame(mesh, caps[0]).origin.y, 3 - std::pow(0.5, double(i) - 1), 1e-8);
  }
}

TEST(GrowStep, KeepsFacesWithoutProductionAsTheyAre) {
  const Derivation d(octagon, {stem});
  const Mesh after = d.grown(1).mesh;
  std::map<Key, std::uint32_t> by_key;
  for (std::uint32_t f = 0; f < after.face_count(); ++f) by_key[after.face_keys[f]] = f;
  int kept = 0;
  for (std::uint32_t f = 0; f < d.base.face_count(); ++f) {
    const auto found = by_key.find(d.base.face_keys[f]);
    if (found == by_key.end()) continue;
    ++kept;
    EXPECT_EQ(after.origins[after.face_origins[found->second]], d.base.origins[d.base.face_origins[f]]);
    for (std::uint32_t c = 0; c < d.base.corner_count(f); ++c)
      EXPECT_EQ(after.positions[after.corners(found->second)[c]], d.base.positions[d.base.corners(f)[c]]);
  }
  EXPECT_EQ(kept, 9);
}

TEST(GrowStep, KeysAreDistinct) {
  const Derivation d(octagon, {stem, stem});
  const Mesh mesh = d.grown();
  EXPECT_EQ(std::set<Key>(mesh.face_keys.begin(), mesh.face_keys.end()).size(), mesh.face_count());
  EXPECT_EQ(std::set<Key>(mesh.vertex_keys.begin(), mesh.vertex_keys.end()).size(), mesh.vertex_count());
}

TEST(GrowStep, ConditionsDecide) {
  const Derivation d(
      octagon, {R"json({ "grow": 4, "rules": { "shoot(len)": { "if": "len > 0.3", "template": "segment", "faces": {
    "cap": "shoot(len*0.5)" } } } })json"});
  EXPECT_EQ(d.grown(2).mesh.face_count(), 26u);  // 1, 0.5
  EXPECT_EQ(d.grown(4).mesh.face_count(), 26u);  // 0.25 stays
}

TEST(GrowStep, WeightsAreChancesAndSeedsDraw) {
  const std::string plane = R"json({ "type": "plane", "columns": 100, "rows": 100, "face": "x" })json";
  const std::string rules =
      R"json({ "grow": 1, "rules": { "x": [ { "weight": 3, "template": "spike", "faces": { "side": "one" } },
    { "weight": 1, "template": "spike", "faces": { "side": "two" } }, { "weight": 0, "template": "spike", "faces": {
    "side": "three" } } ] } })json";
  const auto count = [&](Key seed, const char* symbol) {
    const Derivation d(plane, {rules}, seed);
    return double(faces_with(d.grown(), d.symbols->find(symbol)).size()) / 4;
  };
  // 10,000 draws: the standard deviation is 43
  EXPECT_NEAR(count(1, "one"), 7500, 5 * 43);
  EXPECT_NEAR(count(2, "one"), 7500, 5 * 43);
  EXPECT_NE(count(1, "one"), count(2, "one"));
  EXPECT_EQ(count(1, "one") + count(1, "two"), 10000);
  EXPECT_EQ(count(1, "three"), 0);
}

TEST(GrowStep, RandomNumbersOfOneRuleAreIndependent) {
  const Derivation d(R"json({ "type": "plane", "columns": 50, "rows": 50, "face": "x" })json",
                     {R"json({ "grow": 1, "rules": { "x": { "template": "box", "height": "rand()", "faces": {
    "top": "y(rand(), rand())" } } } })json"});
  const Mesh mesh = d.grown();
  double sum = 0, products = 0, heights = 0;
  const auto tops = faces_with(mesh, d.symbols->find("y"));
  ASSERT_EQ(tops.size(), 2500u);
  for (std::uint32_t f : tops) {
    const auto& p = mesh.origins[mesh.face_origins[f]].parameters;
    sum += p[0];
    products += (p[0] - 0.5) * (p[1] - 0.5);
    heights += (p[0] - 0.5) * (face_frame(mesh, f).origin.y - 0.5);
  }
  EXPECT_NEAR(sum / 2500, 0.5, 5 * 0.29 / 50);
  EXPECT_NEAR(products / 2500, 0, 5 * 0.083 / 50);  // the variance of a uniform number is 1/12
  EXPECT_NEAR(heights / 2500, 0, 5 * 0.083 / 50);
}

TEST(GrowStep, MaterialAndCreaseGoToTheNewFacesAlone) {
  const Derivation d(octagon, {R"json({ "grow": 1, "rules": { "shoot(l)": { "template": "segment", "material": "bark",
    "crease": 3 } } })json"});
  const Mesh mesh = d.grown();
  ASSERT_EQ(mesh.corner_sharpness.size(), mesh.corner_vertices.size());
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const bool is_new =
        std::find(d.base.face_keys.begin(), d.base.face_keys.end(), mesh.face_keys[f]) == d.base.face_keys.end();
    EXPECT_EQ(mesh.origins[mesh.face_origins[f]].material, is_new ? 4 : -1);  // the length of "bark"
    for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
      const std::uint32_t next = c + 1 < mesh.face_starts[f + 1] ? c + 1 : mesh.face_starts[f];
      const bool on_cap =
          mesh.positions[mesh.corner_vertices[c]].y > 1.5 || mesh.positions[mesh.corner_vertices[next]].y > 1.5;
      EXPECT_EQ(mesh.corner_sharpness[c], is_new && on_cap ? 3 : 0);
    }
  }
}

// The sharpness of every edge, if both its faces agree.
void expect_sharpness_agrees(const Mesh& mesh) {
  if (mesh.corner_sharpness.empty()) return;
  std::map<std::pair<std::uint32_t, std::uint32_t>, float> edges;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = mesh.corners(f);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const float sharpness = mesh.corner_sharpness[mesh.face_starts[f] + i];
      const auto [entry, is_new] =
          edges.try_emplace(std::minmax(corners[i], corners[(i + 1) % corners.size()]), sharpness);
      ASSERT_EQ(entry->second, sharpness);
    }
  }
}

// Closed but for leaves, whose blades have borders.
TEST(GrowStep, WhateverTheRulesAClosedManifoldStaysOne) {
  int grown_meshes = 0;
  for (Key seed = 0; seed < 150; ++seed) {
    RandomRules rules(seed);
    const std::string base = rules.base(), steps = rules.steps(3);
    const Derivation d(base, {steps}, seed);
    ASSERT_EQ(d.messages(), std::vector<std::string>{}) << base << steps;
    const Mesh mesh = d.grown();
    ASSERT_EQ(manifold_defect(mesh), "") << base << steps;
    const bool closed = is_closed(mesh);
    ASSERT_TRUE(closed || steps.find("leaf") != std::string::npos) << base << steps;
    if (closed) {
      ASSERT_EQ(euler_characteristic(mesh), 2) << base << steps;
    }
    ASSERT_EQ(mesh.corner_uv.size(), mesh.corner_vertices.size());
    for (Vec3d p : mesh.positions) ASSERT_EQ(p, d.quantum.round(p));
    expect_sharpness_agrees(mesh);
    grown_meshes += mesh.face_count() > d.base.face_count();
  }
  EXPECT_GT(grown_meshes, 120);
}

// All that is told of a face, by keys and values, without indices.
using FaceRecord = std::tuple<std::vector<Key>, std::vector<double>, std::vector<float>, Key, int, int,
                              std::array<float, max_growth_parameters>>;

FaceRecord record(const Mesh& mesh, std::uint32_t f) {
  FaceRecord r;
  const FaceOrigin& origin = mesh.origins[mesh.face_origins[f]];
  for (std::uint32_t c = mesh.face_starts[f]; c < mesh.face_starts[f + 1]; ++c) {
    const std::uint32_t v = mesh.corner_vertices[c];
    const Vec3d p = mesh.positions[v];
    const Vec2d uv = mesh.corner_uv.empty() ? mesh.uv[v] : mesh.corner_uv[c];
    std::get<0>(r).push_back(mesh.vertex_keys[v]);
    std::get<1>(r).insert(std::get<1>(r).end(), {p.x, p.y, p.z, uv.x, uv.y});
    if (!mesh.corner_sharpness.empty()) std::get<2>(r).push_back(mesh.corner_sharpness[c]);
  }
  std::get<3>(r) = origin.key;
  std::get<4>(r) = origin.symbol;
  std::get<5>(r) = origin.material;
  std::get<6>(r) = origin.parameters;
  return r;
}

std::map<Key, FaceRecord> records(const Mesh& mesh, std::uint32_t count) {
  std::map<Key, FaceRecord> result;
  for (std::uint32_t f = 0; f < count; ++f) result[mesh.face_keys[f]] = record(mesh, f);
  return result;
}

// The face as a cell of its own with a halo of so many rings.
CellMesh single_face_cell(const Mesh& mesh, std::uint32_t face, int rings) {
  std::vector<std::uint32_t> faces{face};
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
    if (f != face) faces.push_back(f);
  CellMesh cell{extract_faces(mesh, faces), 1, {}};
  trim_halo(cell, rings);
  return cell;
}

void expect_same_in_cells(const GrowStep& step, const Mesh& mesh) {
  CellMesh whole;
  step.apply({mesh, mesh.face_count(), std::vector<std::uint8_t>(mesh.face_count(), 0)}, 0, whole);
  const auto truth = records(whole.mesh, whole.mesh.face_count());
  std::size_t owned = 0;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    CellMesh out;
    step.apply(single_face_cell(mesh, f, step.halo_rings(1)), 1, out);
    owned += out.owned_faces;
    for (const auto& [key, face] : records(out.mesh, out.mesh.face_count())) ASSERT_EQ(face, truth.at(key));
  }
  EXPECT_EQ(owned, truth.size());
}

TEST(GrowStep, AFaceGrowsTheSameBitsAloneAndInTheWhole) {
  for (Key seed = 0; seed < 40; ++seed) {
    RandomRules rules(seed + 1000);
    const std::string base = rules.base();
    const Derivation d(base, {rules.steps(2)}, seed);
    const Mesh mesh = d.grown(1).mesh;
    if (mesh.face_count() < 200) expect_same_in_cells(*d.steps[1], mesh);
  }
}

TEST(GrowStep, CountsTheFacesBesideThatMayGrow) {
  const Derivation d(R"json({ "type": "plane", "columns": 3, "rows": 3, "face": "x" })json",
                     {R"json({ "grow": 1, "rules": { "x": { "template": "extrude", "faces": {
    "cap": "y(neighbors)", "wall": "z" } } } })json",
                      R"json({ "grow": 1, "rules": { "y(n)": { "template": "box", "height": "1+neighbors",
    "faces": { "top": "done(neighbors)" } } } })json"});
  EXPECT_EQ(d.messages(), std::vector<std::string>{});
  EXPECT_EQ(d.steps[0]->halo_rings(1), 2);
  const Mesh first = d.grown(1).mesh, second = d.grown(2).mesh;
  std::map<float, int> counts;
  for (std::uint32_t f : faces_with(first, d.symbols->find("y")))
    ++counts[first.origins[first.face_origins[f]].parameters[0]];
  EXPECT_EQ(counts, (std::map<float, int>{{2, 4}, {3, 4}, {4, 1}}));
  for (std::uint32_t f : faces_with(second, d.symbols->find("done")))
    EXPECT_EQ(second.origins[second.face_origins[f]].parameters[0], 0);  // walls have no rules
}

TEST(GrowStep, WithoutNeighborsNoHaloIsSpent) { EXPECT_EQ(Derivation(octagon, {stem}).steps[0]->halo_rings(1), 1); }

TEST(GrowStep, RulesSeeTheDirectionOfLight) {
  const Derivation d(R"json({ "type": "box", "face": "x", "top": "x" })json",
                     {R"json({ "grow": 1, "light": [3, 4, 0], "rules": { "x": { "template": "box", "faces": {
    "top": "y(dot(light, frame_z), length(light))" } } } })json"});
  const Mesh mesh = d.grown();
  const auto tops = faces_with(mesh, d.symbols->find("y"));
  ASSERT_EQ(tops.size(), 1u);
  const auto& p = mesh.origins[mesh.face_origins[tops[0]]].parameters;
  EXPECT_NEAR(p[0], 0.8f, 1e-6f);
  EXPECT_NEAR(p[1], 1, 1e-6f);
}

// After a subdivision u, v are by vertex.
Mesh with_vertex_uv(Mesh mesh) {
  mesh.uv.assign(mesh.vertex_count(), {});
  for (std::size_t c = 0; c < mesh.corner_vertices.size(); ++c) mesh.uv[mesh.corner_vertices[c]] = mesh.corner_uv[c];
  mesh.corner_uv.clear();
  return mesh;
}

TEST(GrowStep, GrowsOnMeshesWithUvByVertex) {
  const Derivation d(octagon, {stem});
  const Mesh before = with_vertex_uv(d.base);
  expect_same_in_cells(*d.steps[0], before);
  CellMesh after;
  d.steps[0]->apply({before, before.face_count(), std::vector<std::uint8_t>(before.face_count(), 0)}, 0, after);
  EXPECT_TRUE(after.mesh.corner_uv.empty());
  ASSERT_EQ(after.mesh.uv.size(), after.mesh.vertex_count());
  for (std::uint32_t v = 0; v < after.mesh.vertex_count(); ++v) {
    EXPECT_NEAR(after.mesh.uv[v].y, after.mesh.positions[v].y, 1e-9);  // v is the height along this stem
    const double angle = std::atan2(-after.mesh.positions[v].z, after.mesh.positions[v].x) / (2 * pi) * 2;
    EXPECT_NEAR(after.mesh.uv[v].x, 1 - std::abs(1 - 2 * (angle - std::floor(angle + 1e-6))), 1e-5);
  }
}

bool contains(Interval outer, Interval inner) {
  return inner.lower > inner.upper || (outer.lower <= inner.lower && outer.upper >= inner.upper);
}

void expect_contains(const Extent& bound, const Extent& truth, const Derivation& d, int step) {
  ASSERT_TRUE(bound.box.contains(truth.box));
  ASSERT_GE(bound.edge, truth.edge);
  ASSERT_TRUE(contains(bound.u, truth.u));
  ASSERT_TRUE(contains(bound.v, truth.v));
  for (const SymbolRange& t : truth.symbols) {
    if (d.symbols->entry(t.symbol).last_rule <= step) continue;
    const auto b = std::find_if(bound.symbols.begin(), bound.symbols.end(),
                                [&](const SymbolRange& r) { return r.symbol == t.symbol; });
    ASSERT_NE(b, bound.symbols.end());
    for (std::size_t i = 0; i < t.parameters.size(); ++i) ASSERT_TRUE(contains(b->parameters[i], t.parameters[i]));
    ASSERT_GE(b->radius * (1 + 1e-6f), t.radius);
  }
}

TEST(GrowStep, BoundsContainWhatGrows) {
  for (Key seed = 0; seed < 2000; ++seed) {
    RandomRules rules(seed + 5000);
    const std::string base = rules.base(), steps = rules.steps(2);
    const Derivation d(base, {steps}, seed);
    SCOPED_TRACE(base + steps);
    Extent bound = extent_of(d.base);
    for (std::size_t i = 0; i < d.steps.size(); ++i) {
      bound = d.steps[i]->bound(bound);
      const CellMesh mesh = d.grown(i + 1);
      if (mesh.mesh.face_count() > 2000) break;
      expect_contains(bound, extent_of(mesh.mesh), d, int(i));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(GrowStep, BoundsAreNotIdle) {
  const Derivation d(octagon,
                     {R"json({ "grow": 1, "rules": { "shoot(l)": { "template": "segment", "length": 2 } } })json"});
  const Extent before = extent_of(d.base), after = d.steps[0]->bound(before);
  EXPECT_LT(after.box.upper.y, before.box.upper.y + 2.25 + 1e-3);
}

TEST(GrowStep, MaxChildrenIsTheLargestTemplate) {
  const Derivation d(
      octagon,
      {R"json({ "grow": 1, "rules": { "shoot(l)": [ { "template": "segment" }, { "template": "fork" } ] } })json"});
  EXPECT_EQ(d.steps[0]->max_children(8), 18u);
  EXPECT_EQ(d.steps[0]->max_children(5), 6u);  // no fork on five corners
}

}  // namespace
}  // namespace meristem::test
