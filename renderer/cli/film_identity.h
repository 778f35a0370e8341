// What the samples of a film depend on, so that a render goes on only from a film of the same image, and only films of
// one image are merged.
#pragma once

#include "renderer/cli/render_command.h"
#include "renderer/film/film_file.h"

#include <string>

namespace meristem {

// Reads the files that the scene names, to take their digests: 200 MB/s.
std::vector<std::pair<std::string, std::string>> film_identity(const RenderOptions& options, const LoadedScene& loaded,
                                                               const PixelWindow& window);

using FilmIdentity = decltype(FilmInfo::identity);

// In words: "seed was 1 and is 2; ground.obj has changed"; empty if they are the same.
std::string identity_difference(const FilmIdentity& before, const FilmIdentity& now);

}  // namespace meristem
