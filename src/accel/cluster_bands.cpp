#include "accel/cluster_bands.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/multiversion.h"

namespace ink {

namespace {

/// Numbers in the order of the floats.
std::uint32_t sortable(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);  // of two zeros the positive one
    constexpr std::uint32_t kSign = 0x80000000U;
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

struct Entry {
    std::uint32_t key, cluster;
};

/// By key; entries of equal keys stay in order.
void radix_sort(std::vector<Entry>& entries) {
    constexpr unsigned kDigit = 11;
    std::vector<Entry> other(entries.size());
    for (unsigned shift = 0; shift < 32; shift += kDigit) {
        std::array<std::uint32_t, (1U << kDigit) + 1> starts{};
        const auto digit = [&](const Entry& entry) {
            return entry.key >> shift & ((1U << kDigit) - 1);
        };
        for (const Entry& entry : entries) ++starts[digit(entry) + 1];
        for (std::size_t k = 1; k < starts.size(); ++k) starts[k] += starts[k - 1];
        for (const Entry& entry : entries) other[starts[digit(entry)]++] = entry;
        entries.swap(other);
    }
}

}  // namespace

ClusterBands::ClusterBands(const BoundsPyramid& pyramid, std::size_t count, Vec2f centre)
    : order_(count),
      bounds_((count + kLanes - 1) / kLanes, BoundsPacket::none()),
      words_((count + 63) / 64),
      of_column_(kBands * words_),
      of_row_(kBands * words_),
      cover_(centre) {
    sort(pyramid);
    lay_axes(pyramid.at(pyramid.top(), 0), centre);
    for (std::size_t place = 0; place < count; ++place) add(place);
}

void ClusterBands::add(std::size_t place) {
    const BoundsPacket& all = bounds_[place / kLanes];
    const auto lane = static_cast<int>(place % kLanes);
    const Window bounds{all.left[lane], all.right[lane], all.top[lane], all.bottom[lane], 0.0F};
    const std::uint64_t bit = std::uint64_t{1} << place % 64;
    const auto mark = [&](const Axis& axis, float from, float to, auto& bands) {
        for (int k = axis.band(from); k <= axis.band(to); ++k) {
            bands[static_cast<std::size_t>(k) * words_ + place / 64] |= bit;
        }
    };
    mark(columns_, bounds.left, bounds.right, of_column_);
    mark(rows_, bounds.top, bounds.bottom, of_row_);
    cover_.add(bounds);
}

namespace {

INKTRACE_MULTIVERSION
void unite(const std::uint64_t* bands, std::size_t count, std::size_t words, std::uint64_t* all) {
    for (std::size_t k = 0; k < words; ++k) all[k] = bands[k];
    for (std::size_t band = 1; band < count; ++band) {
        bands += words;
        for (std::size_t k = 0; k < words; ++k) all[k] |= bands[k];
    }
}

INKTRACE_MULTIVERSION
void intersect(const std::uint64_t* bands, std::size_t words, std::uint64_t* all) {
    for (std::size_t k = 0; k < words; ++k) all[k] &= bands[k];
}

}  // namespace

void ClusterBands::find(const Window& window, std::vector<std::uint64_t>& places) const {
    places.resize(2 * words_);
    const auto among = [&](const Axis& axis, float from, float to, const auto& bands,
                           std::uint64_t* all) {
        const auto first = static_cast<std::size_t>(axis.band(from));
        const auto last = static_cast<std::size_t>(axis.band(to));
        unite(&bands[first * words_], last - first + 1, words_, all);
    };
    among(columns_, window.left, window.right, of_column_, places.data());
    among(rows_, window.top, window.bottom, of_row_, places.data() + words_);
    intersect(places.data() + words_, words_, places.data());
    places.resize(words_);
}

/// By depth, then by number.
void ClusterBands::sort(const BoundsPyramid& pyramid) {
    std::vector<Entry> entries(order_.size());
    for (std::uint32_t k = 0; k < entries.size(); ++k) {
        entries[k] = {sortable(pyramid.at(0, k / kLanes).depth[static_cast<int>(k % kLanes)]), k};
    }
    radix_sort(entries);
    for (std::size_t place = 0; place < entries.size(); ++place) {
        const std::uint32_t cluster = entries[place].cluster;
        order_[place] = cluster;
        const BoundsPacket& from = pyramid.at(0, cluster / kLanes);
        from.copy(static_cast<int>(cluster % kLanes), bounds_[place / kLanes],
                  static_cast<int>(place % kLanes));
    }
}

/// Over the part of the picture that the clusters reach into.
void ClusterBands::lay_axes(const BoundsPacket& top, Vec2f centre) {
    BoundsPacket whole = BoundsPacket::none();
    set_union(top, whole, 0);
    const auto lay = [](float from, float to, float half) -> Axis {
        const float first = std::max(from, -half);
        const float size = std::min(to, half) - first;
        return {first, size > 0.0F ? kBands / size : 0.0F, kBands};
    };
    columns_ = lay(whole.left[0], whole.right[0], centre.x);
    rows_ = lay(whole.top[0], whole.bottom[0], centre.y);
}

// ---- What is empty ----

/// Cells of a block's side, or larger ones, where these would be too many.
ClusterBands::Cover::Cover(Vec2f centre) {
    constexpr int kMostCells = 1024;
    const auto lay = [=](float half) -> Axis {
        const float side = std::max(static_cast<float>(kBlockSide), 2.0F * half / kMostCells);
        const int count =
            std::clamp(static_cast<int>(std::ceil(2.0F * half / side)), 1, kMostCells);
        return {-half, 1.0F / side, count};
    };
    columns_ = lay(centre.x);
    rows_ = lay(centre.y);
    words_ = (static_cast<std::size_t>(columns_.count) + 63) / 64;
    cells_.resize(words_ * static_cast<std::size_t>(rows_.count));
}

namespace {

/// Calls `visit(word, bits)` for the bits from `first` to `last`, 64 a word.
template <class Visit>
void for_words(int first, int last, const Visit& visit) {
    for (int word = first / 64; word <= last / 64; ++word) {
        const int from = std::max(first - word * 64, 0);
        const int to = std::min(last - word * 64, 63);
        if (from > to) return;
        visit(static_cast<std::size_t>(word),
              ~std::uint64_t{0} >> (63 - to) & ~std::uint64_t{0} << from);
    }
}

}  // namespace

void ClusterBands::Cover::add(const Window& bounds) {
    const int last = rows_.band(bounds.bottom);
    for_words(columns_.band(bounds.left), columns_.band(bounds.right),
              [&](std::size_t word, std::uint64_t bits) {
                  for (int row = rows_.band(bounds.top); row <= last; ++row) {
                      cells_[static_cast<std::size_t>(row) * words_ + word] |= bits;
                  }
              });
}

std::uint64_t ClusterBands::Cover::met(const Window& first, float step, int count) const {
    const int top = rows_.band(first.top);
    const int bottom = rows_.band(first.bottom - kInside);
    std::uint64_t found = 0;
    // Where each box is a column of its own, columns follow each other as boxes do.
    const int begin = columns_.band(first.left);
    const float last = static_cast<float>(count - 1) * step;
    if (begin == columns_.band(first.right - kInside) &&
        columns_.band(first.left + last) == begin + count - 1 &&
        columns_.band(first.right + last - kInside) == begin + count - 1) {
        const auto word = static_cast<std::size_t>(begin) / 64;
        const auto shift = static_cast<unsigned>(begin) % 64;
        for (int row = top; row <= bottom; ++row) {
            const std::uint64_t* const cells = &cells_[static_cast<std::size_t>(row) * words_];
            found |= cells[word] >> shift;
            if (shift > 0 && word + 1 < words_) found |= cells[word + 1] << (64 - shift);
        }
        return found & ~std::uint64_t{0} >> static_cast<unsigned>(64 - count);
    }
    for (int k = 0; k < count; ++k) {
        const float moved = static_cast<float>(k) * step;
        const int left = columns_.band(first.left + moved);
        const int right = columns_.band(first.right + moved - kInside);
        std::uint64_t met = 0;
        for (int row = top; row <= bottom; ++row) {
            const std::uint64_t* const cells = &cells_[static_cast<std::size_t>(row) * words_];
            for (int column = left; column <= right; ++column) {
                met |= cells[column / 64] >> column % 64;
            }
        }
        found |= (met & 1U) << static_cast<unsigned>(k);
    }
    return found;
}

bool ClusterBands::Cover::any(int left, int right, int top, int bottom) const {
    bool found = false;
    for_words(left, right, [&](std::size_t word, std::uint64_t bits) {
        for (int row = top; row <= bottom && !found; ++row) {
            found = (cells_[static_cast<std::size_t>(row) * words_ + word] & bits) != 0;
        }
    });
    return found;
}

}  // namespace ink
