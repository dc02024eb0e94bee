#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lines/segment.h"
#include "scene/ids.h"

namespace ink {

/// What compositing programs may want to know of the lines on a rectangle of pixels, taken at the
/// pixels' centres. Plane by plane, row by row, without gaps.
class LinePlanes {
  public:
    /// Clears the planes and moves them to pixels [x0, x0 + width) x [y0, y0 + height).
    void begin(int x0, int y0, int width, int height);
    /// Adds a line of that width, pixels.
    void add(const Segment& segment, float width);

    struct Line {
        float t;  ///< as in Segment
        LineType type;
        GeometryId near, far;
        std::uint32_t level = 0;
    };
    /// Adds one of that width to pixel (x, y) of the rectangle, at a distance from its centre.
    void add(int x, int y, float distance, float width, const Line& line);

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }
    /// To the middle of the nearest line that inks the pixel, pixels; infinite where none does.
    const std::vector<float>& distance() const { return distance_; }
    /// Of the line on top: 1 plus its LineType, or 0.
    const std::vector<std::uint32_t>& type() const { return type_; }
    /// Of the line on top: the geometry that it belongs to, and the one on its other side.
    const std::vector<std::uint32_t>& near_id() const { return near_id_; }
    const std::vector<std::uint32_t>& far_id() const { return far_id_; }
    /// Of the line on top: Segment::level.
    const std::vector<std::uint32_t>& level() const { return level_; }

  private:
    int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
    std::vector<float> distance_;
    std::vector<float> t_;  ///< of the line on top
    std::vector<std::uint32_t> type_, near_id_, far_id_, level_;
};

}  // namespace ink
