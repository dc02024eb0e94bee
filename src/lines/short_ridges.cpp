#include "lines/short_ridges.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace ink {

namespace {

/// The last piece that named an edge. Pieces come row by row, so that of the edges that are named
/// between the cells on either side of one, none is farther from it than a row, in the order of
/// their indices: entries may be shared by those that are farther.
class EdgeTable {
  public:
    explicit EdgeTable(int width) : last_(std::bit_ceil(2 * static_cast<std::size_t>(width) + 4)) {}

    /// The piece that named this edge before, or this one.
    std::uint32_t first(std::size_t edge, std::uint32_t piece) {
        Entry& entry = last_[edge & (last_.size() - 1)];
        if (entry.edge != edge) entry = {edge, piece};
        return entry.piece;
    }

  private:
    struct Entry {
        std::size_t edge = ~std::size_t{0};
        std::uint32_t piece = 0;
    };

    std::vector<Entry> last_;
};

/// Pieces in groups, each of which hangs together.
class Groups {
  public:
    explicit Groups(std::size_t count) : parents_(count) {
        std::iota(parents_.begin(), parents_.end(), 0U);
    }
    std::uint32_t root(std::uint32_t k) {
        while (parents_[k] != k) k = parents_[k] = parents_[parents_[k]];
        return k;
    }
    void join(std::uint32_t a, std::uint32_t b) { parents_[root(a)] = root(b); }

  private:
    std::vector<std::uint32_t> parents_;
};

}  // namespace

void drop_short_ridges(std::vector<RidgePiece>& pieces, std::span<const float> lengths, int width,
                       float radius) {
    const auto count = static_cast<std::uint32_t>(pieces.size());
    EdgeTable table(width);
    Groups groups(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        for (const std::size_t edge : pieces[k].edges) groups.join(k, table.first(edge, k));
    }
    std::vector<float> sums(count, 0.0F);
    for (std::uint32_t k = 0; k < count; ++k) sums[groups.root(k)] += lengths[k];
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        if (sums[groups.root(k)] >= 2.0F * radius) pieces[kept++] = pieces[k];
    }
    pieces.resize(kept);
}

}  // namespace ink
