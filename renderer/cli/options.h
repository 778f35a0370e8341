// The options of the commands: the one place where each has its name, type and meaning. What is parsed, --help, the
// manual page and the completion of shells all come from here.
#pragma once

#include "renderer/cli/commands.h"
#include "renderer/cli/convert_command.h"
#include "renderer/cli/export_command.h"
#include "renderer/cli/probe_command.h"
#include "renderer/cli/render_command.h"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace meristem {

void add_scene_argument(CLI::App& app, std::string& scene);

// What is seen, and how large: of every command that expands geometry.
void add_view_options(CLI::App& app, LoadOptions& o);
// What is rendered: of every command that renders. Those among it.
void add_scene_options(CLI::App& app, RenderOptions& o);
// Those of them that the user gave, to hand on to a child.
std::vector<std::string> given_scene_options(const CLI::App& app);

// What is written, and how: of every command that writes images.
void add_output_options(CLI::App& app, OutputOptions& o);

// Puts -h among the others, so that the list fits a screen.
void place_help_option(CLI::App& app);

// Of the commands that report; beside the options of the scene.
void add_profile_options(CLI::App& app, ProfileOptions& o);
void add_compare_options(CLI::App& app, CompareOptions& o);

// Of `export`, beside the options of the view.
void add_export_options(CLI::App& app, ExportOptions& o);

// Of `probe`, beside the options of the view.
void add_probe_options(CLI::App& app, ProbeOptions& o);

// Of `convert`.
void add_convert_options(CLI::App& app, ConvertOptions& o);

// What only `render` has: AOVs, ways of expanding, limits, checkpoints, parts, reports. After the two above.
void add_render_options(CLI::App& app, RenderOptions& o);

}  // namespace meristem
