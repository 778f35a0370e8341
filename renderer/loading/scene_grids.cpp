#include "renderer/loading/scene_grids.h"

#include "geometry/base/parallel.h"
#include "geometry/cells/footprint.h"
#include "geometry/cells/shown_surfaces.h"
#include "geometry/fields/time.h"
#include "geometry/volumes/brick_grid.h"
#include "geometry/volumes/vdb_codec.h"
#include "renderer/scene/asset_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace meristem {

namespace {

constexpr Range lengths{1e-6, 1e6, "m"};
constexpr std::size_t max_triangles = std::size_t(1) << 24;
// How fine the mesh is made whose distance is sampled, in samples. A chord of that length lies about as far from its
// arc as linear interpolation between the samples does; a finer mesh costs four times as much and would not be told
// from it.
constexpr double detail_of_samples = 1.5;

const Symbols& place_symbols() {
  static const Symbols symbols = [] {
    Symbols s;
    s.add("P", ValueType::Vector, "position");
    return s;
  }();
  return symbols;
}

// Samples of an expression.
class ExpressionVoxels final : public VoxelSource {
 public:
  ExpressionVoxels(const ValueGridSection& section) : value_(section.value), spacing_(section.spacing) {
    world_from_index = Affine3d::scaling(Vec3d(spacing_));
    for (std::size_t c = 0; c < 3; ++c) {
      lower[c] = int(std::ceil(section.from[int(c)] / spacing_));
      upper[c] = int(std::floor(section.to[int(c)] / spacing_));
    }
  }

  void read_block(VoxelIndex origin, float* out) const override {
    std::array<std::vector<float>, 3> place;
    for (int x = 0; x < row; ++x)
      for (int y = 0; y < row; ++y)
        for (int z = 0; z < row; ++z) {
          place[0].push_back(float((origin[0] + x) * spacing_));
          place[1].push_back(float((origin[1] + y) * spacing_));
          place[2].push_back(float((origin[2] + z) * spacing_));
        }
    const Input p{place[0].data(), place[1].data(), place[2].data(), 1};
    value_->evaluate({int(block_values), {&p, 1}}, out, nullptr, nullptr);
    for (std::size_t i = 0; i < block_values; ++i)
      if (!is_inside(origin, int(i))) out[i] = background;
  }
  bool is_constant(VoxelIndex, float&) const override { return false; }

 private:
  bool is_inside(VoxelIndex origin, int i) const {
    const VoxelIndex at{origin[0] + i / (row * row), origin[1] + i / row % row, origin[2] + i % row};
    bool inside = true;
    for (std::size_t c = 0; c < 3; ++c) inside = inside && at[c] >= lower[c] && at[c] <= upper[c];
    return inside;
  }

  std::shared_ptr<const Expression> value_;
  double spacing_;
};

// The triangles of everything that a part shows, its faces about as large as `detail`.
struct PartTriangles {
  PartTriangles(const std::shared_ptr<const Part>& part, double detail) {
    const auto footprint = std::make_shared<const ConstantFootprint>(detail);
    for (const ShownSurface& surface : shown_surfaces({Placement{part, {}}}, footprint, max_triangles))
      for_each_tessellation(surface, [&](const Tessellation& cell, double) {
        for (const Affine3d& place : surface.places) add(cell, place);
      });
    put_in_order();
  }

  void add(const Tessellation& cell, const Affine3d& place) {
    const auto first = std::uint32_t(vertices.size());
    for (Vec3f p : cell.positions) vertices.push_back(Vec3f(place.point(Vec3d(p))));
    for_each_triangle(cell, [&](const std::array<std::uint32_t, 3>& corners, std::uint32_t) {
      triangles.push_back({first + corners[0], first + corners[1], first + corners[2]});
    });
    if (triangles.size() > max_triangles)
      throw std::runtime_error(
          fmt::format("it has more than {} million triangles at this spacing", max_triangles >> 20));
  }

  // By where they lie, without those that have no extent: samples are rounded, and must not tell how the part was cut
  // into cells.
  void put_in_order() {
    const auto place = [&](std::uint32_t v) { return std::array{vertices[v].x, vertices[v].y, vertices[v].z}; };
    const auto places = [&](const std::array<std::uint32_t, 3>& t) {
      return std::array{place(t[0]), place(t[1]), place(t[2])};
    };
    std::erase_if(triangles, [&](const auto& t) {
      const auto p = places(t);
      return p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
    });
    std::ranges::sort(triangles, {}, places);
  }

  std::vector<Vec3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// `make` with the name of what it makes before its error.
template <class Make>
auto named(const std::string& name, const Make& make) {
  try {
    return make();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace

FileGridSection read_file_grid(Params& params) {
  FileGridSection section;
  section.file = params.required_text("file", "an OpenVDB file beside the scene");
  section.grid = params.text("grid", "", "which of the file's grids; none: the first");
  return section;
}

ModelGridSection read_model_grid(Params& params) {
  ModelGridSection section;
  section.model = params.required_text("model",
                                       "name of a model of closed meshes: the grid is the distance from its "
                                       "surface, negative inside, in the model's own frame");
  section.spacing = params.required_real("spacing", lengths, "distance between samples; what is smaller is lost");
  section.band =
      params.real("band", 0, {0, 1e6, "m"}, "how far from the surface distances are known; 0: three samples");
  return section;
}

ValueGridSection read_value_grid(Params& params) {
  ValueGridSection section;
  section.value = params.scalar_expression("value", "0", place_symbols(), "what is sampled, by P");
  section.from = params.required_vector("from", "corner of the box of samples; outside it the grid is 0");
  section.to = params.required_vector("to", "the opposite corner");
  section.spacing = params.required_real("spacing", lengths, "distance between samples");
  return section;
}

SceneGrids::SceneGrids(const Value* section, std::string folder, double time, PartLibrary& parts,
                       Diagnostics& diagnostics)
    : section_(section), folder_(std::move(folder)), time_(time), parts_(parts), diagnostics_(diagnostics) {}
SceneGrids::~SceneGrids() = default;

std::shared_ptr<const Grid> SceneGrids::open(const std::string& name, const std::string& grid) {
  const auto key = std::make_pair(name, grid);
  if (const auto known = open_.find(key); known != open_.end()) {
    if (!known->second) throw std::runtime_error(fmt::format("the grid \"{}\" cannot be made", name));
    return known->second;
  }
  const Value* const own = section_ ? section_->find(name) : nullptr;
  if (own && !grid.empty())
    throw std::runtime_error(fmt::format("\"{}\" is one of the scene's grids: it has no others in it", name));
  if (!own && !name.ends_with(".vdb")) {
    std::vector<std::string> names;
    for (const Member& m : section_ ? section_->members : std::vector<Member>{}) names.push_back(m.key);
    const std::string_view near = nearest_name(name, names);
    throw std::runtime_error(
        fmt::format("no grid named \"{}\"{}; it names one of the scene's \"grids\"{} or a file that ends in .vdb", name,
                    near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near),
                    names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", "))));
  }
  if (!under_construction_.insert(name).second)
    throw std::runtime_error(fmt::format("the grid \"{}\" needs itself", name));
  open_[key] = nullptr;
  const auto made = named(name, [&] {
    bool is_level_set = false;
    const auto source = own ? from_section(name, *own, is_level_set) : read_file(name, grid);
    return std::make_shared<const BrickGrid>(*source);
  });
  under_construction_.erase(name);
  return open_[key] = made;
}

void SceneGrids::check_unused() {
  if (!section_) return;
  for (const Member& m : section_->members)
    if (!open_.count({m.key, ""})) {
      try {
        open(m.key, "");
      } catch (const std::runtime_error& error) {
        diagnostics_.error(m.value.location, error.what());
      }
    }
}

std::pair<std::unique_ptr<VoxelSource>, bool> SceneGrids::voxels(const std::string& name) {
  const Value* const own = section_ ? section_->find(name) : nullptr;
  if (!own) throw std::runtime_error(fmt::format("the scene has no grid named \"{}\"", name));
  bool is_level_set = false;
  auto source = named(name, [&] { return from_section(name, *own, is_level_set); });
  return {std::move(source), is_level_set};
}

std::unique_ptr<VoxelSource> SceneGrids::read_file(const std::string& file, const std::string& grid) {
  const auto path = path_in_folder(folder_, file);
  if (!path) throw std::runtime_error("a file must lie in the folder of its scene file or below it");
  files_[file] = *path;
  return vdb_codec().read(*path, grid);
}

std::unique_ptr<VoxelSource> SceneGrids::from_section(const std::string& name, const Value& value, bool& is_level_set) {
  TimeScope scope(time_);  // whatever that of the expression is that names the grid
  Params params(value, fmt::format("grid \"{}\"", name), diagnostics_);
  if (value.find("model")) {
    const ModelGridSection section = read_model_grid(params);
    params.finish();
    is_level_set = true;
    return from_model(params, section);
  }
  if (value.find("value")) {
    const ValueGridSection section = read_value_grid(params);
    params.finish();
    return std::make_unique<ExpressionVoxels>(section);
  }
  if (!value.find("file")) throw std::runtime_error("a grid has a \"file\", a \"model\" or a \"value\"");
  const FileGridSection section = read_file_grid(params);
  params.finish();
  return read_file(section.file, section.grid);
}

std::unique_ptr<VoxelSource> SceneGrids::from_model(Params& params, const ModelGridSection& section) {
  const auto part = parts_.named_part(section.model, params, "model");
  if (!part) throw std::runtime_error(fmt::format("the model \"{}\" cannot be built", section.model));
  const PartTriangles mesh(part, detail_of_samples * section.spacing);
  const double band = std::max(section.band / section.spacing, 3.0);
  std::unique_ptr<VoxelSource> result;
  // Alone, so that it has the same bits however many threads there are
  run_isolated([&] { result = vdb_codec().level_set(mesh.vertices, mesh.triangles, section.spacing, band); });
  return result;
}

}  // namespace meristem
