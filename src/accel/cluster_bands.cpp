#include "accel/cluster_bands.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/multiversion.h"
#include "base/parallel.h"

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
    lay_axes(pyramid.at(pyramid.top(), 0), centre);
    constexpr std::size_t kGrain = 32;
    parallel_ranges(bounds_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) pyramid.at(0, k);  // projects it
    });
    // Either takes about as long as the other.
    parallel_ranges(2, 1, [&](std::size_t begin, std::size_t end) {
        if (begin == 0) sort(pyramid);
        if (end == 2) cover(pyramid);
    });
}

/// How many clusters a packet holds.
int ClusterBands::used(std::size_t packet) const {
    return static_cast<int>(std::min<std::size_t>(kLanes, order_.size() - packet * kLanes));
}

namespace {

INKTRACE_MULTIVERSION
void find_spans(const BandAxis& columns, const BandAxis& rows, const BoundsPacket& bounds,
                BandSpans& spans) {
    for (int i = 0; i < kLanes; ++i) spans.left[i] = columns.band(bounds.left[i]);
    for (int i = 0; i < kLanes; ++i) spans.right[i] = columns.band(bounds.right[i]);
    for (int i = 0; i < kLanes; ++i) spans.top[i] = rows.band(bounds.top[i]);
    for (int i = 0; i < kLanes; ++i) spans.bottom[i] = rows.band(bounds.bottom[i]);
}

/// The bits from `first` to `last`.
std::uint64_t bits_between(int first, int last) {
    return ~std::uint64_t{0} >> static_cast<unsigned>(63 - last) &
           ~std::uint64_t{0} << static_cast<unsigned>(first);
}

/// Calls `visit(word, bits)` for the bits from `first` to `last`, 64 a word.
template <class Visit>
void for_words(int first, int last, const Visit& visit) {
    for (int word = first / 64; word <= last / 64; ++word) {
        visit(static_cast<std::size_t>(word),
              bits_between(std::max(first - word * 64, 0), std::min(last - word * 64, 63)));
    }
}

/// Makes bit k of word n bit n of word k (Warren, Hacker's Delight, 7-3): the blocks off the
/// diagonal change places, ever smaller ones.
INKTRACE_MULTIVERSION
void transpose(std::array<std::uint64_t, 64>& words) {
    std::uint64_t low = 0x00000000FFFFFFFFU;
    for (unsigned side = 32; side != 0; side /= 2, low ^= low << side) {
        for (unsigned first = 0; first < 64; first += 2 * side) {
            for (unsigned k = first; k < first + side; ++k) {
                const std::uint64_t change = (words[k] >> side ^ words[k + side]) & low;
                words[k + side] ^= change;
                words[k] ^= change << side;
            }
        }
    }
}

}  // namespace

/// Of 64 places at a time: first a bit for each band of a place, then a bit for each place of a
/// band.
void ClusterBands::mark_bands(std::size_t word) {
    static_assert(kBands == 64);
    std::array<std::uint64_t, kBands> columns{};
    std::array<std::uint64_t, kBands> rows{};
    BandSpans spans;
    std::size_t place = 0;
    for (std::size_t k = word * 64 / kLanes; place < 64 && k < bounds_.size(); ++k) {
        find_spans(columns_, rows_, bounds_[k], spans);
        for (int i = 0; i < used(k); ++i, ++place) {
            columns[place] = bits_between(spans.left[i], spans.right[i]);
            rows[place] = bits_between(spans.top[i], spans.bottom[i]);
        }
    }
    transpose(columns);
    transpose(rows);
    for (std::size_t band = 0; band < kBands; ++band) {
        of_column_[band * words_ + word] = columns[band];
        of_row_[band * words_ + word] = rows[band];
    }
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
    const auto among = [&](const BandAxis& axis, float from, float to, const auto& bands,
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

/// By depth, then by number; and tells which bands they reach into.
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
    for (std::size_t word = 0; word < words_; ++word) mark_bands(word);
}

/// In any order.
void ClusterBands::cover(const BoundsPyramid& pyramid) {
    for (std::size_t k = 0; k < bounds_.size(); ++k) cover_.add(pyramid.at(0, k), used(k));
}

/// Over the part of the picture that the clusters reach into.
void ClusterBands::lay_axes(const BoundsPacket& top, Vec2f centre) {
    BoundsPacket whole = BoundsPacket::none();
    set_union(top, whole, 0);
    const auto lay = [](float from, float to, float half) -> BandAxis {
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
    const auto lay = [=](float half) -> BandAxis {
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

void ClusterBands::Cover::add(const BoundsPacket& bounds, int count) {
    BandSpans spans;
    find_spans(columns_, rows_, bounds, spans);
    for (int i = 0; i < count; ++i) {
        for_words(spans.left[i], spans.right[i], [&](std::size_t word, std::uint64_t bits) {
            std::uint64_t* cells = &cells_[static_cast<std::size_t>(spans.top[i]) * words_ + word];
            for (int row = spans.top[i]; row <= spans.bottom[i]; ++row, cells += words_) {
                *cells |= bits;
            }
        });
    }
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
