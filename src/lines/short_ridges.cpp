#include "lines/short_ridges.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace ink {

namespace {

/// The last piece that named an edge, by the edge's column and direction: the two cells on either
/// side of an edge follow each other among those of their column or row.
class EdgeTable {
  public:
    explicit EdgeTable(int width) : width_(static_cast<std::size_t>(width)), last_(2 * width_) {}

    /// The piece that named this edge before, or this one.
    std::uint32_t first(std::size_t edge, std::uint32_t piece) {
        Entry& entry = last_[2 * (edge / 2 % width_) + edge % 2];
        if (entry.edge != edge) entry = {edge, piece};
        return entry.piece;
    }

  private:
    struct Entry {
        std::size_t edge = ~std::size_t{0};
        std::uint32_t piece = 0;
    };

    std::size_t width_;
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

void drop_short_ridges(std::vector<RidgePiece>& pieces, int width, float least) {
    const auto count = static_cast<std::uint32_t>(pieces.size());
    EdgeTable table(width);
    Groups groups(count);
    for (std::uint32_t k = 0; k < count; ++k) {
        for (const std::size_t edge : pieces[k].edges) groups.join(k, table.first(edge, k));
    }
    std::vector<float> lengths(count, 0.0F);
    for (std::uint32_t k = 0; k < count; ++k) {
        lengths[groups.root(k)] += length(pieces[k].b - pieces[k].a);
    }
    std::uint32_t kept = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        if (lengths[groups.root(k)] >= least) pieces[kept++] = pieces[k];
    }
    pieces.resize(kept);
}

}  // namespace ink
