#include "sampling/shared_edges.h"

#include <algorithm>
#include <array>
#include <cstddef>

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sampling/shared_edges.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

HWY_INLINE Word word(std::uint32_t value) { return hn::Set(kWords, value); }
HWY_INLINE Word times_three(Word n) { return hn::Add(hn::Add(n, n), n); }

HWY_INLINE Word gather(const std::uint32_t* from, Word at) {
    return hn::BitCast(kWords,
                       hn::GatherIndex(kIntegers, reinterpret_cast<const std::int32_t*>(from),
                                       hn::BitCast(kIntegers, at)));
}

HWY_INLINE Vectors gather(const Vec3f* vertices, Word vertex) {
    const float* const from = &vertices->x;
    const auto at = hn::BitCast(kIntegers, times_three(vertex));
    return {hn::GatherIndex(kFloats, from, at), hn::GatherIndex(kFloats, from + 1, at),
            hn::GatherIndex(kFloats, from + 2, at)};
}

/// From the viewer to a point.
HWY_INLINE Vectors view_of(const Viewpoint& viewpoint, const Vectors& point) {
    return viewpoint.parallel ? set(viewpoint.dir) : point - set(viewpoint.eye);
}

using Corners = std::array<Word, 3>;

HWY_INLINE Corners corners_of(const Mesh& mesh, Word triangle) {
    const std::uint32_t* const corners = mesh.triangles.data()->data();
    const auto at = times_three(triangle);
    return {gather(corners, at), gather(corners + 1, at), gather(corners + 2, at)};
}

/// How two triangles lie side by side, if `found`: along the edge from p to q of the first one, its
/// edge number k, which the second one runs the other way; and their third corners.
struct Shared {
    Word k, p, q, apex, other_apex;
    hn::Mask<Words> found;

    HWY_INLINE Shared(const Corners& a, const Corners& b)
        : k(word(0)), p(a[0]), q(a[1]), apex(a[2]), other_apex(b[2]), found(hn::Ne(k, k)) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            for (std::uint32_t j = 0; j < 3; ++j) {
                const auto here =
                    hn::And(hn::Eq(a[i], b[(j + 1) % 3]), hn::Eq(a[(i + 1) % 3], b[j]));
                found = hn::Or(found, here);
                k = hn::IfThenElse(here, word(i), k);
                p = hn::IfThenElse(here, a[i], p);
                q = hn::IfThenElse(here, a[(i + 1) % 3], q);
                apex = hn::IfThenElse(here, a[(i + 2) % 3], apex);
                other_apex = hn::IfThenElse(here, b[(j + 2) % 3], other_apex);
            }
        }
    }
};

/// Whether the viewer sees the third corners of both triangles on different sides of their edge.
HWY_INLINE Mask face_alike(const Mesh& mesh, const Viewpoint& viewpoint, const Shared& shared) {
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
HWY_INLINE Word shared_edges(const Mesh& mesh, const Viewpoint& viewpoint, Word first, Word second,
                             hn::Mask<Words> known) {
    const auto own = hn::IfThenElseZero(known, first);
    const Shared shared(corners_of(mesh, own), corners_of(mesh, hn::IfThenElseZero(known, second)));
    const auto alike = hn::RebindMask(kWords, face_alike(mesh, viewpoint, shared));
    return hn::IfThenElse(hn::And(hn::And(known, shared.found), alike),
                          hn::Add(times_three(own), shared.k), word(Mesh::kNoTwin));
}

void find_shared(const Mesh& mesh, const Viewpoint& viewpoint, std::uint32_t base,
                 std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                 std::span<std::uint32_t> edges) {
    const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size());
    for (std::size_t k = 0; k < first.size(); k += kStep) {
        const std::size_t count = std::min<std::size_t>(kStep, first.size() - k);
        const auto load = [&](std::span<const std::uint32_t> from) {
            if (count == kStep) return hn::LoadU(kWords, from.data() + k);
            Lanes<std::uint32_t> last{};
            std::copy_n(from.data() + k, count, last.data());
            return hn::LoadU(kWords, last.data());
        };
        const auto a = hn::Sub(load(first), word(base));
        const auto b = hn::Sub(load(second), word(base));
        const auto known = hn::And(hn::Lt(a, word(triangles)), hn::Lt(b, word(triangles)));
        const auto found = shared_edges(mesh, viewpoint, a, b, known);
        if (count == kStep) {
            hn::StoreU(found, kWords, edges.data() + k);
        } else {
            Lanes<std::uint32_t> last{};
            hn::StoreU(found, kWords, last.data());
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
