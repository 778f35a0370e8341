#include "renderer/cli/manual.h"

#include "renderer/report/version.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace meristem {

namespace {

constexpr std::size_t help_columns = 28;
// Before the words of offer() in the name of an option's type, where CLI11 puts what its checks say of themselves.
constexpr std::string_view offer_mark = ":offered ";

// Without the ranges that CLI11 adds: "FLOAT:FLOAT in [0 - 1]" is "FLOAT".
std::string type_of(const CLI::Option& option) {
  if (option.get_type_size() == 0) return "";
  const std::string type = option.get_type_name();
  std::size_t end = type.size();
  constexpr std::string_view said_by_checks[] = {":INT in", ":FLOAT in", ":UINT in", ":{", offer_mark};
  for (const std::string_view range : said_by_checks) end = std::min(end, type.find(range));
  return type.substr(0, end);
}

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(help_columns); }
  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string type = type_of(*option);
    return option->get_positional() || type.empty() ? "" : " " + type;
  }
  // Without a heading: a line less on the screen.
  std::string make_positionals(const CLI::App* app) const override {
    std::string text;
    for (const CLI::Option* o : app->get_options([](const CLI::Option* p) { return p->get_positional(); }))
      text += make_option(o, true);
    return text.empty() ? text : "\n" + text;
  }
  // One blank line between groups, not two.
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    return CLI::detail::find_and_replace(CLI::Formatter::make_help(app, name, mode), "\n\n\n", "\n\n");
  }
};

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* o) { return o->nonpositional() && !o->get_group().empty(); });
}

// Text of a manual page: backslashes, hyphens that are typed, and dots at the beginning of lines mean something to
// roff.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n'))
      result += fmt::format("\\&{}", c);
    else
      result += c;
  }
  return result;
}

std::vector<std::string> spellings_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string option_entry(const CLI::Option& option) {
  const std::string type = type_of(option);
  return fmt::format(".TP\n.BR \"{}\"{}\n{}\n", roff(fmt::format("{}", fmt::join(spellings_of(option), ", "))),
                     type.empty() ? "" : fmt::format(" \" {}\"", roff(type)), roff(option.get_description()));
}

std::string command_section(const CLI::App& command) {
  std::string usage = command.get_name();
  for (const CLI::Option* o : command.get_options([](const CLI::Option* p) { return p->get_positional(); }))
    usage += o->get_required() ? " " + o->get_name(true) : fmt::format(" [{}]", o->get_name(true));
  std::string text = fmt::format(".SS {}\n{}.\n", roff("meristem " + usage), roff(command.get_description()));
  for (const CLI::Option* option : options_of(command)) text += option_entry(*option);
  return text;
}

// Values that can be completed, between blanks: those that are offered, or "8|16".
std::string choices_of(const CLI::Option& option) {
  const std::string whole = option.get_type_name();
  if (const std::size_t at = whole.find(offer_mark); at != whole.npos) return whole.substr(at + offer_mark.size());
  std::string type = type_of(option);
  if (type.find('|') == type.npos) return {};
  std::ranges::replace(type, '|', ' ');
  return type;
}

// Extensions of files that an argument can name.
std::string extensions_of(const CLI::Option& argument) {
  const std::string name = argument.get_name(true);
  return name == "SCENE" ? "jsonc json" : name == "FILM" ? "film" : name == "FILE" ? "pbrt gltf glb obj ply" : "";
}

std::string option_words(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : options_of(app))
    for (const std::string& name : option->get_lnames()) words += (words.empty() ? "--" : " --") + name;
  return words;
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

std::string manual_page(const CLI::App& app) {
  std::string text = fmt::format(".TH MERISTEM 1 \"\" \"meristem {}\" \"User Commands\"\n", version);
  text += fmt::format(".SH NAME\nmeristem \\- {}\n",
                      roff(app.get_description().substr(app.get_description().find(' ') + 1)));
  text += ".SH SYNOPSIS\n.B meristem\n.I COMMAND\n[\\fIOPTIONS\\fR]\n.SH COMMANDS\n";
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    text += command_section(*command);
  text += fmt::format(".SH EXIT STATUS\n{}\n", roff(app.get_footer()));
  text +=
      ".SH SIGNALS\nINT, TERM: stop; the images so far and a film to go on from are written. "
      "A second INT within two seconds ends at once.\n.br\nHUP, USR1: write images and film, and go on.\n";
  text += ".SH ENVIRONMENT\n.TP\n.B OCIO\nan OpenColorIO configuration in place of the built\\-in one\n";
  return text;
}

CLI::Option* offer(CLI::Option* option, const std::string& words) {
  return option->check(
      CLI::Validator([](std::string&) { return std::string(); }, std::string(offer_mark.substr(1)) + words, "offer"));
}

std::string bash_completion(const CLI::App& app) {
  std::string commands, options, values, others, arguments;  // others: options of which no value is known
  const auto add_once = [](std::string& list, const std::string& entry) {
    if (list.find(entry) == std::string::npos) list += entry;
  };
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string name = command->get_name();
    commands += (commands.empty() ? "" : " ") + name;
    options += fmt::format("          {}) words=\"{}\" ;;\n", name, option_words(*command));
    for (const CLI::Option* option : command->get_options()) {
      const std::string choices = choices_of(*option), type = type_of(*option);
      const std::string found = !choices.empty()      ? fmt::format("words=\"{}\"", choices)
                                : type == "FILE"      ? "files=\"*\""
                                : type == "DIRECTORY" ? "files=\"/\""
                                                      : "";
      if (option->get_positional()) {
        const std::string extensions = extensions_of(*option);
        if (!choices.empty() || !extensions.empty())
          add_once(arguments, fmt::format("          {}) {} ;;\n", name,
                                          choices.empty() ? fmt::format("files=\"{}\"", extensions) : found));
      } else if (!type.empty()) {
        for (const std::string& spelling : spellings_of(*option))
          add_once(found.empty() ? others : values,
                   found.empty() ? spelling + "|" : fmt::format("    {}) {} ;;\n", spelling, found));
      }
    }
  }
  return fmt::format(R"(# bash completion for meristem, made by `meristem completion`
_meristem() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} words= files= end
  COMPREPLY=()
  # "=" is a word of its own
  if [[ $word == "=" ]]; then word=; elif [[ $before == "=" ]]; then before=${{COMP_WORDS[COMP_CWORD-2]}}; fi
  case $before in
{}    {}=) return ;;
    *)
      if [[ $COMP_CWORD == 1 ]]; then
        words="{}"
      elif [[ $word == -* ]]; then
        case ${{COMP_WORDS[1]}} in
{}        esac
      else
        case ${{COMP_WORDS[1]}} in
{}        esac
      fi ;;
  esac
  if [[ -n $words ]]; then
    # Of a list the last
    [[ $word == *,* ]] && words=$(printf "${{word%,*}},%s " $words)
    # Blanks in words are quoted as those of files are
    [[ $words == *\\* ]] && compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  elif [[ -n $files ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <({{
      compgen -d -- "$word"
      set -f
      for end in $files; do
        case $end in
          /) ;;
          "*") compgen -f -- "$word" ;;
          *) compgen -f -X "!*.$end" -- "$word" ;;
        esac
      done
    }} | sort -u)
  fi
}}
complete -F _meristem meristem
)",
                     values, others, commands, options, arguments);
}

}  // namespace meristem
