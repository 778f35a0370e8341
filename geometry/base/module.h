// Modules: what only some runs need and takes long to load is not part of the program but of a shared library beside it
// (for programs of the build folder's tests, one folder above), opened at first use. Program and module are built
// together; between them pass interfaces and exceptions.
#pragma once

#include <filesystem>

namespace meristem {

// Where the module of that file name lies. Throws a std::runtime_error that names file and folder if it is missing.
std::filesystem::path module_path(const char* file);

// Opens the module, which stays open, and returns what it exports by that name. Throws a std::runtime_error.
void* open_module(const char* file, const char* entry);

}  // namespace meristem
