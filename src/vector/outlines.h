#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lines/chain.h"
#include "lines/curve.h"

namespace ink {

/// A chain walked so that the region lies on its left.
struct Use {
    GeometryId id;
    std::uint32_t chain;
    bool reversed;
};

/// The rectangle that was searched. Places on its border are counted the way that has the inside on
/// the left: down the left side from the upper left corner, then along the bottom, in [0, 4).
class Border {
  public:
    Border(Vec2f lower, Vec2f upper) : lower_(lower), upper_(upper) {}

    /// Nothing for a point inside.
    std::optional<float> place(Vec2f p) const;
    std::array<Vec2f, 4> corners() const {
        return {lower_, {lower_.x, upper_.y}, upper_, {upper_.x, lower_.y}};
    }
    /// Goes along the border from one place to another.
    void follow(float from, float to, Curve& outline) const;

  private:
    Vec2f lower_, upper_;
};

/// Joins the uses of one geometry into closed outlines.
class Outliner {
  public:
    Outliner(const ChainGraph& graph, std::span<const Curve> curves, const Border& border)
        : graph_(graph), curves_(curves), border_(border) {}

    std::vector<Curve> outlines(std::span<const Use> uses);
    /// Whether any geometry so far goes on beyond the border.
    bool touched_border() const { return touched_border_; }

  private:
    struct Open {
        Curve curve;
        std::optional<float> first, last;  ///< places on the border
    };

    std::uint32_t start(const Use& use) const {
        const Chain& chain = graph_.chains[use.chain];
        return use.reversed ? chain.last_vertex : chain.first_vertex;
    }
    std::uint32_t finish(const Use& use) const { return start({use.id, use.chain, !use.reversed}); }
    Curve curve(const Use& use) const {
        return use.reversed ? reversed(curves_[use.chain]) : curves_[use.chain];
    }
    std::optional<std::size_t> unused_from(std::uint32_t vertex) const;
    void join(std::size_t first);
    std::vector<std::size_t> follow_ups() const;
    void close_open_runs();

    const ChainGraph& graph_;
    std::span<const Curve> curves_;
    const Border& border_;
    std::vector<Use> uses_;  ///< by the vertex at which they start
    std::vector<std::uint8_t> used_;
    std::vector<Curve> closed_;
    std::vector<Open> open_;
    bool touched_border_ = false;
};

/// Goes on straight to a point.
void append_straight(Curve& outline, Vec2f to);

}  // namespace ink
