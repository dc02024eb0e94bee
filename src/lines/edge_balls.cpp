#include "lines/edge_balls.h"

#include <algorithm>

#include "sampling/surface_key.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/edge_balls.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// What points of the grid, by their indices, saw.
HWY_INLINE void find_end(const SampleGrid& grid, const BallTable& table, Integer point, int i,
                         BallLanes& balls, EdgeEnds& ends) {
    const auto id = hn::BitCast(
        kWords,
        hn::GatherIndex(kIntegers, reinterpret_cast<const std::int32_t*>(grid.id.data()), point));
    const auto hit = hn::Ne(id, hn::Set(kWords, kBackground));
    const auto seen = hn::RebindMask(kFloats, hit);
    const auto primitive = hn::IfThenElseZero(hit, hn::Sub(id, hn::Set(kWords, table.first)));
    store(id, ends.id, i);
    store(primitive, ends.primitive, i);
    store(hn::IfThenElse(hit, hn::Set(kWords, table.object), hn::Set(kWords, SurfaceKey::kNothing)),
          ends.object, i);
    const auto first = hn::ShiftLeft<2>(hn::BitCast(kIntegers, primitive));
    const auto put = [&](const float* from, auto index, Lanes<float>& to) {
        store(hn::IfThenElseZero(seen, hn::GatherIndex(kFloats, from, index)), to, i);
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
        return hn::Mul(hn::Add(number, set(0.5F)), set(grid.spacing));
    };
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = load(column, i);
        const auto y = load(row, i);
        const auto below = load(down, i);
        const auto beside = hn::Sub(one, below);
        store(place(x, grid.x0), lanes.ax, i);
        store(place(y, grid.y0), lanes.ay, i);
        store(place(hn::Add(x, beside), grid.x0), lanes.bx, i);
        store(place(hn::Add(y, below), grid.y0), lanes.by, i);
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
