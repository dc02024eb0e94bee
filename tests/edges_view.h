#pragma once

#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "io/reader.h"
#include "paths.h"
#include "render/render.h"

/// Views in which a scene unit is a pixel, and what is read off the pictures.
namespace ink::test {

inline constexpr double kDegrees = std::numbers::pi / 180.0;

/// Orthographic, straight on, one scene unit a pixel, the origin in the middle of the picture.
inline Settings plan_view(Size size, double width_px = 3.0) {
    Settings settings;
    settings.size = size;
    settings.view.view = View::front;
    settings.view.eye = Vec3d{0, 0, 100};
    settings.view.look_at = Vec3d{0, 0, 0};
    settings.view.orthographic = static_cast<double>(size.height);
    settings.aovs = {Aov::lines};
    settings.line_width = {width_px, Length::Unit::px};
    settings.threads = 2;
    return settings;
}

inline void set(Settings& settings, std::string_view name, std::string_view value) {
    find_setting(name).set(settings, value);
}

inline Scene acetaminophen() {
    return Scene(read_file(source_dir() / "samples/acetaminophen.xyz").objects);
}

inline std::size_t at(Size size, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
           static_cast<std::size_t>(x);
}

inline double mean_difference(const Plane<float>& a, const Plane<float>& b) {
    EXPECT_EQ(a.size(), b.size());
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
    return sum / static_cast<double>(a.size());
}

inline double mean(const Plane<float>& values) {
    double sum = 0.0;
    for (const float value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace ink::test
