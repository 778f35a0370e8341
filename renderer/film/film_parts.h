// A film as the parts of an EXR file: "beauty", then one part for each of its AOVs, named after it. They ask the film
// for rows as they are written.
#pragma once

#include "renderer/film/film.h"
#include "renderer/image/exr_parts.h"
#include "renderer/scene/scene.h"

#include <vector>

namespace meristem {

// The film must outlive them. `half`: of the beauty; data are always floats. `names` stand in the manifests of mattes.
std::vector<ExrPart> film_parts(const Film& film, const SceneNames& names, bool half);

}  // namespace meristem
