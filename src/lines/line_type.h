#pragma once

#include <cstdint>

namespace ink {

/// What a line marks.
enum class LineType : std::uint8_t {
    silhouette,      ///< the geometry ID changes and the surfaces do not meet
    intersection,    ///< the geometry ID changes and the surfaces meet
    self_occlusion,  ///< one geometry, its depth jumps
    crease,          ///< one geometry, its normal jumps
    boundary,        ///< a surface ends at an open edge, in front of whatever is behind
    mesh,            ///< one geometry, the face of the mesh changes
    ridge            ///< view-dependent curvature is maximal: an apparent ridge
};

inline constexpr int kLineTypes = 7;

/// A set of line types.
class LineTypes {
  public:
    static constexpr LineTypes all() {
        LineTypes types;
        types.bits_ = (1U << kLineTypes) - 1U;
        return types;
    }
    /// All but those that are drawn only on request.
    static constexpr LineTypes usual() {
        LineTypes types = all();
        types.bits_ &= ~(1U << index(LineType::mesh) | 1U << index(LineType::ridge));
        return types;
    }
    constexpr bool has(LineType type) const { return (bits_ >> index(type) & 1U) != 0; }
    constexpr void add(LineType type) { bits_ |= 1U << index(type); }
    constexpr bool empty() const { return bits_ == 0; }
    constexpr bool operator==(const LineTypes&) const = default;

  private:
    static constexpr unsigned index(LineType type) { return static_cast<unsigned>(type); }
    unsigned bits_ = 0;
};

}  // namespace ink
