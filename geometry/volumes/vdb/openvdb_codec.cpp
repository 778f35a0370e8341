// The codec of vdb_codec.h upon OpenVDB: the one place that includes it.
#include "geometry/volumes/vdb_codec.h"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <sstream>
#include <stdexcept>

namespace meristem {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_file_bytes = std::uintmax_t(4) << 30;

openvdb::Coord coord(VoxelIndex i) { return {i[0], i[1], i[2]}; }

// OpenVDB's matrices act on rows.
Affine3d affine_of(const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) throw std::runtime_error("its transform is not linear (a frustum)");
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  auto line = [&](int i) { return Vec3d(m(i, 0), m(i, 1), m(i, 2)); };
  return {line(0), line(1), line(2), line(3)};
}

class OpenVdbSource final : public VoxelSource {
 public:
  explicit OpenVdbSource(openvdb::FloatGrid::ConstPtr grid) : grid_(std::move(grid)), accessor_(grid_->tree()) {
    world_from_index = affine_of(grid_->transform());
    background = grid_->background();
    const openvdb::CoordBBox box = grid_->evalActiveVoxelBoundingBox();
    if (box.empty()) return;
    lower = {box.min().x(), box.min().y(), box.min().z()};
    upper = {box.max().x(), box.max().y(), box.max().z()};
  }

  void read_block(VoxelIndex origin, float* out) const override {
    for (int x = 0; x < row; ++x)
      for (int y = 0; y < row; ++y)
        for (int z = 0; z < row; ++z) *out++ = accessor_.getValue(coord(origin).offsetBy(x, y, z));
  }

  bool is_constant(VoxelIndex origin, float& value) const override {
    value = accessor_.getValue(coord(origin));
    for (int i = 0; i < 8; ++i) {
      const openvdb::Coord corner =
          coord(origin).offsetBy(i & 1 ? block_side : 0, i & 2 ? block_side : 0, i & 4 ? block_side : 0);
      if (accessor_.probeConstLeaf(corner) || accessor_.getValue(corner) != value) return false;
    }
    return true;
  }

 private:
  openvdb::FloatGrid::ConstPtr grid_;
  mutable openvdb::FloatGrid::ConstAccessor accessor_;
};

// OpenVDB quotes what it read, and of a broken file that may be anything: a name of half a gigabyte, too.
std::string shortened(std::string text) {
  constexpr std::size_t most = 200;
  std::erase_if(text,
                [](char c) { return static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~'; });
  const auto [end, last] = std::ranges::unique(text, [](char a, char b) { return a == ' ' && b == ' '; });
  text.erase(end, last);
  return text.size() <= most ? text : text.substr(0, most) + "...; the file seems to be damaged";
}

// The same failures with a reason in words; OpenVDB's own exceptions begin with their class.
template <class Function>
auto with_plain_errors(const Function& f) {
  try {
    return f();
  } catch (const openvdb::Exception& error) {
    const std::string text = error.what();
    const std::size_t colon = text.find(": ");
    throw std::runtime_error(shortened(colon == text.npos ? text : text.substr(colon + 2)));
  } catch (const std::bad_alloc&) {
    throw std::runtime_error("it asks for more memory than there is; the file seems to be damaged");
  }
}

void check_file(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw std::runtime_error("there is no such file");
  if (!fs::is_regular_file(status)) throw std::runtime_error("it is not a regular file");
  if (const std::uintmax_t bytes = fs::file_size(path); bytes > max_file_bytes)
    throw std::runtime_error(fmt::format("it has {} MiB; the limit is {} MiB", bytes >> 20, max_file_bytes >> 20));
}

std::string pick_grid(openvdb::io::File& file, const std::string& wanted) {
  std::vector<std::string> names;
  for (auto name = file.beginName(); name != file.endName(); ++name) names.push_back(*name);
  if (names.empty()) throw std::runtime_error("it holds no grid");
  if (wanted.empty()) return names.front();
  if (std::ranges::find(names, wanted) == names.end())
    throw std::runtime_error(
        fmt::format("it holds no grid named \"{}\"; there are: {}", wanted, fmt::join(names, ", ")));
  return wanted;
}

// Leaves come with their masks; their samples are read later, when they are asked for. So the number of leaves is
// bounded by the size of the file, and known before memory is taken for samples.
openvdb::FloatGrid::ConstPtr read_grid(const std::string& path, const std::string& wanted) {
  openvdb::io::File file(path);
  file.setCopyMaxBytes(0);
  file.open(/*delayLoad=*/true);
  const std::string name = pick_grid(file, wanted);
  const openvdb::GridBase::Ptr metadata = file.readGridMetadata(name);
  if (!metadata->isType<openvdb::FloatGrid>())
    throw std::runtime_error(
        fmt::format("its grid \"{}\" holds {}; only floats can be read", name, metadata->valueType()));
  const auto grid = openvdb::gridConstPtrCast<openvdb::FloatGrid>(file.readGrid(name));
  if (const auto leaves = grid->tree().leafCount(); leaves > VoxelSource::max_uneven_blocks)
    throw std::runtime_error(
        fmt::format("its grid \"{}\" has {} leaves; the limit is {}", name, leaves, VoxelSource::max_uneven_blocks));
  return grid;
}

// A mesh as MeshToVolume reads it: in index space.
class MeshAdapter {
 public:
  MeshAdapter(std::span<const Vec3f> vertices, std::span<const std::array<std::uint32_t, 3>> triangles, double spacing)
      : vertices_(vertices), triangles_(triangles), spacing_(spacing) {}
  std::size_t polygonCount() const { return triangles_.size(); }
  std::size_t pointCount() const { return vertices_.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t polygon, std::size_t corner, openvdb::Vec3d& place) const {
    const Vec3f& p = vertices_[triangles_[polygon][corner]];
    place = openvdb::Vec3d(double(p.x), double(p.y), double(p.z)) / spacing_;
  }

 private:
  std::span<const Vec3f> vertices_;
  std::span<const std::array<std::uint32_t, 3>> triangles_;
  double spacing_;
};

openvdb::FloatGrid::Ptr grid_of(const VoxelSource& voxels, GridClass grid_class) {
  auto grid = openvdb::FloatGrid::create(voxels.background);
  const Affine3d& m = voxels.world_from_index;
  grid->setTransform(openvdb::math::Transform::createLinearTransform(
      openvdb::Mat4d(m.x.x, m.x.y, m.x.z, 0.0, m.y.x, m.y.y, m.y.z, 0.0, m.z.x, m.z.y, m.z.z, 0.0, m.origin.x,
                     m.origin.y, m.origin.z, 1.0)));
  grid->setGridClass(grid_class == GridClass::LevelSet ? openvdb::GRID_LEVEL_SET : openvdb::GRID_FOG_VOLUME);
  auto accessor = grid->getAccessor();
  std::array<float, VoxelSource::block_values> block;
  constexpr int side = VoxelSource::block_side, row = VoxelSource::row;
  for (int bx = voxels.lower[0]; bx <= voxels.upper[0]; bx += side)
    for (int by = voxels.lower[1]; by <= voxels.upper[1]; by += side)
      for (int bz = voxels.lower[2]; bz <= voxels.upper[2]; bz += side) {
        if (float value = 0; voxels.is_constant({bx, by, bz}, value) && value == voxels.background) continue;
        voxels.read_block({bx, by, bz}, block.data());
        for (int x = bx; x < bx + side && x <= voxels.upper[0]; ++x)
          for (int y = by; y < by + side && y <= voxels.upper[1]; ++y)
            for (int z = bz; z < bz + side && z <= voxels.upper[2]; ++z)
              if (const float v = block[std::size_t(((x - bx) * row + y - by) * row + z - bz)]; v != voxels.background)
                accessor.setValue({x, y, z}, v);
      }
  grid->pruneGrid();
  return grid;
}

class OpenVdbCodec final : public VdbCodec {
 public:
  OpenVdbCodec() { openvdb::initialize(); }

  std::unique_ptr<VoxelSource> read(const std::string& path, const std::string& grid) const override {
    check_file(path);
    return with_plain_errors([&] { return std::make_unique<OpenVdbSource>(read_grid(path, grid)); });
  }

  std::unique_ptr<VoxelSource> level_set(std::span<const Vec3f> vertices,
                                         std::span<const std::array<std::uint32_t, 3>> triangles, double spacing,
                                         double band) const override {
    return with_plain_errors([&] {
      const auto transform = openvdb::math::Transform::createLinearTransform(spacing);
      auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(MeshAdapter(vertices, triangles, spacing),
                                                                   *transform, float(band), float(band));
      return std::make_unique<OpenVdbSource>(grid);
    });
  }

  std::string encode(const VoxelSource& voxels, const std::string& grid, GridClass grid_class) const override {
    return with_plain_errors([&] {
      const openvdb::FloatGrid::Ptr made = grid_of(voxels, grid_class);
      made->setName(grid);
      std::ostringstream out(std::ios::binary);
      openvdb::io::Stream(out).write(openvdb::GridCPtrVec{made});
      return out.str();
    });
  }
};

}  // namespace
}  // namespace meristem

extern "C" const meristem::VdbCodec* meristem_vdb_codec() {
  static const meristem::OpenVdbCodec codec;
  return &codec;
}
