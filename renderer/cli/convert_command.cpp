#include "renderer/cli/convert_command.h"

#include "renderer/cli/console.h"
#include "renderer/cli/exit_code.h"
#include "renderer/cli/outputs.h"
#include "renderer/image/atomic_file.h"
#include "renderer/interchange/gltf_reader.h"
#include "renderer/interchange/mesh_scene.h"
#include "renderer/interchange/pbrt_reader.h"

#include <fmt/format.h>

namespace meristem {

int convert_command(const ConvertOptions& options) {
  check_targets(options.input, {options.output});
  check_writable(options.output);
  Diagnostics diagnostics;
  AssetFolder assets(options.output);
  const std::string& input = options.input;
  ForeignScene scene = input.ends_with(".pbrt")                             ? read_pbrt(input, assets, diagnostics)
                       : input.ends_with(".obj") || input.ends_with(".ply") ? read_mesh_scene(input, diagnostics)
                                                                            : read_gltf(input, assets, diagnostics);
  complete_foreign_scene(scene, diagnostics);
  write_foreign_scene(scene, options.output, assets);
  if (options.quiet) return int(ExitCode::Done);
  print_diagnostics(diagnostics.list());
  print_error(fmt::format("{} models, {} objects, {} materials, {} lights, {} cameras\nwrote {}", scene.models.size(),
                          scene.objects.size(), scene.materials.size(), scene.lights.size(), scene.cameras.size(),
                          options.output));
  return int(ExitCode::Done);
}

}  // namespace meristem
