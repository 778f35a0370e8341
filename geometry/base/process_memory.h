// What the process holds of memory. Any thread.
#pragma once

#include <cstddef>

namespace meristem {

// Gives the whole pages that malloc holds and nobody uses back to the system: of all threads' heaps, also those between
// arrays that are used. A few milliseconds, while others that allocate wait; the pages come back as they are touched.
// Nothing where malloc cannot.
void give_back_freed_memory();

// What is resident now, in bytes, as the system counts it; 0 where it does not tell.
std::size_t resident_set_bytes();

// What the machine has, in bytes; 0 where it does not tell.
std::size_t machine_memory_bytes();

}  // namespace meristem
