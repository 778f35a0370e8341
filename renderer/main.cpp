#include "renderer/cli/command_line.h"

int main(int argc, char** argv) { return meristem::run_command_line(argc, argv); }
