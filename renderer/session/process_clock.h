// What the system knows about this process: its age and its memory. Any thread. Linux.
#pragma once

#include <cstdint>

namespace meristem {

// Seconds since the process was started: what a user waits, the loading of libraries included. The start is known to
// half a hundredth of a second (/proc/self/stat, field 22); differences are as fine as the clock. Where /proc is not to
// be had the start is that of this library's initialisation.
double process_age_s();

// The most memory that was ever resident (VmHWM), in bytes; 0 if unknown.
std::uint64_t peak_resident_bytes();

}  // namespace meristem
