#include "lines/edge_balls.h"

#include <algorithm>

#include "sampling/surface_key.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/edge_balls.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Integers = hn::RebindToSigned<Floats>;
using Numbers = hn::RebindToUnsigned<Floats>;
constexpr Floats kFloats;
constexpr Integers kIntegers;
constexpr Numbers kNumbers;
constexpr int kStep = static_cast<int>(hn::MaxLanes(Floats()));

/// What points of the grid, by their indices, saw.
HWY_INLINE void find_end(const SampleGrid& grid, const BallTable& table, hn::Vec<Integers> point,
                         int i, BallLanes& balls, EdgeEnds& ends) {
    const auto id = hn::BitCast(
        kNumbers,
        hn::GatherIndex(kIntegers, reinterpret_cast<const std::int32_t*>(grid.id.data()), point));
    const auto hit = hn::Ne(id, hn::Set(kNumbers, kBackground));
    const auto seen = hn::RebindMask(kFloats, hit);
    const auto primitive = hn::IfThenElseZero(hit, hn::Sub(id, hn::Set(kNumbers, table.first)));
    hn::Store(id, kNumbers, ends.id.data() + i);
    hn::Store(primitive, kNumbers, ends.primitive.data() + i);
    hn::Store(hn::IfThenElse(hit, hn::Set(kNumbers, table.object),
                             hn::Set(kNumbers, SurfaceKey::kNothing)),
              kNumbers, ends.object.data() + i);
    const auto first = hn::ShiftLeft<2>(hn::BitCast(kIntegers, primitive));
    const auto put = [&](const float* from, auto index, Lanes<float>& to) {
        hn::Store(hn::IfThenElseZero(seen, hn::GatherIndex(kFloats, from, index)), kFloats,
                  to.data() + i);
    };
    put(table.balls, first, balls.x);
    put(table.balls + 1, first, balls.y);
    put(table.balls + 2, first, balls.z);
    put(table.balls + 3, first, balls.radius);
    put(grid.t.data(), point, balls.t);
}

void find_edges(const SampleGrid& grid, std::span<const SuspectEdge> edges, const BallTable& table,
                EdgeLanes& lanes, EdgeEnds& first, EdgeEnds& second) {
    Lanes<std::int32_t> column;
    Lanes<std::int32_t> row;
    Lanes<std::int32_t> down;
    for (int k = 0; k < kLanes; ++k) {
        // Lanes without an edge repeat the last one.
        const SuspectEdge& edge = edges[std::min(static_cast<std::size_t>(k), edges.size() - 1)];
        column[k] = edge.i;
        row[k] = edge.j;
        down[k] = edge.down ? 1 : 0;
    }
    const auto width = hn::Set(kIntegers, grid.width);
    const auto one = hn::Set(kIntegers, 1);
    const auto place = [&](auto at, int from) {
        const auto number = hn::ConvertTo(kFloats, hn::Add(at, hn::Set(kIntegers, from)));
        return hn::Mul(hn::Add(number, hn::Set(kFloats, 0.5F)), hn::Set(kFloats, grid.spacing));
    };
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = hn::Load(kIntegers, column.data() + i);
        const auto y = hn::Load(kIntegers, row.data() + i);
        const auto below = hn::Load(kIntegers, down.data() + i);
        const auto beside = hn::Sub(one, below);
        hn::Store(place(x, grid.x0), kFloats, lanes.ax.data() + i);
        hn::Store(place(y, grid.y0), kFloats, lanes.ay.data() + i);
        hn::Store(place(hn::Add(x, beside), grid.x0), kFloats, lanes.bx.data() + i);
        hn::Store(place(hn::Add(y, below), grid.y0), kFloats, lanes.by.data() + i);
        const auto point = hn::Add(hn::Mul(y, width), x);
        const auto next = hn::Add(point, hn::Add(hn::Mul(below, width), beside));
        find_end(grid, table, point, i, lanes.first, first);
        find_end(grid, table, next, i, lanes.second, second);
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_edges);

void find_edge_balls(const SampleGrid& grid, std::span<const SuspectEdge> edges,
                     const BallTable& table, EdgeLanes& lanes, EdgeEnds& first, EdgeEnds& second) {
    HWY_DYNAMIC_DISPATCH(find_edges)(grid, edges, table, lanes, first, second);
}

}  // namespace ink

#endif
