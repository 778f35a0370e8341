// What an image says of how it was made: metadata in EXR, PNG and TIFF headers, and the history in film files.
#pragma once

#include "renderer/cli/render_command.h"
#include "renderer/film/film_file.h"
#include "renderer/report/statistics.h"
#include "renderer/session/session.h"

#include <string>

namespace meristem {

const char* end_name(RenderEnd end);  // "complete", "time limit", "interrupted"

// "2026-03-01T12:00:00Z: 3600 samples in 2.1 s, complete". `before`: samples that the film had before this run.
std::string history_line(const RenderStatistics& s, std::uint64_t before, const char* end);

// Everything: scene, settings, command, samples, times, memory, what expansion did, history.
Metadata render_metadata(const RenderStatistics& s, const Scene& scene, const RenderOptions& options,
                         const FilmInfo& info, const char* end);

// Of a film that was merged from several.
Metadata merged_metadata(const FilmInfo& info, const std::string& command_line);

}  // namespace meristem
