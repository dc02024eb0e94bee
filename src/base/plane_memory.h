#pragma once

#include <cstddef>

namespace ink {

/// Memory for a plane of a picture: not cleared, on a border of 64 bytes, and in large pages where
/// it is large. What is
/// given back is kept for the next plane of that size, up to a limit, so that pictures drawn one
/// after the other do not wait for the system to clear pages. Throws std::bad_alloc. For any
/// thread.
void* take_plane_memory(std::size_t bytes);
void give_plane_memory(void* begin, std::size_t bytes) noexcept;

}  // namespace ink
