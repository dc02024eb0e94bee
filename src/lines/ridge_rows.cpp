#include "lines/ridge_rows.h"

#include <algorithm>
#include <array>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/ridge_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

#ifndef INK_RAY_RAMP
#define INK_RAY_RAMP
namespace ink {

/// A coordinate of rays, which is affine along a row.
struct RayRamp {
    float first, step;
};

}  // namespace ink
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

HWY_INLINE Number load(const float* from) { return hn::LoadU(kFloats, from); }

HWY_INLINE NodeBits link_some(const NodeRow& row_a, const NodeRow& row_b, std::size_t i) {
    const RidgeGrid& grid = row_a.grid;
    const std::size_t a = row_a.first + i;
    const std::size_t b = row_b.first + i;
    constexpr float kLeastCosine = 0.5F;
    constexpr float kChordSine = 0.6F;
    const auto id_a = hn::LoadU(kWords, grid.id.data() + a);
    const auto id_b = hn::LoadU(kWords, grid.id.data() + b);
    const NodeBits other = bits_of(hn::Ne(id_a, id_b));
    const NodeBits hit = bits_of(hn::Ne(id_a, hn::Set(kWords, kBackground)));
    const NodeBits alike = hit & ~other;
    if (alike == 0) return 0;
    const auto difference = [&](const auto& from, const auto& to) HWY_ATTR {
        return hn::Sub(load(to.data() + row_b.first_place + i),
                       load(from.data() + row_a.first_place + i));
    };
    const Vectors chord{difference(row_a.places.x, row_b.places.x),
                        difference(row_a.places.y, row_b.places.y),
                        difference(row_a.places.z, row_b.places.z)};
    const auto normal = [&](std::size_t at) HWY_ATTR {
        return Vectors{load(grid.nx.data() + at), load(grid.ny.data() + at),
                       load(grid.nz.data() + at)};
    };
    const Vectors na = normal(a);
    const Vectors nb = normal(b);
    const Vectors sum = na + nb;
    const Number along = dot(chord, sum);
    const Number most =
        hn::Mul(hn::Mul(set(kChordSine * kChordSine), dot(chord, chord)), dot(sum, sum));
    const auto flat = hn::Le(hn::Mul(along, along), most);
    const auto straight = hn::Gt(dot(na, nb), set(kLeastCosine));
    return alike & bits_of(hn::And(flat, straight));
}

/// Fills words with what `some(i)` says of the nodes from i on.
template <class Some>
HWY_INLINE void fill_words(int count, NodeBits* words, const Some& some) {
    for (int first = 0; first < count; first += kNodesInWord) {
        NodeBits word = 0;
        const int end = std::min(count - first, kNodesInWord);
        for (int i = 0; i < end; i += kStep) word |= some(first + i) << i;
        if (end < kNodesInWord) word &= (NodeBits{1} << end) - 1;
        *words++ = word;
    }
}

void link_nodes(const NodeRow& a, const NodeRow& b, int count, NodeBits* links) {
    fill_words(count, links,
               [&](int i) HWY_ATTR { return link_some(a, b, static_cast<std::size_t>(i)); });
}

HWY_INLINE Number at(const RayRamp& ramp, Number i) {
    return hn::Add(set(ramp.first), hn::Mul(set(ramp.step), i));
}

void place_row(const GeometryId* ids, const float* t, int count,
               const std::array<RayRamp, 3>& origin, const std::array<RayRamp, 3>& direction,
               NodePlaces& places) {
    const auto background = hn::Set(kWords, kBackground);
    for (int first = 0; first < count; first += kStep) {
        if (hn::AllTrue(kWords, hn::Eq(hn::LoadU(kWords, ids + first), background))) continue;
        const Number i = hn::Iota(kFloats, static_cast<float>(first));
        const Vectors d{at(direction[0], i), at(direction[1], i), at(direction[2], i)};
        const Number scale = hn::Div(load(t + first), hn::Sqrt(dot(d, d)));
        const auto place = [&](const RayRamp& from, Number along, std::vector<float>& to) HWY_ATTR {
            hn::StoreU(hn::Add(at(from, i), hn::Mul(along, scale)), kFloats, to.data() + first);
        };
        place(origin[0], d.x, places.x);
        place(origin[1], d.y, places.y);
        place(origin[2], d.z, places.z);
    }
}

/// Sums for the derivatives of one component of the normals, by whether a derivative changes its
/// sign when x does, and when y does. Of points that mirror each other, the normals are added up
/// before they are weighed.
class Derivatives {
  public:
    HWY_INLINE explicit Derivatives(const float* normals)
        : normals_(normals), centre_(load(normals)) {}

    HWY_INLINE void add_on_x(const MirroredPoints& points) {
        const Number a = load(normals_ + points.offsets[0]);
        const Number b = load(normals_ - points.offsets[0]);
        add_odd_in_x(points, hn::Sub(a, b));
        add_even(points, even(a, b));
    }
    HWY_INLINE void add_on_y(const MirroredPoints& points) {
        const Number a = load(normals_ + points.offsets[0]);
        const Number b = load(normals_ - points.offsets[0]);
        add_odd_in_y(points, hn::Sub(a, b));
        add_even(points, even(a, b));
    }
    HWY_INLINE void add_off_axes(const MirroredPoints& points) {
        const Number a = load(normals_ + points.offsets[0]);
        const Number b = load(normals_ + points.offsets[1]);
        const Number c = load(normals_ - points.offsets[1]);
        const Number d = load(normals_ - points.offsets[0]);
        // With x on one side, and on the other.
        const Number right = even(a, c);
        const Number left = even(b, d);
        const Number right_odd = hn::Sub(a, c);
        const Number left_odd = hn::Sub(b, d);
        add_odd_in_x(points, hn::Sub(right, left));
        add_odd_in_y(points, hn::Add(right_odd, left_odd));
        add_even(points, hn::Add(right, left));
        add(xy_, hn::Sub(right_odd, left_odd), points.weights[3]);
    }
    HWY_INLINE void store(DerivativeRows& rows, std::size_t component, int i) const {
        const std::array<const Number*, RidgeEstimator::kDerivatives> sums{
            &x_, &y_, &xx_, &xy_, &yy_, &xxx_, &xxy_, &xyy_, &yyy_};
        for (std::size_t k = 0; k < sums.size(); ++k) {
            hn::Store(*sums[k], kFloats, rows[k][component].data() + i);
        }
    }

  private:
    HWY_INLINE Number even(Number a, Number b) const {
        return hn::Add(hn::Sub(a, centre_), hn::Sub(b, centre_));
    }
    static HWY_INLINE void add(Number& sum, Number value, float weight) {
        sum = hn::Add(sum, hn::Mul(value, set(weight)));
    }
    HWY_INLINE void add_odd_in_x(const MirroredPoints& points, Number value) {
        add(x_, value, points.weights[0]);
        add(xxx_, value, points.weights[5]);
        add(xyy_, value, points.weights[7]);
    }
    HWY_INLINE void add_odd_in_y(const MirroredPoints& points, Number value) {
        add(y_, value, points.weights[1]);
        add(xxy_, value, points.weights[6]);
        add(yyy_, value, points.weights[8]);
    }
    HWY_INLINE void add_even(const MirroredPoints& points, Number value) {
        add(xx_, value, points.weights[2]);
        add(yy_, value, points.weights[4]);
    }

    const float* normals_;
    Number centre_;
    Number x_ = hn::Zero(kFloats), y_ = x_, xx_ = x_, xy_ = x_, yy_ = x_;
    Number xxx_ = x_, xxy_ = x_, xyy_ = x_, yyy_ = x_;
};

void differentiate(const RidgeGrid& grid, std::size_t first, const MirroredPattern& pattern,
                   DerivativeRows& rows) {
    const std::array normals{grid.nx.data() + first, grid.ny.data() + first,
                             grid.nz.data() + first};
    for (std::size_t k = 0; k < normals.size(); ++k) {
        for (int i = 0; i < kLanes; i += kStep) {
            Derivatives derivatives(normals[k] + i);
            for (const MirroredPoints& points : pattern.on_x) derivatives.add_on_x(points);
            for (const MirroredPoints& points : pattern.on_y) derivatives.add_on_y(points);
            for (const MirroredPoints& points : pattern.off_axes) derivatives.add_off_axes(points);
            derivatives.store(rows, k, i);
        }
    }
}

void cross_rows(const RidgeRow& a, const RidgeRow& b, int count, NodeBits* crossed) {
    const Number zero = hn::Zero(kFloats);
    fill_words(count, crossed, [&](int i) HWY_ATTR {
        const auto strong =
            hn::And(hn::Gt(load(a.strength + i), zero), hn::Gt(load(b.strength + i), zero));
        const NodeBits both = bits_of(strong);
        if (both == 0) return NodeBits{0};
        const Number turn = hn::Add(hn::Mul(load(a.along_x + i), load(b.along_x + i)),
                                    hn::Mul(load(a.along_y + i), load(b.along_y + i)));
        const Number g = load(a.slope + i);
        const Number opposite = load(b.slope + i);
        const Number h = hn::IfThenElse(hn::Lt(turn, zero), hn::Neg(opposite), opposite);
        // Where the slope is zero between the two, times something above zero.
        const Number bend =
            hn::Add(hn::Mul(load(a.bend + i), hn::Abs(h)), hn::Mul(load(b.bend + i), hn::Abs(g)));
        return both & bits_of(hn::Lt(bend, zero)) &
               (bits_of(hn::Lt(g, zero)) ^ bits_of(hn::Lt(h, zero)));
    });
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(link_nodes);
HWY_EXPORT(place_row);
HWY_EXPORT(differentiate);
HWY_EXPORT(cross_rows);

void link_nodes(const NodeRow& a, const NodeRow& b, int count, NodeBits* links) {
    HWY_DYNAMIC_DISPATCH(link_nodes)(a, b, count, links);
}

void place_nodes(const RidgeGrid& grid, int row, const Viewpoint& viewpoint, NodePlaces& places) {
    const auto ramps = [&](const Viewpoint::Affine& rays) {
        const Vec3f first = to_float(rays(grid.point(0, row)));
        const Vec3f step = to_float(rays.dx * static_cast<double>(grid.spacing));
        return std::array<RayRamp, 3>{{{first.x, step.x}, {first.y, step.y}, {first.z, step.z}}};
    };
    HWY_DYNAMIC_DISPATCH(place_row)
    (grid.id.data() + grid.index(0, row), grid.t.data() + grid.index(0, row), grid.width,
     ramps(viewpoint.origin), ramps(viewpoint.direction), places);
}

void differentiate(const RidgeGrid& grid, std::size_t first, const MirroredPattern& pattern,
                   DerivativeRows& derivatives) {
    HWY_DYNAMIC_DISPATCH(differentiate)(grid, first, pattern, derivatives);
}

void cross_rows(const RidgeRow& a, const RidgeRow& b, int count, NodeBits* crossed) {
    HWY_DYNAMIC_DISPATCH(cross_rows)(a, b, count, crossed);
}

}  // namespace ink

#endif
