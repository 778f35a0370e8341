#include "geometry/base/huge_pages.h"
#include "renderer/cli/command_line.h"

int main(int argc, char** argv) {
  meristem::restart_with_huge_pages(argv);
  return meristem::run_command_line(argc, argv);
}
