// What grows in a cell stays in the bounds that its parent had foretold.
#include "geometry/cells/expansion.h"
#include "tests/renderer/loading/branch_scene.h"
#include "tests/support/point_footprint.h"

#include <gtest/gtest.h>

namespace meristem {
namespace {

struct Count {
  int cells = 0, outside = 0;
};

void check_cells(const Model& model, CellMesh cell, int level, const Bounds3f& bounds, Count& count) {
  ++count.cells;
  const Expansion e = expand(model, std::move(cell), level);
  if (e.leaf) {
    count.outside += !bounds.contains(e.leaf->bounds());
    return;
  }
  for (std::size_t i = 0; i < e.inner->child_count(); ++i)
    check_cells(model, child_cell(model, *e.inner, i), e.inner->level, e.inner->child_bounds[i], count);
}

TEST(Bounds, ContainWhatIsGrownAndDisplaced) {
  Count count;
  for (const char* place : {"[0, 0, 0]", "scale*N*.42*abs(sin(6*PI*u + .8*snoise(3*P)))", "scale*N*fbm(4*P)",
                            "scale*(T*.3 + N)*(2*rand() - 1)", "[.1*sin(9*P[1]), -.05, .1*noise(5*P)]"})
    for (int seed : {0, 1})
      for (const CellSettings cells : {CellSettings{16, 64}, CellSettings{64, 16}}) {
        const auto model = model_of(branch_text(place), seed, cells);
        const Count before = count;
        check_cells(*model, root_cell(*model), 0, model_bounds(*model), count);
        EXPECT_EQ(count.outside, before.outside) << place << ", seed " << seed;
      }
  EXPECT_GT(count.cells, 10000);
  RecordProperty("cells", count.cells);
}

// What is fine enough before others have grown stays where it was, while the surface around it moves on.
TEST(Bounds, ContainWhatStaysOnAnEarlierLevelWhileOthersGrow) {
  const std::string text = R"json({
    "base": { "type": "prism", "sides": 24, "ridges": 6, "radius": 0.19, "height": 0.1, "cap": "bud",
      "side": "skin" },
    "steps": [
      { "grow": 3, "rules": { "bud": { "template": "segment", "length": 0.3,
          "faces": { "cap": "bud", "side": "skin" } } } },
      { "subdivide": 1 },
      { "subdivide": 1, "place": ".9*scale*N*(3*abs(u - .5))^1.5" },
      { "grow": 1, "rules": { "skin": { "if": "rand() < .3", "template": "extrude", "inset": 0.7, "height": "radius*.2",
          "faces": { "cap": "spine" } } } },
      { "grow": 1, "rules": { "spine": { "template": "spike", "length": ".1*rand()", "bend": 35 } } },
      { "subdivide": 2 } ] })json";
  Count count;
  for (double pixel = 0.4; pixel > 0.05; pixel *= 0.8)
    for (const int seed : {0, 1}) {
      const auto model = model_of(text, seed, CellSettings{});
      const PointFootprint footprint({0.5, 0.4, 0.5}, pixel);
      const Count before = count;
      check_cells(*model, root_cell(*model, &footprint), 0, model_bounds(*model), count);
      EXPECT_EQ(count.outside, before.outside) << pixel << ", seed " << seed;
    }
  EXPECT_GT(count.cells, 100);
}

}  // namespace
}  // namespace meristem
