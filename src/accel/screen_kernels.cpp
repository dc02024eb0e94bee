#include "accel/screen_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"
#include "accel/screen_tests-inl.h"
#include "base/block_rows-inl.h"
#include "base/pack_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

HWY_INLINE float least(const Lanes<float>& lanes) {
    auto all = load(lanes, 0);
    for (int i = kStep; i < kLanes; i += kStep) all = hn::Min(all, load(lanes, i));
    return hn::GetLane(hn::MinOfLanes(kFloats, all));
}

HWY_INLINE float most(const Lanes<float>& lanes) {
    auto all = load(lanes, 0);
    for (int i = kStep; i < kLanes; i += kStep) all = hn::Max(all, load(lanes, i));
    return hn::GetLane(hn::MaxOfLanes(kFloats, all));
}

HWY_INLINE Mask overlap_of(const BoundsPacket& bounds, const Window& window, int i) {
    const auto across = hn::And(hn::Le(load(bounds.left, i), set(window.right)),
                                hn::Ge(load(bounds.right, i), set(window.left)));
    const auto down = hn::And(hn::Le(load(bounds.top, i), set(window.bottom)),
                              hn::Ge(load(bounds.bottom, i), set(window.top)));
    const auto near = hn::Lt(load(bounds.depth, i), set(window.farthest));
    return hn::And(hn::And(across, down), near);
}

HWY_INLINE LaneBits overlap_lanes(const BoundsPacket& bounds, const Window& window) {
    LaneBits all = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        all |= bits_of(overlap_of(bounds, window, i)) << static_cast<unsigned>(i);
    }
    return all;
}

LaneBits find_overlap(const BoundsPacket& bounds, const Window& window) {
    return overlap_lanes(bounds, window);
}

void find_union(const BoundsPacket& of, BoundsPacket& packet, int lane) {
    packet.left[lane] = least(of.left);
    packet.top[lane] = least(of.top);
    packet.right[lane] = most(of.right);
    packet.bottom[lane] = most(of.bottom);
    packet.depth[lane] = least(of.depth);
}

// ---- Packets ----

/// So many points at most are tested one by one: that takes less than all sixteen of a front.
constexpr int kFewPoints = 8;

HWY_INLINE bool is_of_triangles(const ScreenPacket& packet) {
    return packet.kind == ClusterKind::triangles || packet.kind == ClusterKind::solids;
}

template <GlyphKind kKind>
HWY_INLINE GlyphTest<kKind> glyph_test(const ScreenPacket& packet, int lane) {
    const auto a = static_cast<float>(packet.shape.a);
    return {glyph_form(packet.forms[static_cast<std::size_t>(lane)]), 0.5F * (a - 1.0F),
            0.5F * (1.0F + a), packet.shape.capped};
}

/// Calls `run(make)`, where `make(packet, lane)` gives the test for a primitive of the packet's
/// kind.
template <class Run>
HWY_INLINE void for_kind(const Basis& basis, const ScreenPacket& packet, const Run& run) {
    using enum GlyphKind;
    switch (packet.kind) {
        case ClusterKind::spheres: {
            const auto origin_step = static_cast<float>(basis.origin_step);
            const auto slope_step = static_cast<float>(basis.slope_step);
            return run([=](const ScreenPacket& p, int lane) {
                return SphereTest{sphere_form(p.forms[static_cast<std::size_t>(lane)]), origin_step,
                                  slope_step};
            });
        }
        case ClusterKind::triangles:
        case ClusterKind::solids:
            return run([](const ScreenPacket& p, int lane) {
                return TriangleTest{triangle_form(p.forms[static_cast<std::size_t>(lane)])};
            });
        case ClusterKind::glyphs: break;
    }
    const auto run_glyphs = [&]<GlyphKind kKind>() {
        run([](const ScreenPacket& p, int lane) { return glyph_test<kKind>(p, lane); });
    };
    switch (packet.shape.kind) {
        case ellipsoid: return run_glyphs.template operator()<ellipsoid>();
        case box: return run_glyphs.template operator()<box>();
        case frustum: return run_glyphs.template operator()<frustum>();
        case disc: return run_glyphs.template operator()<disc>();
        case rectangle: return run_glyphs.template operator()<rectangle>();
        default: return;
    }
}

/// What the place of a point is rounded by, and more.
constexpr float kPlaceSlack = 1.0F / 64.0F;

LaneBits find_reached(const BoundsPacket& bounds, int lane, const Front& front) {
    const auto left = set(bounds.left[lane] - kPlaceSlack);
    const auto right = set(bounds.right[lane] + kPlaceSlack);
    const auto top = set(bounds.top[lane] - kPlaceSlack);
    const auto bottom = set(bounds.bottom[lane] + kPlaceSlack);
    const auto depth = set(bounds.depth[lane]);
    LaneBits reached = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto x = load(front.x, i);
        const auto y = load(front.y, i);
        const auto across = hn::And(hn::Ge(x, left), hn::Le(x, right));
        const auto down = hn::And(hn::Ge(y, top), hn::Le(y, bottom));
        const auto before = hn::Lt(depth, load(front.depth, i));
        reached |= bits_of(hn::And(hn::And(across, down), before)) << static_cast<unsigned>(i);
    }
    return reached;
}

/// Tests triangles against a few of the front's points, one by one.
void intersect_points(const ScreenPacket* packets, std::uint32_t index, LaneBits points,
                      Front& front) {
    const ScreenPacket& packet = packets[index];
    for (; points != 0; points &= points - 1) {
        const int point = std::countr_zero(points);
        const float x = front.x[point];
        const float y = front.y[point];
        const Window window{x - kPlaceSlack, x + kPlaceSlack, y - kPlaceSlack, y + kPlaceSlack,
                            front.depth[point]};
        for (LaneBits lanes = overlap_lanes(packet.bounds, window); lanes != 0;
             lanes &= lanes - 1) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
            test_point(packet.forms[lane], {packets, index * kLanes + lane}, point, front);
        }
    }
    front.window.farthest = most(front.depth);
}

void intersect_front(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
                     LaneBits points, Front& front) {
    const ScreenPacket& packet = packets[index];
    if (is_of_triangles(packet) && std::popcount(points) <= kFewPoints) {
        return intersect_points(packets, index, points, front);
    }
    LaneBits lanes = overlap_lanes(packet.bounds, front.window);
    if (lanes == 0) return;
    for_kind(basis, packet, [&](const auto& make) {
        for (; lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            if (find_reached(packet.bounds, lane, front) == 0) continue;
            const auto test = make(packet, lane);
            test({packets, index * kLanes + static_cast<std::uint32_t>(lane)}, front);
        }
    });
    front.window.farthest = most(front.depth);
}

// ---- Rasters ----

/// Cells that one primitive reaches into.
struct CellRange {
    int left, right, top, bottom;

    /// Of one of sixteen.
    static CellRange of(const BoundsPacket& bounds, int lane, const FrontRaster& raster) {
        const float scale = 1.0F / raster.side;
        const auto cell = [&](float at, float from, int count) {
            const float place = std::max((at - from) * scale, 0.0F);
            return static_cast<int>(std::min(place, static_cast<float>(count - 1)));
        };
        return {cell(bounds.left[lane], raster.left, raster.across),
                cell(bounds.right[lane], raster.left, raster.across),
                cell(bounds.top[lane], raster.top, raster.down),
                cell(bounds.bottom[lane], raster.top, raster.down)};
    }
};

/// The columns and rows of points that sixteen primitives may show at. Where primitives are smaller
/// than the spacing of points, many have none.
struct PointRanges {
    Lanes<std::int32_t> left, right, top, bottom;

    HWY_INLINE PointRanges(const BoundsPacket& bounds, const FrontRaster& raster) {
        // What the place of a point is rounded by, in spacings, and more.
        constexpr float kSlack = 1.0F / 64.0F;
        const float scale = kBlockSide / raster.side;
        const float first = 0.5F * (1.0F - (raster.side - raster.extent) * scale);
        const auto put = [&](const Lanes<float>& low, const Lanes<float>& high, float from,
                             int cells, Lanes<std::int32_t>& begin, Lanes<std::int32_t>& end) {
            const auto last = set(static_cast<float>(cells * kBlockSide - 1));
            const auto beyond = hn::Add(last, set(1.0F));
            for (int i = 0; i < kLanes; i += kStep) {
                const auto place = [&](const Lanes<float>& at) {
                    return hn::Sub(hn::Mul(hn::Sub(load(at, i), set(from)), set(scale)),
                                   set(first));
                };
                const auto least = hn::Ceil(hn::Sub(place(low), set(kSlack)));
                const auto most = hn::Floor(hn::Add(place(high), set(kSlack)));
                // Ranges beside the raster stay empty.
                const auto from_first = hn::Max(hn::Min(least, beyond), hn::Zero(kFloats));
                const auto to_last = hn::Max(hn::Min(most, last), set(-1.0F));
                store(hn::ConvertTo(kIntegers, from_first), begin, i);
                store(hn::ConvertTo(kIntegers, to_last), end, i);
            }
        };
        put(bounds.left, bounds.right, raster.left, raster.across, left, right);
        put(bounds.top, bounds.bottom, raster.top, raster.down, top, bottom);
    }

    /// Cells that hold a primitive's points.
    HWY_INLINE CellRange cells(int lane) const {
        return {left[lane] / kBlockSide, right[lane] / kBlockSide, top[lane] / kBlockSide,
                bottom[lane] / kBlockSide};
    }
    HWY_INLINE Mask any(int i) const {
        return hn::Not(hn::RebindMask(kFloats, hn::Or(hn::Gt(load(left, i), load(right, i)),
                                                      hn::Gt(load(top, i), load(bottom, i)))));
    }
    /// Which lie in one cell only.
    HWY_INLINE Mask alone(int i) const {
        return hn::RebindMask(kFloats, hn::And(hn::Eq(cell(left, i), cell(right, i)),
                                               hn::Eq(cell(top, i), cell(bottom, i))));
    }
    /// Which are so few that each is tested by itself.
    HWY_INLINE Mask few(int i) const {
        const auto count = [&](const auto& from, const auto& to) {
            return hn::Add(hn::Sub(load(to, i), load(from, i)), hn::Set(kIntegers, 1));
        };
        return hn::RebindMask(kFloats, hn::Lt(hn::Mul(count(left, right), count(top, bottom)),
                                              hn::Set(kIntegers, kFewPoints + 1)));
    }

    /// The cells of columns or rows.
    static HWY_INLINE Integer cell(Integer of) { return hn::ShiftRight<2>(of); }
    static HWY_INLINE Integer cell(const Lanes<std::int32_t>& of, int i) {
        return cell(load(of, i));
    }
};

/// The edges of triangles, lane by lane.
class EdgeLanes {
  public:
    /// From the i-th triangle on.
    HWY_INLINE EdgeLanes(const std::array<FormNumbers, kLanes>& forms, std::size_t i)
        : x_(numbers(forms, i, 0)),
          y_(numbers(forms, i, 4)),
          dx_(numbers(forms, i, 8)),
          dy_(numbers(forms, i, 12)) {}

    /// False only where points lie beyond an edge.
    HWY_INLINE Mask may_cover(Number qx, Number qy) const {
        return hn::And(hn::And(may_cover(x_.first, y_.first, dx_.first, dy_.first, qx, qy),
                               may_cover(x_.second, y_.second, dx_.second, dy_.second, qx, qy)),
                       may_cover(x_.third, y_.third, dx_.third, dy_.third, qx, qy));
    }

  private:
    /// Four numbers of each form, of which three are of edges.
    static HWY_INLINE TurnedRound<Floats> numbers(const std::array<FormNumbers, kLanes>& forms,
                                                  std::size_t first, std::size_t number) {
        return {kFloats, [&](std::size_t k) HWY_ATTR {
                    return load_rows(kFloats, &forms[first + k][number], 4 * forms[0].size());
                }};
    }

    static HWY_INLINE Mask may_cover(Number x, Number y, Number dx, Number dy, Number qx,
                                     Number qy) {
        const auto slack = hn::Mul(hn::Add(hn::Abs(dx), hn::Abs(dy)), set(-kPlaceSlack));
        const auto value = hn::Sub(hn::Mul(dx, hn::Sub(qy, y)), hn::Mul(dy, hn::Sub(qx, x)));
        return hn::Ge(value, slack);
    }

    TurnedRound<Floats> x_, y_, dx_, dy_;
};

/// Calls `visit(column, row)` for the first cells of windows that cover the range, until it returns
/// false.
template <class Visit>
HWY_INLINE void for_windows(const CellRange& cells, const Visit& visit) {
    for (int row = cells.top; row <= cells.bottom; row += kBlockSide) {
        for (int column = cells.left; column <= cells.right; column += kBlockSide) {
            if (!visit(column, row)) return;
        }
    }
}

/// Where the points of the cells of a window begin, and which of them bounds reach, before all that
/// they see.
struct ReachedCells {
    Number left, top;
    Mask reached;

    HWY_INLINE ReachedCells(const Reach& reach, const FrontRaster& raster, int column, int row,
                            int i) {
        left = hn::Add(set(raster.left + static_cast<float>(column) * raster.side),
                       load(raster.window.right, i));
        top = hn::Add(set(raster.top + static_cast<float>(row) * raster.side),
                      load(raster.window.down, i));
        const auto extent = set(raster.extent);
        const auto across =
            hn::And(hn::Le(set(reach.left), hn::Add(left, extent)), hn::Ge(set(reach.right), left));
        const auto down =
            hn::And(hn::Le(set(reach.top), hn::Add(top, extent)), hn::Ge(set(reach.bottom), top));
        const int first = (row + i / kBlockSide) * raster.stride() + column;
        const auto farthest =
            load_rows(kFloats, raster.farthest + first, static_cast<std::size_t>(raster.stride()));
        reached = hn::And(hn::And(across, down), hn::Lt(set(reach.depth), farthest));
    }
};

/// Primitives of a packet and cells that they may show in. They are listed first, then tested one
/// after the other: how many cells a primitive reaches cannot be guessed, so that to test them as
/// they are found would stop the processor at each primitive.
struct Pairs {
    static constexpr std::size_t kMost = 1024;
    std::array<Lanes<std::uint32_t>, kMost / kLanes + 2> list;  ///< cell * kLanes + lane
    std::size_t count = 0;
    /// Of small ones the points: (cell * kLanes + point) * kLanes + lane.
    std::array<std::uint32_t, kLanes*(kFewPoints + 1)> points;
    std::size_t point_count = 0;
    std::array<std::uint32_t, kMost + kLanes*(kFewPoints + 1) + 1> dirty;  ///< cells
    std::size_t dirty_count = 0;

    HWY_INLINE bool full() const { return count > kMost; }

    /// Lists the cells of a window.
    template <class Test>
    HWY_INLINE void add(const Test& test, int lane, const Reach& reach, const FrontRaster& raster,
                        int column, int row) {
        const auto first = static_cast<std::uint32_t>(row * raster.stride() + column);
        for (int i = 0; i < kLanes; i += kStep) {
            const ReachedCells reached(reach, raster, column, row, i);
            const Mask live =
                test.may_cover(reached.reached, reached.left, reached.top, reach, raster.extent);
            const auto at = hn::Add(load(raster.window.offset, i), hn::Set(kWords, first));
            const auto all =
                hn::Add(hn::ShiftLeft<4>(at), hn::Set(kWords, static_cast<std::uint32_t>(lane)));
            const LanePacker packer(live);
            hn::StoreU(packer.pack(kWords, all), kWords, list[0].data() + count);
            count += packer.count();
        }
    }

    /// Lists the cells of those primitives, from the i-th on, that are `alone` in reaching into
    /// one.
    HWY_INLINE void add_alone(Mask alone, const BoundsPacket& bounds, const PointRanges& ranges,
                              const FrontRaster& raster, int i) {
        const Integer cell =
            hn::Add(hn::Mul(ranges.cell(ranges.top, i), hn::Set(kIntegers, raster.stride())),
                    ranges.cell(ranges.left, i));
        const Number farthest = hn::GatherIndex(kFloats, raster.farthest, cell);
        const Mask live = hn::And(alone, hn::Lt(load(bounds.depth, i), farthest));
        const auto lanes = hn::Iota(kWords, static_cast<std::uint32_t>(i));
        const auto all = hn::Add(hn::ShiftLeft<4>(hn::BitCast(kWords, cell)), lanes);
        const LanePacker packer(live);
        hn::StoreU(packer.pack(kWords, all), kWords, list[0].data() + count);
        count += packer.count();
    }

    /// Lists the points of those triangles, from the i-th on, that have `few`, unless they lie
    /// beyond an edge.
    HWY_INLINE void add_points(Mask few, const ScreenPacket& packet, const PointRanges& ranges,
                               const FrontRaster& raster, int i) {
        if (hn::AllFalse(kFloats, few)) return;
        const EdgeLanes edges(packet.forms, static_cast<std::size_t>(i));
        const float spacing = raster.side / kBlockSide;
        const float inset = 0.5F * (spacing - (raster.side - raster.extent));
        const auto place = [&](float from, Integer of) {
            return hn::Add(set(from + inset), hn::Mul(hn::ConvertTo(kFloats, of), set(spacing)));
        };
        const auto one = hn::Set(kIntegers, 1);
        const auto in_cell = hn::Set(kIntegers, kBlockSide - 1);
        const auto lanes = hn::Iota(kIntegers, i);
        const Integer left = load(ranges.left, i);
        const Integer right = load(ranges.right, i);
        const Integer bottom = load(ranges.bottom, i);
        Integer column = left;
        Integer row = load(ranges.top, i);
        do {
            const Mask live =
                hn::And(few, edges.may_cover(place(raster.left, column), place(raster.top, row)));
            const Integer cell =
                hn::Add(hn::Mul(PointRanges::cell(row), hn::Set(kIntegers, raster.stride())),
                        PointRanges::cell(column));
            const Integer point =
                hn::Add(hn::ShiftLeft<2>(hn::And(row, in_cell)), hn::And(column, in_cell));
            const Integer all =
                hn::Add(hn::ShiftLeft<8>(cell), hn::Add(hn::ShiftLeft<4>(point), lanes));
            const LanePacker packer(live);
            hn::StoreU(packer.pack(kWords, hn::BitCast(kWords, all)), kWords,
                       points.data() + point_count);
            point_count += packer.count();
            const auto ends = hn::Eq(column, right);
            column = hn::IfThenElse(ends, left, hn::Add(column, one));
            row = hn::IfThenElse(ends, hn::Add(row, one), row);
            few = hn::AndNot(hn::RebindMask(kFloats, hn::Gt(row, bottom)), few);
        } while (!hn::AllFalse(kFloats, few));
    }

    /// Tests the points that are listed.
    HWY_INLINE void test_points(const ScreenPacket* packets, std::uint32_t index,
                                const FrontRaster& raster) {
        const ScreenPacket& packet = packets[index];
        for (std::size_t k = 0; k < point_count; ++k) {
            const std::uint32_t lane = points[k] % kLanes;
            const std::uint32_t point = points[k] / kLanes % kLanes;
            const std::uint32_t cell = points[k] / (kLanes * kLanes);
            if (!(packet.bounds.depth[static_cast<int>(lane)] < raster.farthest[cell])) continue;
            mark(cell, raster);
            test_point(packet.forms[lane], {packets, index * kLanes + lane},
                       static_cast<int>(point), raster.fronts[raster.front_at[cell]]);
        }
        point_count = 0;
    }

    HWY_INLINE void mark(std::uint32_t cell, const FrontRaster& raster) {
        dirty[dirty_count] = cell;
        dirty_count += 1U - raster.dirty[cell];
        raster.dirty[cell] = 1;
    }

    /// Brings the farthest depths of cells up to date.
    HWY_INLINE void update(const FrontRaster& raster) {
        for (std::size_t k = 0; k < dirty_count; ++k) {
            const std::uint32_t cell = dirty[k];
            raster.dirty[cell] = 0;
            raster.farthest[cell] = most(raster.fronts[raster.front_at[cell]].depth);
        }
        dirty_count = 0;
    }

    /// Tests what is listed, and brings its cells up to date.
    template <class Make>
    HWY_INLINE void test(const Make& make, const ScreenPacket* packets, std::uint32_t index,
                         const FrontRaster& raster) {
        const std::uint32_t* pairs = list[0].data();
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t lane = pairs[k] % kLanes;
            const std::uint32_t cell = pairs[k] / kLanes;
            mark(cell, raster);
            const auto primitive = make(packets[index], static_cast<int>(lane));
            primitive({packets, index * kLanes + lane}, raster.fronts[raster.front_at[cell]]);
        }
        count = 0;
        update(raster);
    }
};

void intersect_raster(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
                      const FrontRaster& raster) {
    const ScreenPacket& packet = packets[index];
    const PointRanges ranges(packet.bounds, raster);
    Pairs pairs;
    LaneBits others = 0;  // that reach into several cells
    for (int i = 0; i < kLanes; i += kStep) {
        Mask seen = ranges.any(i);
        if (is_of_triangles(packet)) {
            const Mask few = hn::And(seen, ranges.few(i));
            pairs.add_points(few, packet, ranges, raster, i);
            seen = hn::AndNot(few, seen);
        }
        const Mask alone = hn::And(seen, ranges.alone(i));
        pairs.add_alone(alone, packet.bounds, ranges, raster, i);
        others |= bits_of(hn::AndNot(alone, seen)) << static_cast<unsigned>(i);
    }
    pairs.test_points(packets, index, raster);
    if (pairs.count == 0 && others == 0) return pairs.update(raster);
    for_kind(basis, packet, [&](const auto& make) {
        for (LaneBits lanes = others; lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const Reach reach(packet.bounds, lane);
            const auto primitive = make(packet, lane);
            for_windows(ranges.cells(lane), [&](int column, int row) {
                pairs.add(primitive, lane, reach, raster, column, row);
                if (pairs.full()) pairs.test(make, packets, index, raster);
                return true;
            });
        }
        pairs.test(make, packets, index, raster);
    });
}

bool raster_matters(const BoundsPacket& bounds, int lane, const FrontRaster& raster) {
    const Reach reach(bounds, lane);
    bool any = false;
    for_windows(CellRange::of(bounds, lane, raster), [&](int column, int row) {
        for (int i = 0; i < kLanes && !any; i += kStep) {
            const ReachedCells reached(reach, raster, column, row, i);
            any = !hn::AllFalse(kFloats, reached.reached);
        }
        return !any;
    });
    return any;
}

float raster_farthest(const FrontRaster& raster) {
    auto all = set(-kInfinity);
    int k = 0;
    for (; k + kStep <= raster.cells(); k += kStep) {
        all = hn::Max(all, hn::LoadU(kFloats, raster.farthest + k));
    }
    float result = hn::GetLane(hn::MaxOfLanes(kFloats, all));
    for (; k < raster.cells(); ++k) result = std::max(result, raster.farthest[k]);
    return result;
}

// ---- Rays ----

/// The camera's part of a ray.
struct Lens {
    float centre_x, centre_y, slope_step;

    explicit Lens(const Projection& projection)
        : centre_x(projection.centre.x),
          centre_y(projection.centre.y),
          slope_step(static_cast<float>(projection.slope_step)) {}
};

/// Some lanes of a front as it starts, and which of them are active.
struct StartedLanes {
    Number x, y;
    Mask on;

    HWY_INLINE StartedLanes(const Lens& lens, const PointPacket& points, int i, Front& front)
        : StartedLanes(hn::Sub(load(points.x, i), set(lens.centre_x)),
                       hn::Sub(load(points.y, i), set(lens.centre_y)),
                       hn::RebindMask(kFloats, hn::Ne(load(points.active, i), hn::Zero(kIntegers))),
                       i, front) {}

    HWY_INLINE StartedLanes(Number at_x, Number at_y, Mask active, int i, Front& front)
        : x(at_x), y(at_y), on(active) {
        store(x, front.x, i);
        store(y, front.y, i);
        store(hn::IfThenElse(on, set(kInfinity), set(-kInfinity)), front.depth, i);
    }

    HWY_INLINE void foreshorten(const Lens& lens, int i, Front& front) const {
        const auto slope_x = hn::Mul(x, set(lens.slope_step));
        const auto slope_y = hn::Mul(y, set(lens.slope_step));
        const auto squared =
            hn::Add(hn::Add(set(1.0F), hn::Mul(slope_x, slope_x)), hn::Mul(slope_y, slope_y));
        store(hn::Div(set(1.0F), squared), front.foreshortening, i);
    }
};

void start_front(const Projection& projection, const PointPacket& points, Front& front) {
    const Lens lens(projection);
    const auto infinity = set(kInfinity);
    const auto minus_infinity = set(-kInfinity);
    auto left = infinity;
    auto top = infinity;
    auto right = minus_infinity;
    auto bottom = minus_infinity;
    float farthest = -kInfinity;
    for (int i = 0; i < kLanes; i += kStep) {
        const StartedLanes lanes(lens, points, i, front);
        lanes.foreshorten(lens, i, front);
        left = hn::Min(left, hn::IfThenElse(lanes.on, lanes.x, infinity));
        top = hn::Min(top, hn::IfThenElse(lanes.on, lanes.y, infinity));
        right = hn::Max(right, hn::IfThenElse(lanes.on, lanes.x, minus_infinity));
        bottom = hn::Max(bottom, hn::IfThenElse(lanes.on, lanes.y, minus_infinity));
        if (!hn::AllFalse(kFloats, lanes.on)) farthest = kInfinity;
    }
    front.window = {hn::GetLane(hn::MinOfLanes(kFloats, left)),
                    hn::GetLane(hn::MaxOfLanes(kFloats, right)),
                    hn::GetLane(hn::MinOfLanes(kFloats, top)),
                    hn::GetLane(hn::MaxOfLanes(kFloats, bottom)), farthest};
}

/// Along one axis of a raster: where the points of a cell lie, and which of them are active.
struct RasterAxis {
    Lanes<float> in_cell;  ///< a lane's column or row
    float first, count, spacing, offset, centre;

    HWY_INLINE std::pair<Number, Mask> points(int cell, int i) const {
        const auto from_first =
            hn::Add(load(in_cell, i), set(static_cast<float>(cell * kBlockSide)));
        const auto middle = hn::Add(hn::Add(from_first, set(first)), set(0.5F));
        const auto place = hn::Add(hn::Mul(middle, set(spacing)), set(offset));
        return {hn::Sub(place, set(centre)), hn::Lt(from_first, set(count))};
    }
};

void start_raster(const Projection& projection, const BlockRaster& raster, bool flat,
                  Front* fronts) {
    const Lens lens(projection);
    const auto axis = [&](int first, int count, float offset, float centre) {
        return RasterAxis{
            {},    static_cast<float>(first), static_cast<float>(count), raster.spacing, offset,
            centre};
    };
    RasterAxis across = axis(raster.x, raster.columns, raster.offset.x, lens.centre_x);
    RasterAxis down = axis(raster.y, raster.rows, raster.offset.y, lens.centre_y);
    for (int i = 0; i < kLanes; ++i) {
        across.in_cell[i] = static_cast<float>(i % kBlockSide);
        down.in_cell[i] = static_cast<float>(i / kBlockSide);
    }
    const std::uint32_t* packet = raster.packet_at.data();
    for (int row = 0; row < raster.down(); ++row) {
        for (int column = 0; column < raster.across(); ++column, ++packet) {
            if (*packet == BlockRaster::kNone) continue;
            Front& front = fronts[*packet];
            for (int i = 0; i < kLanes; i += kStep) {
                const auto [x, within_columns] = across.points(column, i);
                const auto [y, within_rows] = down.points(row, i);
                const StartedLanes lanes(x, y, hn::And(within_columns, within_rows), i, front);
                if (!flat) lanes.foreshorten(lens, i, front);
            }
        }
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_overlap);
HWY_EXPORT(find_union);
HWY_EXPORT(intersect_front);
HWY_EXPORT(intersect_raster);
HWY_EXPORT(raster_farthest);
HWY_EXPORT(find_reached);
HWY_EXPORT(raster_matters);
HWY_EXPORT(start_front);
HWY_EXPORT(start_raster);

LaneBits overlap(const BoundsPacket& bounds, const Window& window) {
    return HWY_DYNAMIC_DISPATCH(find_overlap)(bounds, window);
}

void set_union(const BoundsPacket& of, BoundsPacket& packet, int lane) {
    HWY_DYNAMIC_DISPATCH(find_union)(of, packet, lane);
}

void intersect(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
               LaneBits points, Front& front) {
    HWY_DYNAMIC_DISPATCH(intersect_front)(basis, packets, index, points, front);
}

void intersect(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
               const FrontRaster& raster) {
    HWY_DYNAMIC_DISPATCH(intersect_raster)(basis, packets, index, raster);
}

float farthest_of(const FrontRaster& raster) {
    return HWY_DYNAMIC_DISPATCH(raster_farthest)(raster);
}

LaneBits reached(const BoundsPacket& bounds, int lane, const Front& front) {
    return HWY_DYNAMIC_DISPATCH(find_reached)(bounds, lane, front);
}

bool matters(const BoundsPacket& bounds, int lane, const FrontRaster& raster) {
    return HWY_DYNAMIC_DISPATCH(raster_matters)(bounds, lane, raster);
}

void FrontRaster::lay_window() {
    for (int i = 0; i < kLanes; ++i) {
        window.right[i] = static_cast<float>(i % kBlockSide) * side;
        window.down[i] = static_cast<float>(i / kBlockSide) * side;
        window.offset[i] = static_cast<std::uint32_t>(i / kBlockSide * stride() + i % kBlockSide);
    }
}

void Front::start(const Projection& projection, const PointPacket& points) {
    HWY_DYNAMIC_DISPATCH(start_front)(projection, points, *this);
}

void start_cells(const Projection& projection, const BlockRaster& raster, bool flat,
                 Front* fronts) {
    HWY_DYNAMIC_DISPATCH(start_raster)(projection, raster, flat, fronts);
}

}  // namespace ink

#endif
