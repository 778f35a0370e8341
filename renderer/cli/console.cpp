#include "renderer/cli/console.h"

#include "renderer/image/atomic_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <tuple>

namespace meristem {

namespace {

std::string as_lines(const std::string& text) { return text.ends_with('\n') ? text : text + '\n'; }

}  // namespace

void print_result(const std::string& text) {
  const std::string lines = as_lines(text);
  if (std::fwrite(lines.data(), 1, lines.size(), stdout) != lines.size() || std::fflush(stdout) != 0)
    throw FileError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
}

void print_error(const std::string& text) {
  // Where nobody can be told, there is nothing to be done about it
  std::ignore = std::fputs(as_lines(text).c_str(), stderr);
}

void print_diagnostics(const std::vector<Diagnostic>& list) {
  for (const Diagnostic& diagnostic : list) print_error(diagnostic.formatted());
}

}  // namespace meristem
