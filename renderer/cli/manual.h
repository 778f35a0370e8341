// What is written of the commands and their options: --help, the manual page, the completion of bash. All from the
// options as they are declared (options.h).
#pragma once

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace meristem {

// --help that fits a screen: a line of at most 80 columns for each option.
std::shared_ptr<CLI::FormatterBase> help_formatter();

// meristem(1), for man: roff with the macros of man(7).
std::string manual_page(const CLI::App& app);

// Words, between blanks, that completion offers as values of an option or argument. They forbid no others.
CLI::Option* offer(CLI::Option* option, const std::string& words);

// For bash: complete commands, options, the values of those that have a few, and files by what is made of them.
std::string bash_completion(const CLI::App& app);

}  // namespace meristem
