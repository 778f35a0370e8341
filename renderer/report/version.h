// The version that the program, its statistics and its images name. Kept equal to that of the build files by a test.
#pragma once

namespace meristem {

constexpr const char* version = "0.1.0";

}  // namespace meristem
