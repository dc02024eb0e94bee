#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/plane_memory.h"

namespace ink {

struct Size {
    int width = 0, height = 0;
    std::size_t pixels() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    friend constexpr bool operator==(Size, Size) = default;
};

/// Leaves what a vector makes uninitialised: pixels are written once, by the thread that computes
/// them, and not filled with zeros by one thread before.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = UninitializedAllocator<U>;
    };
    template <class U>
    void construct(U* at) noexcept {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments) {
        ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
    }
};

/// The same, from memory that goes from picture to picture.
template <class T>
struct PlaneAllocator : UninitializedAllocator<T> {
    template <class U>
    struct rebind {
        using other = PlaneAllocator<U>;
    };
    T* allocate(std::size_t count) { return static_cast<T*>(take_plane_memory(count * sizeof(T))); }
    void deallocate(T* plane, std::size_t count) noexcept {
        give_plane_memory(plane, count * sizeof(T));
    }
};

/// A value for each pixel of a picture. Uninitialised unless told what to hold.
template <class T>
using Plane = std::vector<T, PlaneAllocator<T>>;
using Pixels = Plane<std::uint32_t>;

/// A finished picture for the screen: R, G, B, A bytes a pixel, rows from the top, sRGB-encoded
/// colour, straight (not premultiplied) alpha.
struct DisplayImage {
    Size size;
    Pixels pixels;  ///< R in the lowest byte
};

/// One named plane of a float or integer image, rows from the top.
struct Channel {
    std::string name;  ///< as EXR readers know it: "R", "Z", "N.X", "id.primitive"
    std::variant<Plane<float>, Plane<std::uint32_t>> values;
};

/// A picture as numbers: linear colour in R, G, B, A (premultiplied), and AOVs.
struct ChannelImage {
    Size size;
    std::vector<Channel> channels;
};

/// What a written file tells about itself, in order: ("Software", "Inktrace 0.1.0"), ...
using Metadata = std::vector<std::pair<std::string, std::string>>;

}  // namespace ink
