#include "session/keep_memory.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace inktrace::viewer {

void keep_memory() {
#ifdef __GLIBC__
    constexpr int kMegabyte = 1 << 20;
    mallopt(M_MMAP_THRESHOLD, 32 * kMegabyte);  // its greatest value
    mallopt(M_TRIM_THRESHOLD, 128 * kMegabyte);
#endif
}

}  // namespace inktrace::viewer
