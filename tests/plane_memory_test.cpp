#include "base/plane_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include "base/image.h"

namespace ink {
namespace {

constexpr std::size_t kMegabyte = std::size_t{1} << 20;

TEST(PlaneMemory, OfASizeGoesFromPictureToPicture) {
    void* const first = take_plane_memory(3 * kMegabyte);
    give_plane_memory(first, 3 * kMegabyte);
    void* const again = take_plane_memory(3 * kMegabyte);
    EXPECT_EQ(again, first);
    void* const other = take_plane_memory(3 * kMegabyte);
    EXPECT_NE(other, first);
    give_plane_memory(again, 3 * kMegabyte);
    give_plane_memory(other, 3 * kMegabyte);
}

TEST(PlaneMemory, OfLargePlanesBeginsOnALargePage) {
    for (const std::size_t bytes : {kMegabyte, 2 * kMegabyte, 5 * kMegabyte + 4}) {
        void* const plane = take_plane_memory(bytes);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(plane) % (2 * kMegabyte), 0U) << bytes;
        std::memset(plane, 1, bytes);
        give_plane_memory(plane, bytes);
    }
}

TEST(PlaneMemory, BeginsOnACacheLineWhateverItsSize) {
    std::vector<std::pair<void*, std::size_t>> taken;
    for (std::size_t bytes = 1; bytes < 4 * kMegabyte; bytes = bytes * 3 / 2 + 1) {
        taken.emplace_back(take_plane_memory(bytes), bytes);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(taken.back().first) % 64, 0U) << bytes;
    }
    for (const auto& [plane, bytes] : taken) give_plane_memory(plane, bytes);
}

TEST(PlaneMemory, OfPlanesOfAnySizeIsTheirsAlone) {
    // Together more than is kept, and of more sizes.
    std::vector<Plane<std::uint32_t>> planes;
    for (int round = 0; round < 3; ++round) {
        for (std::uint32_t k = 0; k < 40; ++k) {
            planes.emplace_back(std::size_t{1} + k * k * 400, round * 100 + k);
        }
        for (std::uint32_t k = 0; k < 40; ++k) {
            const Plane<std::uint32_t>& plane = planes[k];
            EXPECT_EQ(plane.front(), round * 100 + k);
            EXPECT_EQ(plane.back(), round * 100 + k);
        }
        planes.clear();
    }
}

TEST(PlaneMemory, MayBeTakenAndGivenByManyThreads) {
    const auto work = [](std::uint32_t name) {
        for (std::uint32_t k = 0; k < 40; ++k) {
            const Plane<std::uint32_t> plane((k % 5 + 1) * 100'000, name);
            EXPECT_EQ(plane.front(), name);
            EXPECT_EQ(plane.back(), name);
        }
    };
    std::vector<std::jthread> threads;
    for (std::uint32_t name = 1; name <= 4; ++name) threads.emplace_back(work, name);
}

}  // namespace
}  // namespace ink
