// The commands beside `render`. Each returns an exit code and throws what run_command_line() catches.
#pragma once

#include "renderer/cli/render_command.h"

#include <string>
#include <vector>

namespace meristem {

struct CompareOptions {
  std::string scene;
  int runs = 1;
  bool json = false;
  std::vector<std::string> render_options;  // passed on
};

int compare_command(const CompareOptions& options);
int check_command(const std::string& scene, const SceneLoader& load);
int describe_command(const std::string& name);
int describe_markdown_command();
int schema_command();

}  // namespace meristem
