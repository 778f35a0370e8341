#include "renderer/cli/command_line.h"

#include "geometry/base/source.h"
#include "renderer/cli/commands.h"
#include "renderer/cli/console.h"
#include "renderer/cli/manual.h"
#include "renderer/cli/merge_command.h"
#include "renderer/cli/options.h"
#include "renderer/color/color.h"
#include "renderer/report/version.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <new>
#include <span>
#include <string_view>
#include <vector>

namespace meristem {

namespace {

constexpr const char* footer =
    "Exit codes: 0 done, 1 internal error, 2 usage or scene, 3 limit or render fault\n"
    "(image written), 4 file, 130 and 143 interrupted (image so far written).";

std::string hint_at(std::string_view word, const std::vector<std::string>& known) {
  const std::string_view near = nearest_name(word, known);
  return near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near);
}

// The program's options and where their values go.
class CommandLine {
 public:
  CommandLine(const std::string& text, const SceneLoader& load) : load_(load) {
    render_.command_line = merge_.command_line = text;
    app_.set_version_flag("--version", fmt::format("meristem {}", version));
    app_.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);  // as wrapping scripts expect
    app_.require_subcommand(1);
    app_.formatter(help_formatter());
    app_.footer(footer);
    add_render();
    add_merge();
    add_profile();
    add_compare();
    add_probe();
    add_export();
    add_convert();
    add_check();
    add_describe();
    app_.add_subcommand("schema", "the JSON Schema of scene files, for editors")->final_callback([this] {
      exit_code_ = schema_command();
    });
    add_printed("manual", "the manual page of the program, for man", [this] { return manual_page(app_); });
    add_printed("completion", "the completion of commands and options, for bash", [this] {
      offer(component_, fmt::format("{}", fmt::join(component_names(), " ")));
      return bash_completion(app_);
    });
  }
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // Parses, and runs the command that is named.
  int run(int argc, const char* const* argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (!words.empty() && words[0] == "help") {
      words.erase(words.begin());
      if (!words.empty() && !is_command(words[0])) return describe_command(words[0]);
      words.emplace_back("--help");
    }
    try {
      if (!words.empty() && !words[0].starts_with('-') && !is_command(words[0])) throw no_command(words[0]);
      std::ranges::reverse(words);  // as CLI11 wants them
      app_.parse(std::move(words));
    } catch (const CLI::ExtrasError& error) {
      return app_.exit(unexpected_words(error)), int(ExitCode::Usage);
    } catch (const CLI::ParseError& error) {
      return app_.exit(error) == 0 ? int(ExitCode::Done) : int(ExitCode::Usage);  // 0: --help, --version
    }
    return exit_code_;
  }

 private:
  std::vector<std::string> command_names() const {
    std::vector<std::string> names;
    for (const CLI::App* command : app_.get_subcommands([](const CLI::App*) { return true; }))
      names.push_back(command->get_name());
    return names;
  }

  bool is_command(const std::string& word) const {
    const std::vector<std::string> names = command_names();
    return std::ranges::find(names, word) != names.end();
  }

  CLI::ParseError no_command(const std::string& word) const {
    const std::vector<std::string> names = command_names();
    return CLI::ExtrasError(
        fmt::format("no command \"{}\"{}; there are: {}", word, hint_at(word, names), fmt::join(names, ", ")),
        CLI::ExitCodes::ExtrasError);
  }

  // The first word that the command does not know; what follows may be its value.
  CLI::ParseError unexpected_words(const CLI::ExtrasError& error) const {
    const auto commands = app_.get_subcommands();
    const std::vector<std::string> extras = commands.empty() ? app_.remaining() : commands[0]->remaining();
    const auto option = std::ranges::find_if(extras, [](const std::string& w) { return w.starts_with('-'); });
    if (commands.empty() || extras.empty()) return error;
    const std::string name = commands[0]->get_name();
    if (option == extras.end())
      return CLI::ExtrasError(fmt::format("{}: \"{}\" is one argument too many", name, extras[0]),
                              error.get_exit_code());
    std::vector<std::string> known;
    for (const CLI::Option* o : commands[0]->get_options())
      for (const std::string& n : o->get_lnames()) known.push_back("--" + n);
    const std::string given = option->substr(0, option->find('='));
    return CLI::ExtrasError(fmt::format("{} has no option {}{}", name, given, hint_at(given, known)),
                            error.get_exit_code());
  }

  void add_render() {
    CLI::App& command = *app_.add_subcommand("render", "render a scene to image files");
    add_scene_argument(command, render_.scene);
    add_scene_options(command, render_);
    add_output_options(command, render_.outputs);
    add_render_options(command, render_);
    place_help_option(command);
    command.footer(footer);
    command.final_callback([this] { exit_code_ = render_command(render_, load_); });
  }

  void add_merge() {
    CLI::App& command = *app_.add_subcommand("merge", "films of the same image with other samples become one");
    command.add_option("FILM", merge_.films, "film files")->required()->take_all();
    add_output_options(command, merge_.outputs);
    command.get_option("--output")->required();
    command.add_flag("-q,--quiet", merge_.quiet, "say nothing but errors");
    command.final_callback([this] { exit_code_ = merge_command(merge_); });
  }

  void add_profile() {
    CLI::App& command = *app_.add_subcommand("profile", "render; an HTML page of what lazy expansion did");
    profile_.command_line = render_.command_line;
    add_scene_argument(command, profile_.scene);
    add_profile_options(command, profile_);
    add_scene_options(command, profiled_);
    command.final_callback([this, &command] {
      profile_.render_options = given_scene_options(command);
      exit_code_ = profile_command(profile_);
    });
  }

  void add_compare() {
    CLI::App& command =
        *app_.add_subcommand("compare", "render lazily, eagerly and flat; compare time, memory and image");
    add_scene_argument(command, compare_.scene);
    compare_.command_line = render_.command_line;
    add_compare_options(command, compare_);
    add_scene_options(command, compared_);
    command.final_callback([this, &command] {
      compare_.render_options = given_scene_options(command);
      exit_code_ = compare_command(compare_);
    });
  }

  void add_probe() {
    CLI::App& command = *app_.add_subcommand("probe", "what one pixel shows, and what its rays expand");
    add_scene_argument(command, probed_.scene);
    add_probe_options(command, probed_);
    add_view_options(command, probed_.load);
    command.final_callback([this] { exit_code_ = probe_command(probed_, load_); });
  }

  void add_export() {
    CLI::App& command = *app_.add_subcommand("export", "write the expanded geometry as a mesh file");
    add_scene_argument(command, exported_.scene);
    add_export_options(command, exported_);
    add_view_options(command, exported_.load);
    command.final_callback([this] { exit_code_ = export_command(exported_, load_); });
  }

  void add_convert() {
    CLI::App& command = *app_.add_subcommand("convert", "make a scene file of pbrt-v4, glTF 2.0, OBJ or PLY");
    add_convert_options(command, converted_);
    command.final_callback([this] { exit_code_ = convert_command(converted_); });
  }

  void add_check() {
    CLI::App& command = *app_.add_subcommand("check", "report the errors of a scene, and how large its models are");
    add_scene_argument(command, checked_scene_);
    command.final_callback([this] { exit_code_ = check_command(checked_scene_, load_); });
  }

  void add_describe() {
    CLI::App& command = *app_.add_subcommand("describe", "manual pages of components; without NAME, their list");
    component_ = command.add_option("NAME", described_, "a component, or a kind of components");
    command.add_flag("--markdown", describe_markdown_, "all pages as one Markdown document")->excludes(component_);
    command.final_callback(
        [this] { exit_code_ = describe_markdown_ ? describe_markdown_command() : describe_command(described_); });
  }

  // A command that prints what is said of all of them.
  template <class Text>
  void add_printed(const char* name, const char* doc, Text text) {
    app_.add_subcommand(name, doc)->final_callback([text] { print_result(text()); });
  }

  const SceneLoader& load_;
  CLI::App app_{"Meristem: a ray-tracing renderer whose geometry grows where rays touch it", "meristem"};
  RenderOptions render_;
  RenderOptions compared_, profiled_;  // parsed for their errors; the children get the text
  CompareOptions compare_;
  ProfileOptions profile_;
  MergeOptions merge_;
  ProbeOptions probed_;
  ExportOptions exported_;
  ConvertOptions converted_;
  std::string checked_scene_, described_;
  CLI::Option* component_ = nullptr;  // that `describe` describes
  bool describe_markdown_ = false;
  int exit_code_ = 0;
};

// As it is typed: in metadata and reports the command line can be copied back to a shell.
std::string shell_word(const std::string& word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./:=,+%@^";
  if (!word.empty() && word.find_first_not_of(plain) == word.npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

int fail(ExitCode code, const std::string& message) {
  print_error("error: " + message);
  return int(code);
}

}  // namespace

int run_command_line(int argc, const char* const* argv, const SceneLoader& load) {
  try {
    std::vector<std::string> words;
    for (const char* word : std::span(argv, std::size_t(argc))) words.push_back(shell_word(word));
    const std::string text = fmt::format("{}", fmt::join(words, " "));
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
    return fail(ExitCode::Internal, "out of memory; --budget limits the geometry cache, --size the film");
  } catch (const std::exception& error) {
    return fail(ExitCode::Internal, fmt::format("internal: {}", error.what()));
  }
}

}  // namespace meristem
