#pragma once

#include <stdexcept>
#include <string_view>
#include <variant>

#include "accel/tracer.h"
#include "render/render.h"

namespace ink::test {

inline Film draw(const Scene& scene, const Settings& settings, const PixelFormats& formats = {}) {
    const auto tracer = make_tracer(scene);
    return render(scene, *tracer, settings, formats);
}

/// A float plane of a film by its channel's name.
inline const Plane<float>& plane(const Film& film, std::string_view name) {
    for (const Channel& channel : film.channels().channels) {
        if (channel.name == name) return std::get<Plane<float>>(channel.values);
    }
    throw std::logic_error("no such plane");
}

}  // namespace ink::test
