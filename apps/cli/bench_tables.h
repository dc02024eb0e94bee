#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "inktrace/inktrace.h"

namespace inktrace::cli {

/// A cell of the paper's tables; columns are no lines, N = 1, 2, 3.
struct BenchCell {
    double frames_per_second = 0.0;
    std::uint64_t rays = 0;
};

struct BenchRow {
    std::string name;
    std::array<std::optional<BenchCell>, 4> cells;
};

inline constexpr std::array<const char*, 4> kBenchColumns{"No lines", "N = 1", "N = 2", "N = 3"};
inline constexpr std::array<const char*, 3> kBenchRows{"No anti-aliasing", "Stencil AA",
                                                       "True multisampling"};

/// Frames a second in the paper: Table 1 (one thread, 2.8 GHz Core 2 Duo) and Table 2 (eight
/// threads, two 3 GHz quad-core Xeons); 0: not applicable.
using PaperTable = std::array<std::array<double, 4>, 3>;
inline constexpr PaperTable kTable1{
    {{24.3, 3.1, 1.9, 1.0}, {0, 2.1, 0.9, 0.4}, {0, 0.4, 0.1, 0.02}}};
inline constexpr PaperTable kTable2{
    {{147.0, 30.1, 14.3, 7.8}, {0, 16.7, 6.8, 3.5}, {0, 3.5, 0.6, 0.2}}};

/// Draws the scene in every way of the tables. `base` has size and view.
std::vector<BenchRow> measure_table(const Renderer& renderer, const Settings& base, int threads);

/// Three digits that count.
std::string short_number(double value);

}  // namespace inktrace::cli
