#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "inktrace/inktrace.h"

namespace inktrace {

/// The range that the colours of a field show over several frames; nothing where colours come from
/// no field, or its values are all the same. `go_on` is told what share is done before each frame;
/// false ends it, with nothing. Throws Error (input).
inline std::optional<std::pair<double, double>> color_range_over(
    std::span<const std::filesystem::path> files, std::span<const int> frames, Settings settings,
    const std::function<bool(double share)>& go_on) {
    std::optional<std::pair<double, double>> all;
    for (std::size_t k = 0; k < frames.size(); ++k) {
        if (!go_on(static_cast<double>(k) / static_cast<double>(frames.size()))) return {};
        settings.set("frame", std::to_string(frames[k]));
        for (const std::filesystem::path& file : files) {
            const auto own = inspect(file, settings).color_range;
            if (!own || !(own->first <= own->second)) continue;
            if (!all) all = own;
            all->first = std::min(all->first, own->first);
            all->second = std::max(all->second, own->second);
        }
    }
    if (all && !(all->first < all->second)) return {};
    return all;
}

/// The field whose kinds of particles have a colour each in one of several frames, so that they do
/// in all; empty where there is none. `go_on` as for `color_range_over`.
inline std::string kinds_over(const std::filesystem::path& file, std::span<const int> frames,
                              Settings settings, const std::function<bool(double share)>& go_on) {
    for (std::size_t k = 0; k < frames.size(); ++k) {
        if (!go_on(static_cast<double>(k) / static_cast<double>(frames.size()))) return {};
        settings.set("frame", std::to_string(frames[k]));
        const FileInfo info = inspect(file, settings);
        if (info.kind_field.empty() || info.has_kinds) return info.kind_field;
    }
    return {};
}

}  // namespace inktrace
