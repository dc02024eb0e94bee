#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "sampling/optics.h"
#include "scene/ids.h"

namespace ink {

/// Numbers specular paths, so that two are equal exactly when they met the same geometries in the
/// same order and left each of them in the same way. Numbers mean something within one table only.
class PathTable {
  public:
    using Path = std::uint32_t;
    static constexpr Path kStart = 0xFFFFFFFFU;  ///< the empty one: that of a camera ray

    /// The path that goes on from the geometry `id`, at which `path` arrived.
    Path extended(Path path, GeometryId id, Bend bend) { return number({path, id, bend}); }
    /// A number for geometry `id` as seen at the end of `path`; never kBackground.
    GeometryId seen(Path path, GeometryId id) { return number({path, id, Bend::none}); }

    /// What such a number stands for. kBackground has the path kStart.
    GeometryId geometry(GeometryId seen) const {
        return seen == kBackground ? kBackground : entries_[seen - 1].id;
    }
    Path path(GeometryId seen) const {
        return seen == kBackground ? kStart : entries_[seen - 1].path;
    }
    void clear() {
        entries_.clear();
        numbers_.clear();
    }

  private:
    struct Entry {
        Path path;
        GeometryId id;
        Bend bend;
        friend bool operator==(const Entry&, const Entry&) = default;
    };
    struct Hash {
        std::size_t operator()(const Entry& entry) const {
            const std::uint64_t low =
                std::uint64_t{entry.id} << 3U | static_cast<unsigned>(entry.bend);
            const std::uint64_t mixed =
                (low ^ std::uint64_t{entry.path} << 32U) * 0x9E3779B97F4A7C15U;
            return mixed ^ mixed >> 29U;
        }
    };
    std::uint32_t number(const Entry& entry) {
        const auto [at, is_new] =
            numbers_.try_emplace(entry, static_cast<std::uint32_t>(entries_.size()) + 1);
        if (is_new) entries_.push_back(entry);
        return at->second;
    }

    std::vector<Entry> entries_;
    std::unordered_map<Entry, std::uint32_t, Hash> numbers_;
};

}  // namespace ink
