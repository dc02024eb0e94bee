#pragma once

#include <cstddef>

namespace ink {

/// Bytes that this process may still take without anything being killed or swapped out: what the
/// machine has free, within the limits of the container and of the process. Infinite where none of
/// them can be told.
double free_memory_bytes();

/// Asks the system for large pages for memory that was not written to yet, if it is worth it: they
/// are there in a tenth of the time.
void use_large_pages(const void* begin, std::size_t bytes);

/// Empties a vector or string and gives its memory back, which `= {}` keeps.
template <class Values>
void release(Values& values) {
    Values().swap(values);
}

/// Room in large pages for `count` entries of a vector or characters of a string.
template <class Values>
void reserve_large(Values& values, std::size_t count) {
    values.reserve(count);
    use_large_pages(values.data() + values.size(),
                    (values.capacity() - values.size()) * sizeof(*values.data()));
}

}  // namespace ink
