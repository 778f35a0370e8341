// Objects whose material glows become lights that surfaces ask, triangle by triangle, where their faces are few.
#pragma once

#include "geometry/accel/world.h"
#include "renderer/scene/scene.h"

#include <vector>

namespace meristem {

// Objects of up to this many final faces; light of larger ones is found by bounces alone.
constexpr double max_glowing_faces = 4096;
// And as long as a scene has no more triangles of this kind (some 300 bytes each).
constexpr std::size_t max_glowing_triangles = std::size_t(1) << 18;

// Appends a light for each triangle of the objects' glowing faces. Expands those objects whole, and has
// them shown whole: what is sampled must be what is hit. Those that change while the shutter is open are left to
// bounces.
void add_glowing_objects(std::vector<Placement>& objects, Scene& scene);

}  // namespace meristem
