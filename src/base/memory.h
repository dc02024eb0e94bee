#pragma once

namespace ink {

/// Bytes that this process may still take without anything being killed or swapped out: what the
/// machine has free, within the limits of the container and of the process. Infinite where none of
/// them can be told.
double free_memory_bytes();

}  // namespace ink
