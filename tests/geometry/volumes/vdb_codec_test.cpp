// Files and level sets through OpenVDB.
#include "geometry/volumes/vdb_codec.h"

#include "geometry/base/parallel.h"
#include "geometry/volumes/brick_grid.h"
#include "tests/geometry/volumes/function_voxels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <unistd.h>

namespace meristem {
namespace {

using test::FunctionVoxels;

class VdbFile : public testing::Test {
 protected:
  VdbFile() : path_(std::filesystem::temp_directory_path() / ("meristem_" + std::to_string(::getpid()) + ".vdb")) {}
  ~VdbFile() override { std::filesystem::remove(path_); }
  void write(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }
  std::string error(const std::string& path, const std::string& grid = "") {
    try {
      vdb_codec().read(path, grid);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }
  std::filesystem::path path_;
};

TEST_F(VdbFile, KeepsSamplesAndTransform) {
  FunctionVoxels voxels({-3, 0, 2}, {17, 8, 9},
                        [](int x, int y, int z) { return float(x * 100 + y * 10 + z) * 0.125f; });
  voxels.background = 7;
  voxels.world_from_index = Affine3d::translation({0.5, 0, 0}) * Affine3d::scaling({0.1, 0.1, 0.1});
  write(vdb_codec().encode(voxels, "heat", GridClass::Fog));
  const BrickGrid before(voxels), after(*vdb_codec().read(path_.string(), "heat"));
  for (int i = 0; i < 1000; ++i) {
    const Vec3f p(voxels.world_from_index.point({-5 + (i % 10) * 2.7, (i / 10 % 10) * 1.1, (i / 100) * 1.3}));
    ASSERT_EQ(before.value(p), after.value(p));
  }
  EXPECT_EQ(after.value({9, 9, 9}), 7);
}

TEST_F(VdbFile, IsReadWithErrorsInWords) {
  EXPECT_EQ(error("/nowhere/none.vdb"), "there is no such file");
  EXPECT_EQ(error("/"), "it is not a regular file");
  write("not a volume at all, just text");
  EXPECT_NE(error(path_.string()), "");
  const FunctionVoxels voxels({0, 0, 0}, {3, 3, 3}, [](int, int, int) { return 1.0f; });
  const std::string bytes = vdb_codec().encode(voxels, "density", GridClass::Fog);
  write(bytes);
  EXPECT_EQ(error(path_.string(), "heat"), "it holds no grid named \"heat\"; there are: density");
  EXPECT_EQ(error(path_.string()), "");
  for (std::size_t eighth = 0; eighth < 8; ++eighth) {
    const std::size_t end = bytes.size() * eighth / 8;
    write(bytes.substr(0, end));
    EXPECT_NE(error(path_.string()), "") << end;
    EXPECT_LT(error(path_.string()).size(), 300u) << end;
  }
}

// A box of 2 x 2 x 2 around the origin.
std::vector<Vec3f> box_vertices() {
  std::vector<Vec3f> v;
  for (int i = 0; i < 8; ++i) v.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
  return v;
}
const std::vector<std::array<std::uint32_t, 3>> box_triangles{{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                                              {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                              {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};

TEST(LevelSet, IsTheSignedDistance) {
  const BrickGrid grid(*vdb_codec().level_set(box_vertices(), box_triangles, 0.05, 8));
  for (int i = 0; i < 2000; ++i) {
    const Vec3f p{-1.35f + 0.3f * float(i % 10), -1.35f + 0.3f * float(i / 10 % 10), -1.35f + 0.135f * float(i / 100)};
    const Vec3d q = abs(Vec3d(p)) - Vec3d(1.0);
    const Vec3d outer = max(q, Vec3d(0.0));
    const double distance = length(outer) + std::min(max_component(q), 0.0);
    ASSERT_NEAR(grid.value(p), std::clamp(distance, -0.4, 0.4), 0.02) << p.x << ' ' << p.y << ' ' << p.z;
  }
  EXPECT_NEAR(grid.gradient({1.1f, 0, 0}).x, 1, 1e-3);
}

TEST(LevelSet, HasTheSameBitsAtEveryCall) {
  std::vector<float> values[2];
  for (auto& list : values) {
    std::unique_ptr<VoxelSource> made;
    run_isolated([&] { made = vdb_codec().level_set(box_vertices(), box_triangles, 0.07, 4); });
    const BrickGrid grid(*made);
    for (int i = 0; i < 3000; ++i)
      list.push_back(grid.value(
          {-1.2f + 0.16f * float(i % 15), -1.2f + 0.16f * float(i / 15 % 15), -1.2f + 0.2f * float(i / 225)}));
  }
  EXPECT_EQ(values[0], values[1]);
}

}  // namespace
}  // namespace meristem
