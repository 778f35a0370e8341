// What grows in a cell stays in the bounds that its parent had foretold.
#include "geometry/cells/expansion.h"
#include "tests/renderer/loading/branch_scene.h"

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

}  // namespace
}  // namespace meristem
