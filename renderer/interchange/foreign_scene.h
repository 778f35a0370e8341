// ForeignScene: a scene of another program in the words of our scene files, as an importer finds it; and writing it
// down: one .jsonc file, and a folder of its name for meshes and images.
#pragma once

#include "geometry/base/source.h"
#include "geometry/base/transform.h"
#include "geometry/base/value.h"
#include "geometry/io/polygon_mesh.h"

#include <optional>
#include <string>
#include <vector>

namespace meristem {

// A base mesh with its steps.
struct ForeignModel {
  std::string name, material;
  std::optional<PolygonMesh> mesh;                                // becomes a file, with
  std::vector<std::pair<std::string, std::string>> symbols = {};  // of its faces by their names; or
  Value base;                                                     // a base as a scene file has it
  std::vector<Value> steps;
};

struct ForeignObject {
  std::string model;  // or group
  Affine3d to_parent;
};

struct ForeignScene {
  std::vector<Member> materials, cameras;
  std::vector<ForeignModel> models;
  std::vector<std::pair<std::string, std::vector<ForeignObject>>> groups;
  std::vector<ForeignObject> objects;
  std::vector<Value> lights;
  std::vector<Member> render;
};

// Numbers without the digits that a computation in double leaves behind.
Value tidy_number(double x);
Value tidy_vector(Vec3d v);

// The folder beside a scene file where what belongs to it is put: "forest-files" of "forest.jsonc".
class AssetFolder {
 public:
  explicit AssetFolder(const std::string& scene_path);
  // Each returns the name by which the scene knows the file. The folder is made when it is first needed. FileError.
  std::string write(const std::string& name, std::string_view bytes);
  // Of the same file once; empty, with an error at `where`, if it cannot be read.
  std::string copy(const std::string& path, const Location& where, Diagnostics& diagnostics);
  std::string path_of(const std::string& name);  // for writing there by other means

 private:
  std::string folder_, name_;
  std::vector<std::pair<std::string, std::string>> copied_;
};

// A scene without a camera gets one that sees all of it, a scene without light an even one; both are said.
void complete_foreign_scene(ForeignScene& scene, Diagnostics& diagnostics);

// Writes the meshes, then the scene.
void write_foreign_scene(const ForeignScene& scene, const std::string& path, AssetFolder& assets);

// What lies in the folder of `file` or below it, links followed: as a path that can be opened. Empty if it leaves it.
std::string path_inside(const std::string& folder, const std::string& file);

}  // namespace meristem
