#include "geometry/base/freed_memory.h"

#include <malloc.h>

namespace meristem {

void give_back_freed_memory() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
}

}  // namespace meristem
