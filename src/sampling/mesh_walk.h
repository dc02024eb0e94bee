#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/projection.h"
#include "sampling/surface_key.h"
#include "sampling/walk_lanes.h"
#include "scene/scene.h"

namespace ink {

/// A walk that is wanted: from the triangle that its line's first point sees, or its second.
struct Walk {
    std::uint32_t line;  ///< its number
    SurfaceKey from;
    std::uint32_t target = kNoTarget;  ///< a triangle at which it has arrived
    double limit;                      ///< along the way, which is of length 1
    bool backwards = false;            ///< from the line's second point to its first

    static constexpr std::uint32_t kNoTarget = 0xFFFFFFFFU;
};

/// The triangles that a way crosses, beginning with that which its first point sees, each from
/// where it is entered on.
class MeshWay {
  public:
    MeshWay(const WalkRow* rows, const WalkEnds& ends, std::size_t lane, bool backwards);

    WalkEnd end() const { return end_; }
    bool ends() const { return end_ == WalkEnd::turned || end_ == WalkEnd::rim; }
    /// The edge at which it ends.
    const Feet& last() const { return last_; }
    double from_start(double along_line) const {
        return backwards_ ? 1.0 - along_line : along_line;
    }

    double end_at() const { return at(count_ - 1); }
    /// Of walls that are seen edge on, the near end counts.
    double end_nearness() const;
    double nearness(double at) const;

    /// The last step says where the way ends.
    std::size_t count() const { return count_; }
    double at(std::size_t step) const { return rows_[step].at[lane_]; }
    double step_nearness(std::size_t step) const { return rows_[step].nearness[lane_]; }
    std::uint32_t triangle(std::size_t step) const { return rows_[step].triangle[lane_]; }
    /// By which edge of the triangle before it is entered.
    std::uint32_t edge(std::size_t step) const { return rows_[step].edge[lane_]; }

  private:
    const WalkRow* rows_;
    std::uint32_t lane_, count_;
    WalkEnd end_;
    bool backwards_;
    Feet last_;
};

/// Memory of walks, which is kept from one call to the next.
class WalkMemory {
  public:
    void clear() { used_ = 0; }
    /// For the steps of one more group.
    WalkRow* rows();

    std::array<WalkStarts, kMostWalkGroups> starts;
    std::array<WalkEnds, kMostWalkGroups> ends;

  private:
    std::vector<std::unique_ptr<WalkRow[]>> groups_;
    std::size_t used_ = 0;
};

/// Walks across the meshes that points of the screen see, from triangle to triangle along a way on
/// the screen, until the surface turns away or ends.
class MeshWalk {
  public:
    /// `normals`: which ones creases are found by, of objects that name none of their own.
    MeshWalk(const Scene& scene, const Projection& projection, NormalSource normals);

    const Projection& projection() const { return projection_; }
    const WayView& view() const { return view_; }

    /// Whether there is a mesh to walk on, which knows what lies beside each of its edges.
    bool knows(std::uint32_t object) const { return surfaces_[object].mesh != nullptr; }

    /// Adds a way for each walk, in their order. Of the objects they begin on `knows` must hold.
    /// They hold until the memory is cleared.
    void walk(std::span<const Walk> walks, std::span<const WayLine> lines, WalkMemory& memory,
              std::vector<MeshWay>& ways) const;

    struct Crease {
        float turn = 0.0F;  ///< of the normal, as the chord on the unit sphere; 0: there is none
        double at = 0.0, nearness = 0.0;
        Feet feet{};
    };
    /// The sharpest on a way.
    Crease sharpest_crease(std::uint32_t object, const WayLine& line, const MeshWay& way) const;

  private:
    /// A mesh as creases of it are found.
    struct Surface {
        const Mesh* mesh = nullptr;              ///< null: nothing to walk on
        const std::uint32_t* normals = nullptr;  ///< packed, a corner; null: those of the facets
        bool creases_flagged = true;             ///< only where the mesh says so

        Vec3f normal(std::uint32_t edge, double share) const;
        float turn_across(std::uint32_t edge, double share) const;
    };

    Projection projection_;
    WayView view_;
    std::vector<Surface> surfaces_;  ///< of each object
};

}  // namespace ink
