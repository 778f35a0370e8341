#include "renderer/cli/options.h"

#include "renderer/cli/exit_code.h"
#include "renderer/cli/manual.h"
#include "renderer/cli/option_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <ranges>
#include <tuple>

namespace meristem {

namespace {

constexpr const char* scene_group = "Scene";
constexpr const char* output_group = "Output";
constexpr const char* long_group = "Long renders";
constexpr const char* report_group = "Reports";

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
      ->type_name(type);
}

// An option that takes one of some words.
template <class Choices, class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Value& value, const std::string& doc,
                        const Choices& choices) {
  CLI::Option* const option = add_parsed(app, name, "", doc, [&value, &choices](const std::string& text) {
    const auto choice = choices.find(text);
    if (choice == choices.end())
      throw UsageError(
          fmt::format("\"{}\" is not known: expected one of {}", text, fmt::join(std::views::keys(choices), ", ")));
    value = choice->second;
  });
  return offer(option, fmt::format("{}", fmt::join(std::views::keys(choices), " ")));
}

// A check by a function that throws what is wrong.
template <class Check>
CLI::Validator checked_by(Check check) {
  return CLI::Validator(
      [check](const std::string& text) {
        try {
          check(text);
          return std::string();
        } catch (const std::exception& error) {
          return std::string(error.what());
        }
      },
      "");
}

// May stand several times, each with one value.
CLI::Option* repeatable(CLI::Option* option) { return option->take_all()->expected(1)->allow_extra_args(false); }

void add_expand_option(CLI::App& app, RenderOptions& o) {
  static const std::map<std::string, ExpandMode> modes{
      {"lazy", ExpandMode::Lazy}, {"eager", ExpandMode::Eager}, {"flat", ExpandMode::Flat}};
  add_choice(app, "--expand", o.load.expand, "where rays hit; all cells first; without cells", modes)
      ->type_name("lazy|eager|flat")
      ->group(report_group);
}

void add_aov_option(CLI::App& app, RenderOptions& o) {
  std::string names = "all";
  for (const AovInfo& aov : aov_infos()) names += fmt::format(" {}", aov.name);
  repeatable(offer(app.add_option_function<std::vector<std::string>>(
                       "--aov",
                       [&o](const std::vector<std::string>& lists) {
                         for (const std::string& list : lists) {
                           const std::vector<Aov> more = parse_aovs(list);
                           o.load.aovs.insert(o.load.aovs.end(), more.begin(), more.end());
                         }
                       },
                       "parts of EXR files: albedo,normal,Z,... or all"),
                   names))
      ->check(checked_by([](const std::string& list) { parse_aovs(list); }))
      ->type_name("NAMES")
      ->group(output_group);
}

void add_long_options(CLI::App& app, RenderOptions& o) {
  add_parsed(app, "--time-limit", "TIME", "stop after 90s, 10m, 2h; --resume goes on", [&o](const std::string& t) {
    o.time_limit_s = parse_duration(t);
  })->group(long_group);
  add_parsed(app, "--checkpoint", "TIME", "write the images so far, and the film, so often",
             [&o](const std::string& t) { o.checkpoint_s = parse_duration(t); })
      ->group(long_group);
  app.add_flag("--resume", o.resume, "go on from the film of a render that was stopped")->group(long_group);
  add_parsed(app, "--sample-range", "FIRST:END", "these samples alone; to be merged",
             [&o](const std::string& t) { o.sample_range = parse_sample_range(t); })
      ->excludes(app.get_option("--samples"))
      ->excludes(app.get_option("--noise"))
      ->group(long_group);
  add_parsed(app, "--frames", "1-48", "an image each; #### in file names is the number", [&o](const std::string& t) {
    o.frames = parse_frames(t);
  })->group(long_group);
}

void add_report_options(CLI::App& app, RenderOptions& o) {
  app.add_option("--stats", o.statistics, "the figures of the render as JSON")->type_name("FILE")->group(report_group);
  app.add_flag("--profile", o.profile, "record expansion for --stats")->group(report_group);
  app.add_option("--trace", o.trace, "Chrome trace of expansion")->type_name("FILE")->group(report_group);
  using Style = ProgressDisplay::Style;
  static const std::map<std::string, Style> styles{
      {"bar", Style::Bar}, {"lines", Style::Lines}, {"json", Style::Json}, {"none", Style::None}};
  add_choice(app, "--progress", o.progress, "bar, lines, none; json: to standard output", styles)
      ->type_name("STYLE")
      ->group(report_group);
  CLI::Option* quiet = app.add_flag("-q,--quiet", o.quiet, "say nothing but errors")->group(report_group);
  app.add_flag("-v,--verbose", o.verbose, "more figures at the end")->excludes(quiet)->group(report_group);
}

}  // namespace

void add_scene_argument(CLI::App& app, std::string& scene) {
  app.add_option("SCENE", scene, "scene file; - for standard input")->required();
}

void add_view_options(CLI::App& app, LoadOptions& o) {
  const auto add = [&](CLI::Option* option, const char* type) { option->type_name(type)->group(scene_group); };
  const auto size = [&o](const std::string& text) {
    const auto [width, height] = parse_size(text);
    o.width = width;
    o.height = height;
  };
  add(add_parsed(app, "--size", "WxH", "image size in pixels", size), "WxH");
  add(app.add_option("--camera", o.camera, "one of the scene's cameras"), "NAME");
  add(app.add_option("--detail", o.detail, "wanted size of faces in pixels; 0: everything")
          ->check(CLI::Range(0.0, 1024.0)),
      "PX");
  add(repeatable(app.add_option("--set", o.set, "override a value: /camera/fov=35; repeatable")), "/PATH=VALUE");
}

void add_scene_options(CLI::App& app, RenderOptions& o) {
  const auto add = [&](CLI::Option* option, const char* type) { option->type_name(type)->group(scene_group); };
  add(app.add_option("--samples", o.load.samples, "samples a pixel")->check(CLI::Range(1, 1 << 20)), "N");
  add(app.add_option("--noise", o.load.noise, "quieter pixels stop: 0.01 clean, 0.05 grainy")
          ->check(CLI::Range(0.0, 1.0)),
      "LIMIT");
  add_view_options(app, o.load);
  add(add_parsed(app, "--crop", "", "render this part alone, in pixels",
                 [&o](const std::string& t) { o.crop = parse_crop(t); }),
      "X0,Y0,X1,Y1");
  add(app.add_option("--seed", o.load.seed, "of all random numbers"), "N");
  add(app.add_option("--max-depth", o.load.max_depth, "bounces of a path")->check(CLI::Range(0, 1024)), "N");
  add(app.add_option("--shutter", o.load.shutter, "part of a frame that it is open; 0: no blur")
          ->check(CLI::Range(0.0, 1.0)),
      "FRAMES");
  add(app.add_option("--threads", o.load.threads, "0: all processors")->check(CLI::Range(0, 1024)), "N");
  add(add_parsed(app, "--budget", "", "memory of the geometry cache: 512M, 2G",
                 [&o](const std::string& t) { o.load.budget_bytes = parse_memory(t); }),
      "BYTES");
  add(app.add_option("--scratch", o.load.scratch_directory, "keep surfaces there that the budget has no room for"),
      "DIRECTORY");
  static const std::map<std::string, RayOrder> orders{
      {"depth-first", RayOrder::DepthFirst}, {"queued", RayOrder::Queued}, {"auto", RayOrder::Auto}};
  add(add_choice(app, "--ray-order", o.load.ray_order, "depth-first, queued or auto: do rays wait for cells", orders),
      "ORDER");
  add(add_parsed(app, "--queue-memory", "", "of rays that wait for cells: 128M",
                 [&o](const std::string& t) { o.load.queue_bytes = parse_memory(t); }),
      "BYTES");
}

std::vector<std::string> given_scene_options(const CLI::App& app) {
  std::vector<std::string> given;
  for (const CLI::Option* option :
       app.get_options([](const CLI::Option* o) { return o->get_group() == scene_group && o->count() > 0; }))
    for (const std::string& value : option->results()) {
      given.push_back(option->get_name());
      given.push_back(value);
    }
  return given;
}

void add_output_options(CLI::App& app, OutputOptions& o) {
  const auto grouped = [](CLI::Option* option) { return option->group(output_group); };
  grouped(repeatable(app.add_option("-o,--output", o.files, "exr, png, jpg, tif or film, by extension; repeatable")))
      ->check(checked_by(check_extension))
      ->type_name("FILE");
  // Those that are built in are offered
  offer(grouped(app.add_option("--view", o.view, "of display images: \"ACES SDR\", sRGB, Raw"))->type_name("NAME"),
        "ACES\\ SDR sRGB Raw");
  offer(grouped(app.add_option("--display", o.display, "of display images: sRGB, Rec.1886, P3-D65"))->type_name("NAME"),
        "sRGB Rec.1886 P3-D65");
  grouped(app.add_option("--exposure", o.exposure, "of display images")->check(CLI::Range(-100.0, 100.0)))
      ->type_name("STOPS");
  grouped(app.add_option("--bits", o.bits, "a channel in PNG and TIFF")->check(CLI::IsMember({8, 16})))
      ->type_name("8|16");
  grouped(app.add_flag("--denoise", o.denoise, "PNG, JPEG, TIFF; in EXR a part of its own"));
  CLI::Option* half = grouped(app.add_flag_callback(
      "--half", [&o] { o.half = true; }, "the picture in EXR as 16-bit floats: the default"));
  half->group("");  // it says what is so anyway: not listed
  grouped(app.add_flag_callback(
              "--float", [&o] { o.half = false; }, "the picture in EXR as 32-bit floats"))
      ->excludes(half);
}

void add_profile_options(CLI::App& app, ProfileOptions& o) {
  app.add_option("-o,--output", o.page, "the page; else the scene's name with .html")->type_name("FILE");
  app.add_option("--stats", o.statistics, "its figures as JSON")->type_name("FILE");
  app.add_option("--trace", o.trace, "Chrome trace: Perfetto, speedscope")->type_name("FILE");
}

void add_compare_options(CLI::App& app, CompareOptions& o) {
  app.add_option("-o,--output", o.page, "write an HTML page")->type_name("FILE");
  add_parsed(app, "--budgets", "LIST", "lazily with these, too: 25%,64M (shares of all)",
             [&o](const std::string& text) { o.budgets = parse_budgets(text); });
  app.add_option("--runs", o.runs, "renderings of each; figures are medians")->check(CLI::Range(1, 1000));
  app.add_flag("--json", o.json, "print JSON instead of a table");
}

void add_export_options(CLI::App& app, ExportOptions& o) {
  app.add_option("-o,--output", o.output, "obj, ply or glb, by extension")
      ->required()
      ->check(checked_by([](const std::string& path) {
        if (!path.ends_with(".obj") && !path.ends_with(".ply") && !path.ends_with(".glb"))
          throw UsageError("a mesh file ends in .obj, .ply or .glb");
      }))
      ->type_name("FILE");
  app.add_flag("-q,--quiet", o.quiet, "say nothing but errors");
}

void add_probe_options(CLI::App& app, ProbeOptions& o) {
  add_parsed(app, "PIXEL", "X,Y", "x,y of a pixel, from the top left corner", [&o](const std::string& t) {
    std::tie(o.x, o.y) = parse_pixel(t);
  })->required();
  app.add_option("--samples", o.samples, "samples to follow, one after another")->check(CLI::Range(1, 1 << 20));
}

void add_convert_options(CLI::App& app, ConvertOptions& o) {
  app.add_option("FILE", o.input, "pbrt, gltf, glb, obj or ply, by extension")
      ->required()
      ->check(checked_by([](const std::string& path) {
        constexpr std::string_view known[] = {".pbrt", ".gltf", ".glb", ".obj", ".ply"};
        if (std::ranges::none_of(known, [&](std::string_view end) { return path.ends_with(end); }))
          throw UsageError("what is converted ends in .pbrt, .gltf, .glb, .obj or .ply");
      }));
  app.add_option("-o,--output", o.output, "scene file; its meshes and images go to a folder of its name")
      ->required()
      ->type_name("FILE");
  app.add_flag("-q,--quiet", o.quiet, "say nothing of what is left out");
}

void place_help_option(CLI::App& app) { app.get_help_ptr()->group(report_group); }

void add_render_options(CLI::App& app, RenderOptions& o) {
  add_aov_option(app, o);
  add_long_options(app, o);
  add_expand_option(app, o);
  add_report_options(app, o);
}

}  // namespace meristem
