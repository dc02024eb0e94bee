#pragma once

#include <string>
#include <vector>

namespace ink::bench {

/// What reading one file took, with the scene that it makes.
struct ReaderRow {
    std::string format;
    double megabytes = 0.0;
    double megabytes_per_second = 0.0;
};

/// Writes a file of about `megabytes` in each of the formats that simulations and scanners write
/// large ones in (or only in those named), into a temporary folder, and reads it; the best of
/// three.
std::vector<ReaderRow> measure_readers(double megabytes, const std::vector<std::string>& only);

}  // namespace ink::bench
