// What thins far away: how much of it there is, how large it is, and what remains.
#include "geometry/cells/thinning.h"

#include "geometry/cells/expansion.h"
#include "tests/procedural/growth/derivation.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace meristem::test {
namespace {

constexpr double rows = 80;

// A field of 6,400 faces, on each of which something grows.
struct Field {
  std::shared_ptr<const Model> model;
  int symbol;  // of the faces that count

  Field(const std::vector<std::string>& steps, const std::string& counted) {
    Derivation d(R"json({"type": "plane", "width": 8, "depth": 8, "columns": 80, "rows": 80, "face": "bud"})json",
                 steps);
    EXPECT_EQ(d.messages(), std::vector<std::string>{});
    symbol = d.symbols->find(counted);
    std::vector<std::unique_ptr<Step>> own;
    for (auto& step : d.steps) own.push_back(std::move(step));
    model = std::make_shared<const Model>("field", d.base, std::move(own));
  }
};

const std::string leaves = R"json({"grow": 1, "thinning": {"bud": 4}, "rules": {"bud": {"template": "leaf",
    "length": "0.1 + 0.1*rand()", "width": 0.08, "stalk": 0.02, "bend": 40, "faces": {"blade": "green"}}}})json";
const std::vector<std::string> clusters{
    R"json({"grow": 1, "thinning": {"bud": 4}, "rules": {"bud": {"template": "extrude",
    "inset": 0.8, "height": "radius*.2", "faces": {"cap": "spine"}}}})json",
    R"json({"grow": 1, "rules": {"spine": {"template": "spike", "length": 0.2,
    "bend": "30*rand()", "bend_direction": "360*rand()", "faces": {"side": "green"}}}})json"};

struct Seen {
  double area = 0;           // of the faces that count
  std::set<Key> grown_from;  // the keys of their origins
};

void look(const Field& field, CellMesh cell, int level, Seen& seen) {
  const Expansion e = expand(*field.model, std::move(cell), level);
  for (std::size_t i = 0; e.inner && i < e.inner->child_count(); ++i)
    look(field, child_cell(*field.model, *e.inner, i), e.inner->level, seen);
  if (!e.leaf) return;
  for_each_triangle(*e.leaf, [&](const std::array<std::uint32_t, 3>& t, std::uint32_t origin) {
    if (e.leaf->origins[origin].symbol != field.symbol) return;
    const auto p = [&](int i) { return Vec3d(e.leaf->positions[t[std::size_t(i)]]); };
    seen.area += 0.5 * length(cross(p(1) - p(0), p(2) - p(0)));
    seen.grown_from.insert(e.leaf->origins[origin].key);
  });
}

Seen look_at(const Field& field, const Footprint* footprint) {
  Seen seen;
  look(field, root_cell(*field.model, footprint), 0, seen);
  return seen;
}

// How large a bud is: its radius, and how far anything on it may reach whatever its random numbers.
double size_of_bud(const Model& model) {
  const Mesh& mesh = model.base().mesh;
  Bounds3d face;
  for (std::uint32_t v : mesh.corners(0)) face.extend(mesh.positions[v]);
  const double radius = 0.5 * face.diagonal();
  return radius + model.growth_reach(mesh.origins[mesh.face_origins[0]], face, radius, 0);
}

void expect_thinning(const Field& field) {
  const double size = size_of_bud(*field.model);
  const Seen full = look_at(field, nullptr);
  std::set<Key> more = full.grown_from;
  for (double pixels : {6.0, 3.0, 2.0, 1.0, 0.6}) {
    const ConstantFootprint footprint(size / pixels);
    const Seen seen = look_at(field, &footprint);
    EXPECT_TRUE(std::ranges::includes(more, seen.grown_from)) << pixels;
    const double share = double(seen.grown_from.size()) / double(full.grown_from.size());
    EXPECT_NEAR(share, std::min(pixels * pixels / 12, 1.0), 0.02 + 0.05 * share) << pixels;
    const double deviation = std::sqrt((1 - share) / (share * rows * rows));
    EXPECT_NEAR(seen.area / full.area, 1, 0.002 + 3.5 * deviation) << pixels;
    more = seen.grown_from;
  }
}

TEST(GrowthThinning, LeavesKeepTheirArea) { expect_thinning(Field({leaves}, "green")); }

TEST(GrowthThinning, WhatGrowsOnThemIsEnlargedWithThem) { expect_thinning(Field(clusters, "green")); }

TEST(GrowthThinning, AFieldAsSmallAsAnythingIsNotGrown) {
  const Field field({leaves}, "green");
  const ConstantFootprint huge(50);
  EXPECT_EQ(look_at(field, &huge).grown_from.size(), 0u);
}

TEST(GrowthReach, IsMoreThanEnoughExactlyWhereTheWholeIs) {
  const Field field(clusters, "green");
  const Mesh& mesh = field.model->base().mesh;
  Bounds3d face;
  for (std::uint32_t v : mesh.corners(0)) face.extend(mesh.positions[v]);
  const auto reach = [&](double enough) {
    return field.model->growth_reach(mesh.origins[mesh.face_origins[0]], face, 0.5 * face.diagonal(), 0, enough);
  };
  const double whole = reach(INFINITY);
  EXPECT_GT(whole, 0);
  for (double share : {0.0, 0.3, 0.7, 0.999}) EXPECT_GT(reach(share * whole), share * whole) << share;
  for (double share : {1.001, 2.0}) EXPECT_EQ(reach(share * whole), whole) << share;
}

TEST(GrowthThinning, MistakesAreNamed) {
  const auto messages = [](const std::string& thinning) {
    return Derivation(R"json({ "type": "box" })json",
                      {R"({ "grow": 1, "thinning": )" + thinning +
                       R"(, "rules": { "leaf": { "template": "leaf" }, "bud": { "template": "box" } } })"})
        .messages();
  };
  using Messages = std::vector<std::string>;
  EXPECT_EQ(messages(R"({ "leaf": 4, "bud": 0.5 })"), Messages{});
  EXPECT_EQ(messages("4"), (Messages{"1:26 expected an object: symbols and sizes in pixels, such as { \"leaf\": 4 }; "
                                     "found a number"}));
  EXPECT_EQ(messages(R"({ "leef": 4 })"),
            (Messages{"1:28 this step has no rule for a symbol \"leef\"; did you mean \"leaf\"?; known: leaf, bud"}));
  EXPECT_EQ(messages(R"({ "leaf": 0 })"),
            (Messages{"1:36 \"leaf\" thins below a size in pixels above 0 and at most 64"}));
  EXPECT_EQ(messages(R"({ "leaf": "4" })"),
            (Messages{"1:36 \"leaf\" thins below a size in pixels above 0 and at most 64"}));
}

}  // namespace
}  // namespace meristem::test
