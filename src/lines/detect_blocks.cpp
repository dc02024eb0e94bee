#include "lines/detect_blocks.h"

#include <algorithm>
#include <memory>

#include "lines/suspect_bits.h"

// Everything between the two namespace macros is built once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lines/detect_blocks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "lines/detect_lanes-inl.h"

#ifndef INK_DETECT_BLOCKS
#define INK_DETECT_BLOCKS
namespace ink {

/// The edges that hang on the points of a block, the first of which is (i, j).
struct SuspectBlock {
    int i, j;
    SuspectBits right, down;
};

}  // namespace ink
#endif

HWY_BEFORE_NAMESPACE();
namespace ink::HWY_NAMESPACE {

/// What the points of a block saw.
struct BlockView {
    const Lanes<GeometryId>* ids;
    const Lanes<std::uint32_t>* surfaces;
    const Vec3Lanes* places;
    const Vec3Lanes* normals;

    /// Of a packet; of none, background, and anything else.
    BlockView(const SampleBlocks& blocks, std::uint32_t packet) {
        static constexpr Lanes<GeometryId> kAllBackground{};
        static_assert(kBackground == 0);
        const std::uint32_t some = packet == SampleBlocks::kNothing ? 0 : packet;
        ids = packet == SampleBlocks::kNothing ? &kAllBackground : blocks.ids + some;
        surfaces = blocks.surfaces + some;
        places = blocks.places + some;
        normals = blocks.normals + some;
    }
};

// From lane i of a block on: its own points, those on their right, and those below them, of which
// some are in the next block.

template <class T>
HWY_INLINE auto own_points(const Lanes<T>& own, int i) {
    return load(own, i);
}

template <class T>
HWY_INLINE auto points_on_right(const Lanes<T>& own, const Lanes<T>& right, int i) {
    return hn::CombineShiftRightLanes<1>(hn::CappedTag<T, kLanes>(), load(right, i), load(own, i));
}

template <class Tag, class T>
HWY_INLINE hn::Vec<Tag> rows_below(Tag tag, const Lanes<T>& own, const Lanes<T>& below, int i) {
    constexpr auto kCount = static_cast<int>(hn::MaxLanes(Tag()));
    if (i + kCount < kLanes) return hn::LoadU(tag, own.data() + i + kBlockSide);
    if constexpr (kCount == kBlockSide) {
        return hn::LoadU(tag, below.data());
    } else {
        constexpr hn::Half<Tag> kHalf;
        return hn::Combine(tag, rows_below(kHalf, own, below, i + kCount / 2),
                           hn::LoadU(kHalf, own.data() + i + kBlockSide));
    }
}

template <class T>
HWY_INLINE auto points_below(const Lanes<T>& own, const Lanes<T>& below, int i) {
    return rows_below(hn::CappedTag<T, kLanes>(), own, below, i);
}

/// `points` takes a plane of a block, and the same of its neighbour.
template <class Points>
HWY_INLINE Surface surface_of(const BlockView& own, const BlockView& other, const Points& points) {
    return {points(own.places->x, other.places->x),   points(own.places->y, other.places->y),
            points(own.places->z, other.places->z),   points(own.normals->x, other.normals->x),
            points(own.normals->y, other.normals->y), points(own.normals->z, other.normals->z)};
}

/// Bits of a block's points that have a neighbour.
struct Neighbours {
    std::uint32_t right, below;
};

/// Finds the suspects among the edges that hang on a block's points.
HWY_INLINE void compare_block(const BlockView& own, const BlockView& right, const BlockView& below,
                              Neighbours has, const DetectSettings& settings,
                              const Thresholds& thresholds, SuspectBlock& found) {
    SuspectBits& across = found.right;
    SuspectBits& along = found.down;
    std::uint32_t hit = 0;
    std::uint32_t shared_right = 0;
    std::uint32_t shared_below = 0;
    for (int i = 0; i < kLanes; i += kStep) {
        const auto id = own_points(*own.ids, i);
        hit |= compare_ids(id, points_on_right(*own.ids, *right.ids, i), i, across);
        compare_ids(id, points_below(*own.ids, *below.ids, i), i, along);
        const auto surface = own_points(*own.surfaces, i);
        const auto on_right = points_on_right(*own.surfaces, *right.surfaces, i);
        shared_right |= share_surface(surface, on_right, i);
        shared_below |= share_surface(surface, points_below(*own.surfaces, *below.surfaces, i), i);
    }
    across.id &= has.right;
    along.id &= has.below;
    const std::uint32_t rest_right = hit & has.right & ~across.id & ~shared_right;
    const std::uint32_t rest_below = hit & has.below & ~along.id & ~shared_below;
    if ((rest_right | rest_below) == 0 || !(settings.depths || settings.normals)) return;
    for (int i = 0; i < kLanes; i += kStep) {
        using Plane = Lanes<float>;
        const auto here = surface_of(
            own, own, [i](const Plane& a, const Plane&) HWY_ATTR { return own_points(a, i); });
        const auto on_right = surface_of(own, right, [i](const Plane& a, const Plane& b) HWY_ATTR {
            return points_on_right(a, b, i);
        });
        const auto under = surface_of(own, below, [i](const Plane& a, const Plane& b) HWY_ATTR {
            return points_below(a, b, i);
        });
        compare_surfaces(here, on_right, i, thresholds, across);
        compare_surfaces(here, under, i, thresholds, along);
    }
    keep(rest_right, settings, across);
    keep(rest_below, settings, along);
}

/// Bits of the points in the first columns and rows of a block.
HWY_INLINE std::uint32_t points_within(int columns, int rows) {
    const auto first = [](int count) { return (1U << static_cast<unsigned>(count)) - 1; };
    constexpr std::uint32_t kFirstColumn = 0x1111;
    return first(std::min(columns, kBlockSide)) * kFirstColumn &
           first(std::min(rows, kBlockSide) * kBlockSide);
}

/// Returns how many blocks have a suspect.
std::size_t compare_blocks(const SampleBlocks& blocks, const DetectSettings& settings,
                           SuspectBlock* found) {
    const Thresholds thresholds(settings);
    const SuspectBlock* const before = found;
    const auto packet = [&](int column, int row) {
        if (column >= blocks.across || row >= blocks.down) return SampleBlocks::kNothing;
        return blocks.packet_at[static_cast<std::size_t>(row * blocks.across + column)];
    };
    for (int row = 0; row < blocks.down; ++row) {
        for (int column = 0; column < blocks.across; ++column) {
            const std::uint32_t own = packet(column, row);
            const std::uint32_t right = packet(column + 1, row);
            const std::uint32_t below = packet(column, row + 1);
            if ((own & right & below) == SampleBlocks::kNothing) continue;
            const int i = column * kBlockSide;
            const int j = row * kBlockSide;
            const int columns = blocks.width - i;
            const int rows = blocks.height - j;
            *found = {i, j, {}, {}};
            compare_block(BlockView(blocks, own), BlockView(blocks, right),
                          BlockView(blocks, below),
                          {points_within(columns - 1, rows), points_within(columns, rows - 1)},
                          settings, thresholds, *found);
            if ((found->right.any() | found->down.any()) != 0) ++found;
        }
    }
    return static_cast<std::size_t>(found - before);
}

}  // namespace ink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace ink {

HWY_EXPORT(compare_blocks);

void detect(const SampleBlocks& blocks, const DetectSettings& settings,
            std::vector<SuspectEdge>& edges) {
    edges.clear();
    // One more, for what has no suspects.
    const auto found = std::make_unique_for_overwrite<SuspectBlock[]>(blocks.packet_at.size() + 1);
    const std::size_t count = HWY_DYNAMIC_DISPATCH(compare_blocks)(blocks, settings, found.get());
    for (std::size_t k = 0; k < count; ++k) {
        const SuspectBlock& block = found[k];
        const auto point = [&](int bit) {
            return std::pair{block.i + bit % kBlockSide, block.j + bit / kBlockSide};
        };
        constexpr std::uint32_t kAll = 0xFFFF;
        block.right.list(kAll, false, point, edges);
        block.down.list(kAll, true, point, edges);
    }
}

}  // namespace ink

#endif
