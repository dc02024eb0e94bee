#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace ink {

/// Values in [0, kMost] at the nodes of grids of several sizes, each computed when it is first
/// asked for. Threads that compute one at the same time find the same.
template <std::size_t kGrids>
class NodeMaps {
  public:
    static constexpr float kMost = 4.0F;

    NodeMaps() = default;
    NodeMaps(const NodeMaps&) = delete;
    NodeMaps& operator=(const NodeMaps&) = delete;
    ~NodeMaps() {
        for (auto& grid : grids_) delete[] grid.load();
    }

    /// A grid of `nodes` nodes, by its number.
    class Grid {
      public:
        explicit Grid(std::atomic<std::uint16_t>* nodes) : nodes_(nodes) {}
        template <class Compute>
        float value(std::size_t node, const Compute& compute) const {
            constexpr float kSteps = 65534.0F / kMost;
            std::uint16_t code = nodes_[node].load(std::memory_order_relaxed);
            if (code == 0) {
                const float value = std::min(compute(), kMost);
                code = static_cast<std::uint16_t>(1.0F + std::floor(value * kSteps + 0.5F));
                nodes_[node].store(code, std::memory_order_relaxed);
            }
            return static_cast<float>(code - 1) * (1.0F / kSteps);
        }

      private:
        std::atomic<std::uint16_t>* nodes_;
    };

    Grid grid(std::size_t number, std::size_t nodes) {
        std::atomic<std::uint16_t>* found = grids_[number].load(std::memory_order_acquire);
        if (found == nullptr) {
            auto fresh = std::make_unique<std::atomic<std::uint16_t>[]>(nodes);
            if (grids_[number].compare_exchange_strong(found, fresh.get())) {
                found = fresh.release();
            }
        }
        return Grid(found);
    }

  private:
    std::array<std::atomic<std::atomic<std::uint16_t>*>, kGrids> grids_{};
};

/// Things that are made when they are first asked for. Threads that make one at the same time make
/// the same.
template <class T>
class LazyTable {
  public:
    LazyTable() = default;
    explicit LazyTable(std::size_t count)
        : entries_(std::make_unique<std::atomic<T*>[]>(count)), count_(count) {}
    LazyTable(LazyTable&&) noexcept = default;
    LazyTable& operator=(LazyTable&&) noexcept = default;
    ~LazyTable() {
        for (std::size_t k = 0; entries_ && k < count_; ++k) delete entries_[k].load();
    }

    template <class Make>
    T& at(std::size_t k, const Make& make) const {
        T* found = entries_[k].load(std::memory_order_acquire);
        if (found == nullptr) {
            std::unique_ptr<T> fresh = make();
            if (entries_[k].compare_exchange_strong(found, fresh.get())) found = fresh.release();
        }
        return *found;
    }

  private:
    std::unique_ptr<std::atomic<T*>[]> entries_;
    std::size_t count_ = 0;
};

}  // namespace ink
