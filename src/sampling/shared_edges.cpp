#include "sampling/shared_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "base/lanes.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling/shared_edges.cpp"
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
constexpr std::size_t kStep = hn::MaxLanes(Floats());
using Float = hn::Vec<Floats>;
using Number = hn::Vec<Numbers>;

HWY_INLINE Number number(std::uint32_t value) { return hn::Set(kNumbers, value); }
HWY_INLINE Number times_three(Number n) { return hn::Add(hn::Add(n, n), n); }

HWY_INLINE Number gather(const std::uint32_t* from, Number at) {
    return hn::BitCast(kNumbers,
                       hn::GatherIndex(kIntegers, reinterpret_cast<const std::int32_t*>(from),
                                       hn::BitCast(kIntegers, at)));
}

struct Vectors {
    Float x, y, z;

    HWY_INLINE Vectors operator-(const Vectors& b) const {
        return {hn::Sub(x, b.x), hn::Sub(y, b.y), hn::Sub(z, b.z)};
    }
};

HWY_INLINE Vectors set(Vec3f v) {
    return {hn::Set(kFloats, v.x), hn::Set(kFloats, v.y), hn::Set(kFloats, v.z)};
}

HWY_INLINE Float dot(const Vectors& a, const Vectors& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
            hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

HWY_INLINE Vectors gather(const Vec3f* vertices, Number vertex) {
    const float* const from = &vertices->x;
    const auto at = hn::BitCast(kIntegers, times_three(vertex));
    return {hn::GatherIndex(kFloats, from, at), hn::GatherIndex(kFloats, from + 1, at),
            hn::GatherIndex(kFloats, from + 2, at)};
}

/// From the viewer to a point.
HWY_INLINE Vectors view_of(const Viewpoint& viewpoint, const Vectors& point) {
    return viewpoint.parallel ? set(viewpoint.dir) : point - set(viewpoint.eye);
}

using Corners = std::array<Number, 3>;

HWY_INLINE Corners corners_of(const Mesh& mesh, Number triangle) {
    const std::uint32_t* const corners = mesh.triangles.data()->data();
    const auto at = times_three(triangle);
    return {gather(corners, at), gather(corners + 1, at), gather(corners + 2, at)};
}

/// How two triangles lie side by side, if `found`: along the edge from p to q of the first one, its
/// edge number k, which the second one runs the other way; and their third corners.
struct Shared {
    Number k, p, q, apex, other_apex;
    hn::Mask<Numbers> found;

    HWY_INLINE Shared(const Corners& a, const Corners& b)
        : k(number(0)), p(a[0]), q(a[1]), apex(a[2]), other_apex(b[2]), found(hn::Ne(k, k)) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            for (std::uint32_t j = 0; j < 3; ++j) {
                const auto here =
                    hn::And(hn::Eq(a[i], b[(j + 1) % 3]), hn::Eq(a[(i + 1) % 3], b[j]));
                found = hn::Or(found, here);
                k = hn::IfThenElse(here, number(i), k);
                p = hn::IfThenElse(here, a[i], p);
                q = hn::IfThenElse(here, a[(i + 1) % 3], q);
                apex = hn::IfThenElse(here, a[(i + 2) % 3], apex);
                other_apex = hn::IfThenElse(here, b[(j + 2) % 3], other_apex);
            }
        }
    }
};

/// Whether the viewer sees the third corners of both triangles on different sides of their edge.
HWY_INLINE hn::Mask<Floats> face_alike(const Mesh& mesh, const Viewpoint& viewpoint,
                                       const Shared& shared) {
    const Vec3f* const vertices = mesh.vertices.data();
    const auto at = gather(vertices, shared.p);
    const auto along = gather(vertices, shared.q) - at;
    const auto view = view_of(viewpoint, at);
    const auto side = dot(cross(along, gather(vertices, shared.apex) - at), view);
    const auto other = dot(cross(along, gather(vertices, shared.other_apex) - at), view);
    const auto zero = hn::Zero(kFloats);
    return hn::Or(hn::And(hn::Lt(side, zero), hn::Gt(other, zero)),
                  hn::And(hn::Gt(side, zero), hn::Lt(other, zero)));
}

/// Of some pairs; those that are none must not be `known`.
HWY_INLINE Number shared_edges(const Mesh& mesh, const Viewpoint& viewpoint, Number first,
                               Number second, hn::Mask<Numbers> known) {
    const auto own = hn::IfThenElseZero(known, first);
    const Shared shared(corners_of(mesh, own), corners_of(mesh, hn::IfThenElseZero(known, second)));
    const auto alike = hn::RebindMask(kNumbers, face_alike(mesh, viewpoint, shared));
    return hn::IfThenElse(hn::And(hn::And(known, shared.found), alike),
                          hn::Add(times_three(own), shared.k), number(Mesh::kNoTwin));
}

void find_shared(const Mesh& mesh, const Viewpoint& viewpoint, std::uint32_t base,
                 std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                 std::span<std::uint32_t> edges) {
    const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    for (std::size_t k = 0; k < first.size(); k += kStep) {
        const std::size_t count = std::min(kStep, first.size() - k);
        const auto load = [&](std::span<const std::uint32_t> from) {
            if (count == kStep) return hn::LoadU(kNumbers, from.data() + k);
            Lanes<std::uint32_t> last{};
            std::copy_n(from.data() + k, count, last.data());
            return hn::LoadU(kNumbers, last.data());
        };
        const auto a = hn::Sub(load(first), number(base));
        const auto b = hn::Sub(load(second), number(base));
        const auto known = hn::And(hn::Lt(a, number(triangles)), hn::Lt(b, number(triangles)));
        const auto found = shared_edges(mesh, viewpoint, a, b, known);
        if (count == kStep) {
            hn::StoreU(found, kNumbers, edges.data() + k);
        } else {
            Lanes<std::uint32_t> last{};
            hn::StoreU(found, kNumbers, last.data());
            std::copy_n(last.data(), count, edges.data() + k);
        }
    }
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(find_shared);

void find_shared_edges(const Mesh& mesh, const Viewpoint& viewpoint, std::uint32_t base,
                       std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                       std::span<std::uint32_t> edges) {
    HWY_DYNAMIC_DISPATCH(find_shared)(mesh, viewpoint, base, first, second, edges);
}

}  // namespace ink

#endif
