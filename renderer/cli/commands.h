// The commands beside `render`. Each returns an exit code and throws what run_command_line() catches.
#pragma once

#include "renderer/cli/render_command.h"
#include "renderer/report/comparison.h"

#include <string>
#include <vector>

namespace meristem {

struct CompareOptions {
  std::string scene;
  int runs = 1;
  bool json = false;
  std::vector<BudgetChoice> budgets;        // none: lazy with the scene's own
  std::string page;                         // HTML file; empty: none
  std::vector<std::string> render_options;  // passed on
  std::string command_line;
};

struct ProfileOptions {
  std::string scene;
  std::string page;                         // HTML file; empty: the scene's name with .html in the current folder
  std::string statistics, trace;            // empty: none
  std::vector<std::string> render_options;  // passed on
  std::string command_line;
};

int compare_command(const CompareOptions& options);
int profile_command(const ProfileOptions& options);
int check_command(const std::string& scene, const SceneLoader& load);
int describe_command(const std::string& name);
int describe_markdown_command();
std::vector<std::string> component_names();  // of components and their kinds
int schema_command();

}  // namespace meristem
