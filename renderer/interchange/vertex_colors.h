// Colours of vertices as a texture: base meshes carry no colours, but each face its own u, v. Every triangle gets two
// by two texels of an image, so that a bilinear look-up between them is the colour between its corners. Pure functions.
#pragma once

#include "geometry/io/polygon_mesh.h"
#include "renderer/image/image.h"

#include <span>

namespace meristem {

// Of triangles whose corner_uv are indices into `colors`. Gives every corner u, v of its own in the image, which is for
// look-ups at points: a mean over more texels would be one over strangers.
Image patches_of_colors(PolygonMesh& mesh, std::span<const Vec3f> colors);

}  // namespace meristem
