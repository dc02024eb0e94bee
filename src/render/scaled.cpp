#include "render/scaled.h"

#include <algorithm>
#include <cmath>

namespace ink {

Settings scaled(const Settings& settings, double factor) {
    Settings result = settings;
    const auto side = [&](int pixels) {
        return std::max(1, static_cast<int>(std::lround(pixels * factor)));
    };
    const auto scale = [&](Length& length) {
        if (length.unit == Length::Unit::px) length.value *= factor;
    };
    result.size = {side(settings.size.width), side(settings.size.height)};
    result.dpi *= factor;
    scale(result.line_width);
    scale(result.halo);
    scale(result.ridge_scale);
    scale(result.min_length);
    for (auto* rules : {&result.look_rules, &result.line_rules}) {
        for (LineRule& rule : *rules) {
            if (rule.width) scale(*rule.width);
        }
    }
    // A change a pixel.
    result.thresholds.crease_gradient /= static_cast<float>(factor);
    return result;
}

}  // namespace ink
