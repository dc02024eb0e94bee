#include "accel/screen_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/screen_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "accel/screen_lanes-inl.h"

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

HWY_INLINE LaneBits overlap_lanes(const BoundsPacket& bounds, const Window& window) {
    LaneBits all = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto across = hn::And(hn::Le(load(bounds.left, i), set(window.right)),
                                    hn::Ge(load(bounds.right, i), set(window.left)));
        const auto down = hn::And(hn::Le(load(bounds.top, i), set(window.bottom)),
                                  hn::Ge(load(bounds.bottom, i), set(window.top)));
        const auto near = hn::Lt(load(bounds.depth, i), set(window.farthest));
        all |= bits(hn::And(hn::And(across, down), near)) << static_cast<unsigned>(i);
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

/// Bounds of one primitive.
struct Reach {
    float left, right, top, bottom, depth;

    HWY_INLINE Reach(const BoundsPacket& bounds, int lane)
        : left(bounds.left[lane]),
          right(bounds.right[lane]),
          top(bounds.top[lane]),
          bottom(bounds.bottom[lane]),
          depth(bounds.depth[lane]) {}
};

// ---- The nearest hit ----

/// What a primitive is called while it is tested.
struct Name {
    const ScreenPacket* packets;
    std::uint32_t winner;

    std::uint64_t rank(std::uint32_t of) const {
        const ScreenPacket& packet = packets[of / kLanes];
        return static_cast<std::uint64_t>(packet.object) << 32U |
               packet.primitive[static_cast<int>(of % kLanes)];
    }
};

/// Lanes where two surfaces coincide: the lower one counts.
HWY_INLINE void settle(Vector depth, Mask around, Name name, int i, Front& front) {
    alignas(64) float depths[kStep];
    hn::Store(depth, kFloats, depths);
    for (LaneBits lanes = bits(around); lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        if (name.rank(name.winner) >= name.rank(front.winner[i + lane])) continue;
        front.depth[i + lane] = depths[lane];
        front.winner[i + lane] = name.winner;
    }
}

/// Takes the hits that lie in front of what there is; `slack`: how near to it they count as one
/// with it. There is no branch that depends on what is hit, except where surfaces coincide: a wrong
/// guess costs as much as the test.
HWY_INLINE void keep_nearer(Vector depth, Mask covered, float slack, Name name, int i,
                            Front& front) {
    const auto before = load(front.depth, i);
    const auto hit = hn::And(covered, hn::Le(depth, hn::Add(before, set(slack))));
    const auto nearer = hn::And(hit, hn::Lt(depth, hn::Sub(before, set(slack))));
    const auto around = hn::AndNot(nearer, hit);
    hn::Store(hn::IfThenElse(nearer, depth, before), kFloats, front.depth.data() + i);
    const auto winners = hn::IfThenElse(hn::RebindMask(kIndices, nearer),
                                        hn::Set(kIndices, name.winner), load(front.winner, i));
    hn::Store(winners, kIndices, front.winner.data() + i);
    if (HWY_UNLIKELY(!hn::AllFalse(kFloats, around))) settle(depth, around, name, i, front);
}

// ---- Spheres ----

struct SphereTest {
    SphereForm form;
    float origin_step, slope_step;

    HWY_INLINE Mask may_cover(Mask cells, Vector /*left*/, Vector /*top*/, const Reach& /*reach*/,
                              float /*side*/) const {
        return cells;
    }

    HWY_INLINE void operator()(Name name, Front& front) const {
        const auto origin = set(origin_step);
        const auto slope = set(slope_step);
        for (int i = 0; i < kLanes; i += kStep) {
            const auto qx = load(front.x, i);
            const auto qy = load(front.y, i);
            const auto dx = hn::Sub(qx, set(form.u));
            const auto dy = hn::Sub(qy, set(form.v));
            const auto across =
                hn::Mul(dx, hn::Add(hn::Mul(set(form.a), dx), hn::Mul(set(form.b), dy)));
            const auto h =
                hn::Sub(set(form.f), hn::Add(across, hn::Mul(set(form.c), hn::Mul(dy, dy))));
            const auto covered = hn::Gt(h, hn::Zero(kFloats));
            const auto along_x =
                hn::Mul(hn::Mul(qx, slope), hn::Sub(set(form.x), hn::Mul(qx, origin)));
            const auto along_y =
                hn::Mul(hn::Mul(qy, slope), hn::Sub(set(form.y), hn::Mul(qy, origin)));
            const auto m = hn::Add(hn::Add(set(form.z), along_x), along_y);
            const auto depth = hn::Mul(hn::Sub(m, hn::Sqrt(hn::Max(h, hn::Zero(kFloats)))),
                                       load(front.foreshortening, i));
            keep_nearer(depth, covered, 0.0F, name, i, front);
        }
    }
};

// ---- Triangles ----

HWY_INLINE Vector edge_value(const TriangleForm::Edge& edge, Vector qx, Vector qy) {
    return hn::Sub(hn::Mul(set(edge.dx), hn::Sub(qy, set(edge.y))),
                   hn::Mul(set(edge.dy), hn::Sub(qx, set(edge.x))));
}

/// Number by number: a copy of them all would go through memory, which every test would wait for.
HWY_INLINE TriangleForm triangle_form(const FormNumbers& n) {
    return {{{{n[0], n[1], n[2], n[3]}, {n[4], n[5], n[6], n[7]}, {n[8], n[9], n[10], n[11]}}},
            n[12],
            n[13],
            n[14],
            n[15],
            n[16],
            n[17],
            n[18],
            n[19],
            n[20],
            n[21]};
}

/// Share of its terms that an edge's value may be rounded by.
constexpr float kRounding = 1e-6F;

struct TriangleTest {
    TriangleForm form;

    /// Those of the cells that are not beyond an edge, by their corner that lies farthest inside.
    HWY_INLINE Mask may_cover(Mask cells, Vector left, Vector top, const Reach& reach,
                              float side) const {
        // No cell that is reached begins farther from an end of an edge.
        const float width = reach.right - reach.left + side;
        const float height = reach.bottom - reach.top + side;
        for (const TriangleForm::Edge& edge : form.edges) {
            const auto along = hn::Mul(set(edge.dx), hn::Sub(top, set(edge.y)));
            const auto across = hn::Mul(set(edge.dy), hn::Sub(left, set(edge.x)));
            const float slack =
                kRounding * (std::abs(edge.dx) * height + std::abs(edge.dy) * width);
            const float most = (std::max(edge.dx, 0.0F) + std::max(-edge.dy, 0.0F)) * side;
            cells = hn::And(cells, hn::Ge(hn::Sub(along, across), set(-(most + slack))));
        }
        return cells;
    }

    HWY_INLINE void operator()(Name name, Front& front) const {
        for (int i = 0; i < kLanes; i += kStep) {
            const auto qx = load(front.x, i);
            const auto qy = load(front.y, i);
            const auto e0 = edge_value(form.edges[0], qx, qy);
            const auto e1 = edge_value(form.edges[1], qx, qy);
            const auto e2 = edge_value(form.edges[2], qx, qy);
            const auto covered = hn::Ge(hn::Min(hn::Min(e0, e1), e2), hn::Zero(kFloats));
            const auto rise = hn::Add(hn::Mul(set(form.gx), hn::Sub(qx, set(form.u))),
                                      hn::Mul(set(form.gy), hn::Sub(qy, set(form.v))));
            const auto facing =
                hn::Add(hn::Add(set(form.w), hn::Mul(set(form.wx), qx)), hn::Mul(set(form.wy), qy));
            const auto plane = hn::Add(set(form.z), hn::Div(rise, facing));
            const auto depth = hn::Min(hn::Max(plane, set(form.near)), set(form.far));
            keep_nearer(depth, covered, kCoincident, name, i, front);
        }
    }
};

// ---- Glyphs ----

/// Moves the rays' points to those nearest to the origin, where they are of the shape's size, and
/// returns how far.
HWY_INLINE Vector approach(LocalRays& rays) {
    const auto s = hn::Neg(hn::Div(dot(rays.p, rays.d), not_zero(dot(rays.d, rays.d))));
    rays.p = along(rays.p, rays.d, s);
    return s;
}

struct LocalHit {
    Vector s;
    Mask covered;
};

HWY_INLINE LocalHit meet_ball(LocalRays rays) {
    const auto to_origin = approach(rays);
    const auto rest = hn::Sub(set(1.0F), dot(rays.p, rays.p));
    const auto covered = hn::Gt(rest, hn::Zero(kFloats));
    const auto half = hn::Sqrt(hn::Max(rest, hn::Zero(kFloats)));
    const auto speed = hn::Sqrt(dot(rays.d, rays.d));
    return {hn::Sub(to_origin, hn::Div(half, not_zero(speed))), covered};
}

/// The part of rays within |x| <= 1 along one axis.
struct Slab {
    Vector lo, hi;
    HWY_INLINE Slab(Vector p, Vector d) {
        const auto scale = hn::Div(set(1.0F), not_zero(d));
        const auto a = hn::Mul(hn::Sub(set(-1.0F), p), scale);
        const auto b = hn::Mul(hn::Sub(set(1.0F), p), scale);
        lo = hn::Min(a, b);
        hi = hn::Max(a, b);
    }
};

HWY_INLINE LocalHit meet_box(const LocalRays& rays) {
    const Slab x(rays.p.x, rays.d.x);
    const Slab y(rays.p.y, rays.d.y);
    const Slab z(rays.p.z, rays.d.z);
    const auto entry = hn::Max(hn::Max(x.lo, y.lo), z.lo);
    const auto exit = hn::Min(hn::Min(x.hi, y.hi), z.hi);
    return {entry, hn::Le(entry, exit)};
}

/// Between its two planes the lateral surface encloses where x^2 + y^2 - r(z)^2 < 0, with
/// r(z) = middle + slope z.
HWY_INLINE LocalHit meet_frustum(LocalRays rays, float slope, float middle, bool capped) {
    const auto to_origin = approach(rays);
    const auto& [p, d] = rays;
    const Slab slab(p.z, d.z);
    const auto radius = hn::Add(set(middle), hn::Mul(set(slope), p.z));
    const auto growth = hn::Mul(set(slope), d.z);
    const auto a = hn::Sub(hn::Add(hn::Mul(d.x, d.x), hn::Mul(d.y, d.y)), hn::Mul(growth, growth));
    const auto b = hn::Sub(hn::Add(hn::Mul(p.x, d.x), hn::Mul(p.y, d.y)), hn::Mul(radius, growth));
    const auto c = hn::Sub(hn::Add(hn::Mul(p.x, p.x), hn::Mul(p.y, p.y)), hn::Mul(radius, radius));
    const auto rest = hn::Sub(hn::Mul(b, b), hn::Mul(a, c));
    const auto real = hn::Ge(rest, hn::Zero(kFloats));
    const auto root = hn::Sqrt(hn::Max(rest, hn::Zero(kFloats)));
    // The sum of b and root of one sign loses no digits; the other crossing follows from c.
    const auto sum = hn::Neg(hn::Add(b, hn::CopySign(root, b)));
    const auto one = hn::Div(sum, not_zero(a));
    const auto two = hn::Div(c, not_zero(sum));
    const auto first = hn::Min(one, two);
    const auto second = hn::Max(one, two);
    const auto within = [&](Vector s) {
        const auto z = hn::Add(p.z, hn::Mul(s, d.z));
        const auto r = hn::Add(set(middle), hn::Mul(set(slope), z));
        return hn::And(hn::And(hn::Ge(s, slab.lo), hn::Le(s, slab.hi)),
                       hn::Ge(r, hn::Zero(kFloats)));
    };
    const auto on_first = hn::And(real, within(first));
    const auto on_second = hn::And(real, within(second));
    auto s = hn::IfThenElse(on_first, first, second);
    auto covered = hn::Or(on_first, on_second);
    if (capped) {
        const auto at = along(p, d, slab.lo);
        const auto r = hn::Add(set(middle), hn::Mul(set(slope), at.z));
        const auto inside =
            hn::Lt(hn::Add(hn::Mul(at.x, at.x), hn::Mul(at.y, at.y)), hn::Mul(r, r));
        s = hn::IfThenElse(inside, slab.lo, s);
        covered = hn::Or(covered, inside);
    }
    return {hn::Add(to_origin, s), covered};
}

HWY_INLINE LocalHit meet_plane(const LocalRays& rays, bool round) {
    const auto s = hn::Neg(hn::Div(rays.p.z, not_zero(rays.d.z)));
    const auto at = along(rays.p, rays.d, s);
    const auto one = set(1.0F);
    const auto in_disc = hn::Le(hn::Add(hn::Mul(at.x, at.x), hn::Mul(at.y, at.y)), one);
    const auto in_square = hn::And(hn::Le(hn::Abs(at.x), one), hn::Le(hn::Abs(at.y), one));
    return {s, round ? in_disc : in_square};
}

template <GlyphKind kKind>
struct GlyphTest {
    GlyphForm form;
    float slope, middle;
    bool capped;

    HWY_INLINE Mask may_cover(Mask cells, Vector /*left*/, Vector /*top*/, const Reach& /*reach*/,
                              float /*side*/) const {
        return cells;
    }

    HWY_INLINE LocalHit meet(const LocalRays& rays) const {
        if constexpr (kKind == GlyphKind::ellipsoid) return meet_ball(rays);
        if constexpr (kKind == GlyphKind::box) return meet_box(rays);
        if constexpr (kKind == GlyphKind::frustum) {
            return meet_frustum(rays, slope, middle, capped);
        }
        if constexpr (kKind == GlyphKind::disc) return meet_plane(rays, true);
        if constexpr (kKind == GlyphKind::rectangle) return meet_plane(rays, false);
    }

    HWY_INLINE void operator()(Name name, Front& front) const {
        constexpr bool kRound = kKind == GlyphKind::ellipsoid || kKind == GlyphKind::frustum;
        for (int i = 0; i < kLanes; i += kStep) {
            const LocalRays rays = local_rays(form, load(front.x, i), load(front.y, i));
            const LocalHit hit = meet(rays);
            const auto depth = hn::Add(set(form.z), hit.s);
            keep_nearer(depth, hit.covered, kRound ? 0.0F : kCoincident, name, i, front);
        }
    }
};

// ---- Packets ----

template <GlyphKind kKind>
HWY_INLINE GlyphTest<kKind> glyph_test(const ScreenPacket& packet, int lane) {
    const auto a = static_cast<float>(packet.shape.a);
    return {form_of<GlyphForm>(packet, lane), 0.5F * (a - 1.0F), 0.5F * (1.0F + a),
            packet.shape.capped};
}

/// Calls `run(make)`, where `make(packet, lane)` gives the test for a primitive of the packet's
/// kind.
template <class Run>
HWY_INLINE void for_kind(const Basis& basis, const ScreenPacket& packet, const Run& run) {
    using enum GlyphKind;
    switch (packet.kind) {
        case ClusterKind::spheres:
            return run([&](const ScreenPacket& p, int lane) {
                return SphereTest{form_of<SphereForm>(p, lane),
                                  static_cast<float>(basis.origin_step),
                                  static_cast<float>(basis.slope_step)};
            });
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

void intersect_front(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
                     Front& front) {
    const ScreenPacket& packet = packets[index];
    LaneBits lanes = overlap_lanes(packet.bounds, front.window);
    if (lanes == 0) return;
    for_kind(basis, packet, [&](const auto& make) {
        for (; lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const auto test = make(packet, lane);
            test({packets, index * kLanes + static_cast<std::uint32_t>(lane)}, front);
        }
    });
    front.window.farthest = most(front.depth);
}

// ---- Rasters ----

/// Groups of cells that one primitive reaches into.
struct Groups {
    int left, right, top, bottom;
};

/// Those of sixteen primitives.
struct GroupLanes {
    Lanes<std::int32_t> left, right, top, bottom;

    HWY_INLINE GroupLanes(const BoundsPacket& bounds, const FrontRaster& raster) {
        const float scale = 1.0F / (kBlockSide * raster.side);
        const auto put = [&](const Lanes<float>& at, float from, int count,
                             Lanes<std::int32_t>& to) {
            const auto last = set(static_cast<float>(count - 1));
            for (int i = 0; i < kLanes; i += kStep) {
                const auto place = hn::Mul(hn::Sub(load(at, i), set(from)), set(scale));
                const auto within = hn::Min(hn::Max(place, hn::Zero(kFloats)), last);
                hn::Store(hn::ConvertTo(kIntegers, within), kIntegers, to.data() + i);
            }
        };
        put(bounds.left, raster.left, raster.across, left);
        put(bounds.right, raster.left, raster.across, right);
        put(bounds.top, raster.top, raster.down, top);
        put(bounds.bottom, raster.top, raster.down, bottom);
    }

    HWY_INLINE Groups of(int lane) const {
        return {left[lane], right[lane], top[lane], bottom[lane]};
    }
};

/// Upper left corners of the cells of a group, and which of them bounds reach into, before all that
/// they see.
struct GroupCells {
    Vector left, top;
    Mask reached;

    HWY_INLINE GroupCells(const Reach& reach, const FrontRaster& raster, int column, int row,
                          int i) {
        const float x = raster.left + static_cast<float>(column * kBlockSide) * raster.side;
        const float y = raster.top + static_cast<float>(row * kBlockSide) * raster.side;
        const auto lane = hn::Iota(kIntegers, i);
        const auto in_row = hn::And(lane, hn::Set(kIntegers, kBlockSide - 1));
        const auto side = set(raster.side);
        left = hn::Add(set(x), hn::Mul(hn::ConvertTo(kFloats, in_row), side));
        top = hn::Add(set(y), hn::Mul(hn::ConvertTo(kFloats, hn::ShiftRight<2>(lane)), side));
        const float* farthest = raster.farthest + (row * raster.across + column) * kLanes;
        const auto across =
            hn::And(hn::Le(set(reach.left), hn::Add(left, side)), hn::Ge(set(reach.right), left));
        const auto down =
            hn::And(hn::Le(set(reach.top), hn::Add(top, side)), hn::Ge(set(reach.bottom), top));
        const auto before = hn::Lt(set(reach.depth), hn::Load(kFloats, farthest + i));
        reached = hn::And(hn::And(across, down), before);
    }
};

/// Primitives of a packet and cells that they may show in. They are listed first, then tested one
/// after the other: how many cells a primitive reaches cannot be guessed, so that to test them as
/// they are found would stop the processor at each primitive.
struct Pairs {
    static constexpr std::size_t kMost = 1024;
    std::array<Lanes<std::uint32_t>, kMost / kLanes + 2> list;  ///< cell * kLanes + lane
    std::size_t count = 0;

    HWY_INLINE bool full() const { return count > kMost; }

    /// Lists the cells of a group.
    template <class Test>
    HWY_INLINE void add(const Test& test, int lane, const Reach& reach, const FrontRaster& raster,
                        int column, int row) {
        const int group = row * raster.across + column;
        for (int i = 0; i < kLanes; i += kStep) {
            const GroupCells cells(reach, raster, column, row, i);
            const Mask live =
                test.may_cover(cells.reached, cells.left, cells.top, reach, raster.side);
            const LaneBits found = bits(live);
            raster.dirty[group] |= found << static_cast<unsigned>(i);
            const auto first = static_cast<std::uint32_t>((group * kLanes + i) * kLanes + lane);
            const auto all =
                hn::Add(hn::ShiftLeft<4>(hn::Iota(kIndices, 0)), hn::Set(kIndices, first));
            const auto compressed = hn::Compress(all, hn::RebindMask(kIndices, live));
            hn::StoreU(compressed, kIndices, list[0].data() + count);
            count += static_cast<std::size_t>(std::popcount(found));
        }
    }

    /// Tests what is listed.
    template <class Make>
    HWY_INLINE void test(const Make& make, const ScreenPacket* packets, std::uint32_t index,
                         const FrontRaster& raster) {
        const std::uint32_t* pairs = list[0].data();
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t lane = pairs[k] % kLanes;
            const auto primitive = make(packets[index], static_cast<int>(lane));
            primitive({packets, index * kLanes + lane},
                      raster.fronts[raster.front_at[pairs[k] / kLanes]]);
        }
        count = 0;
    }
};

/// Brings the farthest depths of cells up to date.
HWY_INLINE void update_farthest(const FrontRaster& raster) {
    for (int group = 0; group < raster.across * raster.down; ++group) {
        for (LaneBits left = raster.dirty[group]; left != 0; left &= left - 1) {
            const int cell = group * kLanes + std::countr_zero(left);
            raster.farthest[cell] = most(raster.fronts[raster.front_at[cell]].depth);
        }
        raster.dirty[group] = 0;
    }
}

void intersect_raster(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
                      const FrontRaster& raster) {
    const ScreenPacket& packet = packets[index];
    const float width = static_cast<float>(raster.across * kBlockSide) * raster.side;
    const float height = static_cast<float>(raster.down * kBlockSide) * raster.side;
    const Window window{raster.left, raster.left + width, raster.top, raster.top + height,
                        kInfinity};
    const LaneBits all = overlap_lanes(packet.bounds, window);
    if (all == 0) return;
    const GroupLanes all_groups(packet.bounds, raster);
    for_kind(basis, packet, [&](const auto& make) {
        Pairs pairs;
        for (LaneBits lanes = all; lanes != 0; lanes &= lanes - 1) {
            const int lane = std::countr_zero(lanes);
            const Reach reach(packet.bounds, lane);
            const Groups groups = all_groups.of(lane);
            const auto primitive = make(packet, lane);
            for (int row = groups.top; row <= groups.bottom; ++row) {
                for (int column = groups.left; column <= groups.right; ++column) {
                    pairs.add(primitive, lane, reach, raster, column, row);
                    if (pairs.full()) pairs.test(make, packets, index, raster);
                }
            }
        }
        pairs.test(make, packets, index, raster);
    });
    update_farthest(raster);
}

bool raster_matters(const BoundsPacket& bounds, int lane, const FrontRaster& raster) {
    const Reach reach(bounds, lane);
    const Groups groups = GroupLanes(bounds, raster).of(lane);
    for (int row = groups.top; row <= groups.bottom; ++row) {
        for (int column = groups.left; column <= groups.right; ++column) {
            for (int i = 0; i < kLanes; i += kStep) {
                const GroupCells cells(reach, raster, column, row, i);
                if (!hn::AllFalse(kFloats, cells.reached)) return true;
            }
        }
    }
    return false;
}

float raster_farthest(const FrontRaster& raster) {
    auto all = set(-kInfinity);
    for (int k = 0; k < raster.across * raster.down * kLanes; k += kStep) {
        all = hn::Max(all, hn::Load(kFloats, raster.farthest + k));
    }
    return hn::GetLane(hn::MaxOfLanes(kFloats, all));
}

// ---- Rays ----

void start_front(float centre_x, float centre_y, float slope_step, const PointPacket& points,
                 Front& front) {
    const auto infinity = set(kInfinity);
    const auto minus_infinity = set(-kInfinity);
    auto left = infinity;
    auto top = infinity;
    auto right = minus_infinity;
    auto bottom = minus_infinity;
    auto farthest = minus_infinity;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto on =
            hn::RebindMask(kFloats, hn::Ne(load(points.active, i), hn::Zero(kIntegers)));
        const auto x = hn::Sub(load(points.x, i), set(centre_x));
        const auto y = hn::Sub(load(points.y, i), set(centre_y));
        const auto slope_x = hn::Mul(x, set(slope_step));
        const auto slope_y = hn::Mul(y, set(slope_step));
        const auto squared =
            hn::Add(hn::Add(set(1.0F), hn::Mul(slope_x, slope_x)), hn::Mul(slope_y, slope_y));
        const auto depth = hn::IfThenElse(on, infinity, minus_infinity);
        hn::Store(x, kFloats, front.x.data() + i);
        hn::Store(y, kFloats, front.y.data() + i);
        hn::Store(hn::Div(set(1.0F), squared), kFloats, front.foreshortening.data() + i);
        hn::Store(depth, kFloats, front.depth.data() + i);
        left = hn::Min(left, hn::IfThenElse(on, x, infinity));
        top = hn::Min(top, hn::IfThenElse(on, y, infinity));
        right = hn::Max(right, hn::IfThenElse(on, x, minus_infinity));
        bottom = hn::Max(bottom, hn::IfThenElse(on, y, minus_infinity));
        farthest = hn::Max(farthest, depth);
    }
    front.window = {
        hn::GetLane(hn::MinOfLanes(kFloats, left)), hn::GetLane(hn::MaxOfLanes(kFloats, right)),
        hn::GetLane(hn::MinOfLanes(kFloats, top)), hn::GetLane(hn::MaxOfLanes(kFloats, bottom)),
        hn::GetLane(hn::MaxOfLanes(kFloats, farthest))};
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
HWY_EXPORT(raster_matters);
HWY_EXPORT(start_front);

LaneBits overlap(const BoundsPacket& bounds, const Window& window) {
    return HWY_DYNAMIC_DISPATCH(find_overlap)(bounds, window);
}

void set_union(const BoundsPacket& of, BoundsPacket& packet, int lane) {
    HWY_DYNAMIC_DISPATCH(find_union)(of, packet, lane);
}

void intersect(const Basis& basis, const ScreenPacket* packets, std::uint32_t index, Front& front) {
    HWY_DYNAMIC_DISPATCH(intersect_front)(basis, packets, index, front);
}

void intersect(const Basis& basis, const ScreenPacket* packets, std::uint32_t index,
               const FrontRaster& raster) {
    HWY_DYNAMIC_DISPATCH(intersect_raster)(basis, packets, index, raster);
}

float farthest_of(const FrontRaster& raster) {
    return HWY_DYNAMIC_DISPATCH(raster_farthest)(raster);
}

bool matters(const BoundsPacket& bounds, int lane, const FrontRaster& raster) {
    return HWY_DYNAMIC_DISPATCH(raster_matters)(bounds, lane, raster);
}

void Front::start(const Projection& projection, const PointPacket& points) {
    HWY_DYNAMIC_DISPATCH(start_front)
    (projection.centre.x, projection.centre.y, static_cast<float>(projection.slope_step), points,
     *this);
}

}  // namespace ink

#endif
