// The section "grids" of a scene file, and the VDB files that expressions name: what vdb() leads to.
//
//   "grids": { "rock":   { "file": "rock.vdb", "grid": "surface" },
//              "column": { "model": "column", "spacing": 0.02 },
//              "puff":   { "value": "fbm(P)", "from": [-1, 0, -1], "to": [1, 2, 1], "spacing": 0.1 } }
#pragma once

#include "geometry/base/params.h"
#include "geometry/fields/grid.h"
#include "geometry/volumes/voxel_source.h"
#include "renderer/loading/load_part.h"

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace meristem {

struct FileGridSection {
  std::string file, grid;
};
FileGridSection read_file_grid(Params& params);

struct ModelGridSection {
  std::string model;
  double spacing = 0, band = 0;
};
ModelGridSection read_model_grid(Params& params);

struct ValueGridSection {
  std::shared_ptr<const Expression> value;
  Vec3d from, to;
  double spacing = 0;
};
ValueGridSection read_value_grid(Params& params);

// Grids are made when they are first named. One thread.
class SceneGrids final : public GridSource {
 public:
  // `section`: as written; null if absent. `folder`: of the scene, as the user wrote its name. `time`: of all grids.
  SceneGrids(const Value* section, std::string folder, double time, PartLibrary& parts, Diagnostics& diagnostics);
  ~SceneGrids() override;

  std::shared_ptr<const Grid> open(const std::string& name, const std::string& grid) override;
  // Grids of the section that nothing names are checked all the same.
  void check_unused();
  // The samples of one of the section's grids, and whether they are a level set: for writing them to a file.
  std::pair<std::unique_ptr<VoxelSource>, bool> voxels(const std::string& name);
  // The files read so far: name as written and path.
  const std::map<std::string, std::string>& files() const { return files_; }

 private:
  std::unique_ptr<VoxelSource> read_file(const std::string& file, const std::string& grid);
  std::unique_ptr<VoxelSource> from_section(const std::string& name, const Value& value, bool& is_level_set);
  std::unique_ptr<VoxelSource> from_model(Params& params, const ModelGridSection& section);

  const Value* section_;
  const std::string folder_;
  const double time_;
  PartLibrary& parts_;
  Diagnostics& diagnostics_;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const Grid>> open_;
  std::map<std::string, std::string> files_;
  std::set<std::string> under_construction_;
};

}  // namespace meristem
