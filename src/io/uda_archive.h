#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace ink {

/// Where an archive of Uintah's keeps one variable of the particles of one material in one patch.
struct UdaBlock {
    std::string variable;  ///< "p.velocity"
    std::string type;      ///< "Vector"
    std::int64_t material = 0;
    std::int64_t patch = 0;
    std::size_t particles = 0;
    std::filesystem::path file;
    std::size_t begin = 0;  ///< in the file; inside of it, as is `end`
    std::size_t end = 0;
    bool compressed = false;
};

/// One time step, as the XML files of the archive tell it.
struct UdaStep {
    int frames = 1;  ///< of the archive
    bool big_endian = false;
    std::size_t header_bytes = 8;  ///< of the size that a compressed block begins with
    std::vector<UdaBlock> blocks;  ///< of particles; there may be none
};

/// Throws InputError where a file is missing, damaged, or not below the archive's folder.
UdaStep read_uda_step(const std::filesystem::path& folder, int frame);

}  // namespace ink
