// MaterialLooks: the materials of a scene as other programs know them, found by evaluating them on the surfaces that
// are exported. One thread.
#pragma once

#include "renderer/interchange/mesh_writer.h"
#include "renderer/scene/scene.h"

#include <vector>

namespace meristem {

class MaterialLooks {
 public:
  // The scene must outlive it.
  explicit MaterialLooks(const Scene& scene);

  // Whether a material of the scene has another colour here than there.
  bool any_varies() const;
  // The index of the material of faces with that origin.
  std::uint32_t material_of(const FaceOrigin& origin) const;
  // The base colour there, in the world; the point is one of those that the material's means are taken over.
  Spectrum color_at(const FaceOrigin& origin, Vec3f position, Vec3f normal, Vec2f uv);
  // Those of all materials of the scene, in its order.
  std::vector<MaterialLook> list() const;

 private:
  struct Entry {
    MaterialLook look;  // of a varying material: the mean so far
    double samples = 0;
  };
  const Scene& scene_;
  std::vector<Entry> entries_;
};

}  // namespace meristem
