#include "renderer/cli/command_line.h"

#include "renderer/cli/commands.h"
#include "renderer/cli/console.h"
#include "renderer/cli/option_values.h"
#include "renderer/color/color.h"
#include "renderer/report/version.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <map>
#include <new>
#include <span>

namespace meristem {

namespace {

constexpr const char* scene_group = "Scene";
constexpr const char* footer =
    "Exit codes: 0 done, 1 internal error, 2 usage or scene error, 3 limit reached or render faults (image written),\n"
    "4 file error, 130 and 143 interrupted (image so far written; a second Ctrl-C within two seconds ends at once).";

// An option whose text `parse` turns into a value; what it throws becomes a usage error of that option.
template <class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, const std::string& type, const std::string& doc,
                        Parse parse) {
  return app
      .add_option_function<std::string>(
          name,
          [name, parse](const std::string& text) {
            try {
              parse(text);
            } catch (const std::exception& error) {
              throw CLI::ValidationError(name, error.what());
            }
          },
          doc)
      ->type_name(type)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

// Options that change what is rendered: of every command that renders.
void add_scene_options(CLI::App& app, RenderOptions& o) {
  const auto size = [&o](const std::string& text) {
    const auto [width, height] = parse_size(text);
    o.load.width = width;
    o.load.height = height;
  };
  app.add_option("--samples", o.load.samples, "samples a pixel")->check(CLI::Range(1, 1 << 20))->group(scene_group);
  add_parsed(app, "--size", "WxH", "image size in pixels", size)->group(scene_group);
  add_parsed(app, "--crop", "X0,Y0,X1,Y1", "render this part alone, in pixels", [&o](const std::string& t) {
    o.crop = parse_crop(t);
  })->group(scene_group);
  app.add_option("--camera", o.load.camera, "one of the scene's cameras, by name")->group(scene_group);
  app.add_option("--detail", o.load.detail, "wanted size of faces in pixels; 0: everything in full")
      ->type_name("PX")
      ->check(CLI::Range(0.0, 1024.0))
      ->group(scene_group);
  app.add_option("--seed", o.load.seed, "of all random numbers")->group(scene_group);
  app.add_option("--max-depth", o.load.max_depth, "bounces of a path")->check(CLI::Range(0, 1024))->group(scene_group);
  app.add_option("--threads", o.load.threads, "0: all processors")->check(CLI::Range(0, 1024))->group(scene_group);
  add_parsed(app, "--budget", "BYTES", "memory of the geometry cache: 512M, 2G", [&o](const std::string& t) {
    o.load.budget_bytes = parse_memory(t);
  })->group(scene_group);
}

void add_expand_option(CLI::App& app, RenderOptions& o) {
  static const std::map<std::string, ExpandMode> modes{
      {"lazy", ExpandMode::Lazy}, {"eager", ExpandMode::Eager}, {"flat", ExpandMode::Flat}};
  app.add_option("--expand", o.load.expand,
                 "lazy: where rays hit; eager: all cells beforehand; flat: into one scene without cells")
      ->transform(CLI::CheckedTransformer(modes).description(""))
      ->type_name("lazy|eager|flat");
}

void add_output_options(CLI::App& app, RenderOptions& o) {
  const auto output = [](const std::string& path) {
    try {
      image_format(path);
      return std::string();
    } catch (const FileError& error) {
      return std::string(error.what());
    }
  };
  app.add_option("-o,--output", o.outputs,
                 "image by extension: exr, png, jpg, tif; repeatable (default: the scene's name, .exr and .png)")
      ->check(CLI::Validator(output, ""))
      ->type_name("FILE")
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option("--exposure", o.exposure, "stops, for display images (not EXR)")
      ->check(CLI::Range(-100.0, 100.0))
      ->type_name("STOPS");
  app.add_option("--view", o.view, "of display images: \"ACES SDR\" (default), sRGB, Raw");
  CLI::Option* half = app.add_flag_callback(
      "--half", [&o] { o.write.half = true; }, "EXR of 16-bit floats (default)");
  app.add_flag_callback(
         "--float", [&o] { o.write.half = false; }, "EXR of 32-bit floats")
      ->excludes(half);
  app.add_option("--bits", o.write.bits, "a channel in PNG and TIFF")->check(CLI::IsMember({8, 16}))->type_name("8|16");
  app.add_option("--stats", o.statistics, "write the figures of the render as JSON")->type_name("FILE");
  CLI::Option* quiet = app.add_flag("-q,--quiet", o.quiet, "say nothing but errors");
  app.add_flag("-v,--verbose", o.verbose, "more figures at the end")->excludes(quiet);
}

void add_scene_argument(CLI::App& app, std::string& scene) {
  app.add_option("SCENE", scene, "scene file; - for standard input")->required();
}

// The options of scene_group as the user gave them, to hand on to a child.
std::vector<std::string> given_scene_options(const CLI::App& app) {
  std::vector<std::string> given;
  for (const CLI::Option* option :
       app.get_options([](const CLI::Option* o) { return o->get_group() == scene_group && o->count() > 0; })) {
    given.push_back(option->get_name());
    given.push_back(option->results().back());
  }
  return given;
}

// The program's options and where their values go.
class CommandLine {
 public:
  CommandLine(const std::string& text, const SceneLoader& load) : load_(load) {
    render_.command_line = text;
    app_.set_version_flag("--version", fmt::format("meristem {}", version));
    app_.require_subcommand(1);
    app_.footer(footer);
    add_render();
    add_compare();
    add_check();
    add_describe();
    app_.add_subcommand("schema", "the JSON Schema of scene files, for editors")->final_callback([this] {
      exit_code_ = schema_command();
    });
  }
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // Parses, and runs the command that is named.
  int run(int argc, const char* const* argv) {
    try {
      app_.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app_.exit(error) == 0 ? int(ExitCode::Done) : int(ExitCode::Usage);  // 0: --help, --version
    }
    return exit_code_;
  }

 private:
  void add_render() {
    CLI::App& command = *app_.add_subcommand("render", "render a scene to image files");
    add_scene_argument(command, render_.scene);
    add_scene_options(command, render_);
    add_expand_option(command, render_);
    add_output_options(command, render_);
    command.footer(footer);
    command.final_callback([this] { exit_code_ = render_command(render_, load_); });
  }

  void add_compare() {
    CLI::App& command =
        *app_.add_subcommand("compare", "render lazily, eagerly and flat; compare time, memory and image");
    add_scene_argument(command, compare_.scene);
    command.add_option("--runs", compare_.runs, "renderings of each; figures are medians")->check(CLI::Range(1, 1000));
    command.add_flag("--json", compare_.json, "print JSON instead of a table");
    add_scene_options(command, compared_);
    command.final_callback([this, &command] {
      compare_.render_options = given_scene_options(command);
      exit_code_ = compare_command(compare_);
    });
  }

  void add_check() {
    CLI::App& command = *app_.add_subcommand("check", "load a scene and report its errors; renders nothing");
    add_scene_argument(command, checked_scene_);
    command.final_callback([this] { exit_code_ = check_command(checked_scene_, load_); });
  }

  void add_describe() {
    CLI::App& command = *app_.add_subcommand("describe", "manual pages of components; without NAME, their list");
    CLI::Option* name = command.add_option("NAME", described_, "a component, or a kind of components");
    command.add_flag("--markdown", describe_markdown_, "all pages as one Markdown document")->excludes(name);
    command.final_callback(
        [this] { exit_code_ = describe_markdown_ ? describe_markdown_command() : describe_command(described_); });
  }

  const SceneLoader& load_;
  CLI::App app_{"Meristem: a ray-tracing renderer whose geometry grows where rays touch it", "meristem"};
  RenderOptions render_;
  RenderOptions compared_;  // parsed for their errors; the children get the text
  CompareOptions compare_;
  std::string checked_scene_, described_;
  bool describe_markdown_ = false;
  int exit_code_ = 0;
};

int fail(ExitCode code, const std::string& message) {
  print_error("error: " + message);
  return int(code);
}

}  // namespace

int run_command_line(int argc, const char* const* argv, const SceneLoader& load) {
  try {
    const std::string text = fmt::format("{}", fmt::join(std::span(argv, std::size_t(argc)), " "));
    return CommandLine(text, load).run(argc, argv);
  } catch (const SceneErrors& errors) {
    print_diagnostics(errors.list());
    return int(ExitCode::Usage);
  } catch (const UsageError& error) {
    return fail(ExitCode::Usage, error.what());
  } catch (const ColorError& error) {
    return fail(ExitCode::Usage, error.what());
  } catch (const FileError& error) {
    return fail(ExitCode::File, error.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::Internal, "out of memory; --budget limits the geometry cache");
  } catch (const std::exception& error) {
    return fail(ExitCode::Internal, fmt::format("internal: {}", error.what()));
  }
}

}  // namespace meristem
