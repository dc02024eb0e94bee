#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ink {

/// Entries beyond a row that `mix_columns` may read; those right after it must be copies of its
/// last one.
inline constexpr std::size_t kBeyondRow = 32;

/// Mixes the bytes of the pixels of two rows, one of four at a time; `share` of the second, in 1 /
/// 256.
void mix_rows(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
              std::uint32_t share, std::uint32_t* out);

/// Columns of a row enlarged: each lies between column `first` of `row` and the next one, with
/// `shares` of the latter, in 1 / 256, twice in each number. No column of `first` is less than the
/// one before, nor more than one greater.
void mix_columns(const std::uint32_t* row, std::span<const std::int32_t> first,
                 const std::uint32_t* shares, std::uint32_t* out);

}  // namespace ink
