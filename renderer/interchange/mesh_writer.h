// MeshWriter: puts surfaces into a mesh file as they are expanded. Memory stays at a few bytes a cell; the file appears
// whole or not at all. One thread. Errors of files are FileErrors; what a format cannot hold is TooMany.
#pragma once

#include "geometry/base/transform.h"
#include "geometry/cells/shown_surfaces.h"
#include "renderer/scene/interfaces.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace meristem {

// A material as other programs know one. Where its parameters vary over the surface these are means.
struct MaterialLook {
  std::string name;
  Spectrum base_color{0.8f, 0.8f, 0.8f};
  float metalness = 0, roughness = 0.3f, ior = 1.5f;
  float transmission = 0;  // as of glass
  float coat = 0, coat_roughness = 0;
  float opacity = 1;
  Spectrum emission{};
  bool varies = false;  // then vertices have the colour
  bool is_used = false;
};

struct MeshVertex {
  Vec3f position, normal;
  Vec2f uv;     // v upwards
  Vec3f color;  // scene-linear
};
struct MeshTriangle {
  std::array<std::uint32_t, 3> vertices;
  std::uint32_t material;
};

// A camera in the world.
struct MeshCamera {
  Affine3d to_world;  // it looks along -z, y upwards
  double vertical_fov = 0.7, aspect = 1;
  double height = 0;  // of what is seen without perspective; 0: there is perspective
};

class MeshWriter {
 public:
  virtual ~MeshWriter() = default;
  // What is added from here on is one surface that stands in these places.
  virtual void begin(const std::string& name, std::span<const Affine3d> places) = 0;
  // More of the surface. Its vertices are numbered on from those before; triangles name any so far.
  virtual void add(std::span<const MeshVertex> vertices, std::span<const MeshTriangle> triangles) = 0;
  virtual void finish(std::span<const MaterialLook> materials, const MeshCamera& camera) = 0;
};

// Writers by the extension of the path: .obj (with materials in an .mtl beside it), .ply (binary), .glb (glTF 2.0;
// places are nodes that share meshes). Null for any other. `has_colors`: whether vertices have one.
std::unique_ptr<MeshWriter> make_mesh_writer(const std::string& path, bool has_colors,
                                             const std::vector<std::string>& material_names);

std::unique_ptr<MeshWriter> make_obj_writer(const std::string& path, const std::vector<std::string>& material_names);
std::unique_ptr<MeshWriter> make_ply_writer(const std::string& path, bool has_colors);
std::unique_ptr<MeshWriter> make_glb_writer(const std::string& path, bool has_colors);

}  // namespace meristem
