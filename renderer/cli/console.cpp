#include "renderer/cli/console.h"

#include "renderer/image/atomic_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace meristem {

namespace {

std::string as_lines(const std::string& text) { return text.ends_with('\n') ? text : text + '\n'; }

}  // namespace

void print_result(const std::string& text) {
  const std::string lines = as_lines(text);
  if (std::fwrite(lines.data(), 1, lines.size(), stdout) != lines.size() || std::fflush(stdout) != 0)
    throw FileError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
}

void print_error(const std::string& text) { fmt::print(stderr, "{}", as_lines(text)); }

void print_diagnostics(const std::vector<Diagnostic>& list) {
  for (const Diagnostic& diagnostic : list) print_error(diagnostic.formatted());
}

}  // namespace meristem
