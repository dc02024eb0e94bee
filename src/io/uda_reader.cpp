// Archives of Uintah's (.uda): a folder of XML files, which say where the variables of each patch
// are, and of their bytes. https://uintah.utah.edu

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/error.h"
#include "io/byte_order.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/inflate.h"
#include "io/particle_file.h"
#include "io/uda_archive.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

constexpr std::string_view kPositions = "p.x";

template <class T>
double load_number(const char* bytes, bool swap) {
    return static_cast<double>(load<T>(bytes, swap));
}

struct NumberType {
    std::string_view name;
    std::size_t components;
    std::size_t bytes;  ///< of a component
    double (*load)(const char* bytes, bool swap);

    std::size_t size() const { return components * bytes; }
};

constexpr std::array<NumberType, 7> kTypes{{{"double", 1, 8, load_number<double>},
                                            {"float", 1, 4, load_number<float>},
                                            {"int", 1, 4, load_number<std::int32_t>},
                                            {"long64", 1, 8, load_number<std::int64_t>},
                                            {"Point", 3, 8, load_number<double>},
                                            {"Vector", 3, 8, load_number<double>},
                                            {"Matrix3", 9, 8, load_number<double>}}};

const NumberType* find_type(std::string_view name) {
    const auto found = std::ranges::find(kTypes, name, &NumberType::name);
    return found == kTypes.end() ? nullptr : &*found;
}

[[noreturn]] void refuse(const UdaBlock& block, std::string_view problem) {
    throw InputError(block.file, fmt::format("'{}' of material {} in patch {} {}", block.variable,
                                             block.material, block.patch, problem));
}

// ---- The bytes of a block ----

std::string stored_bytes(const UdaBlock& block, std::size_t size) {
    check_memory(block.file, size);
    std::string bytes(size, '\0');
    std::ifstream in(block.file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(block.begin));
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!in) refuse(block, "cannot be read; check the disk and the permissions");
    return bytes;
}

/// A header says how many bytes the zlib stream behind it unpacks to.
std::string unpacked(const UdaBlock& block, const UdaStep& step, std::size_t size, bool swap) {
    const std::string stored = stored_bytes(block, block.end - block.begin);
    const std::size_t header = step.header_bytes;
    const std::size_t announced = header == 8 ? load<std::uint64_t>(stored.data(), swap)
                                              : load<std::uint32_t>(stored.data(), swap);
    if (announced != size) {
        refuse(block, fmt::format("unpacks to {} bytes, but {} particles take {}; is the list of "
                                  "another run?",
                                  announced, block.particles, size));
    }
    check_memory(block.file, size);
    std::string bytes(size, '\0');
    if (!inflate_exactly(std::string_view(stored).substr(header), bytes)) {
        refuse(block, "has damaged compressed data; copy it again");
    }
    return bytes;
}

/// Refuses a number of particles for which the bytes in the file cannot be enough.
std::size_t checked_size(const UdaBlock& block, const UdaStep& step, std::size_t particle) {
    const std::size_t stored = block.end - block.begin;
    const std::size_t most = block.compressed ? stored * kMostInflation : stored;
    const bool has_header = !block.compressed || stored >= step.header_bytes;
    if (!has_header || block.particles > most / particle) {
        refuse(block, fmt::format("has {} bytes, too few for {} particles; was it written to the "
                                  "end?",
                                  stored, block.particles));
    }
    return block.particles * particle;
}

std::string block_bytes(const UdaBlock& block, const UdaStep& step, const NumberType& type,
                        bool swap) {
    const std::size_t size = checked_size(block, step, type.size());
    return block.compressed ? unpacked(block, step, size, swap) : stored_bytes(block, size);
}

// ---- The particles ----

class UdaReader {
  public:
    UdaReader(const Path& folder, const ReadOptions& options)
        : folder_(folder),
          options_(options),
          step_(read_uda_step(folder, options.frame)),
          swap_(is_foreign(step_.big_endian ? std::endian::big : std::endian::little)) {}

    FileContents read() {
        collect_variables();
        place_particles();
        for (const auto& [name, blocks] : variables_) {
            if (name != kPositions) add_variable(name, blocks);
        }
        add_materials();
        contents_.frames = step_.frames;
        return particle_contents(folder_, "Uintah archive", std::move(particles_),
                                 std::move(contents_), options_);
    }

  private:
    using Blocks = std::vector<const UdaBlock*>;
    using Place = std::pair<std::int64_t, std::int64_t>;  ///< material and patch
    struct Group {
        std::size_t begin, count;
    };

    static Place place_of(const UdaBlock& block) { return {block.material, block.patch}; }

    void collect_variables() {
        std::set<std::pair<std::string_view, Place>> known;
        for (const UdaBlock& block : step_.blocks) {
            Blocks& blocks = variables_[block.variable];
            blocks.push_back(&block);
            if (!known.emplace(block.variable, place_of(block)).second) {
                refuse(block, "is listed twice; repair the list");
            }
            if (block.type != blocks.front()->type) {
                refuse(block, fmt::format("is of type {}, but of {} elsewhere; repair the list",
                                          excerpt(block.type), excerpt(blocks.front()->type)));
            }
        }
    }

    void place_particles() {
        const auto found = variables_.find(kPositions);
        if (found == variables_.end()) {
            throw InputError(folder_, fmt::format("holds no particles in frame {}: no positions "
                                                  "'p.x' are listed; save them",
                                                  options_.frame));
        }
        const NumberType* const type = find_type(found->second.front()->type);
        if (type == nullptr || type->components != 3) {
            refuse(*found->second.front(), "is not of type Point; save the archive again");
        }
        std::size_t count = 0;
        for (const UdaBlock* const block : found->second) {
            checked_size(*block, step_, type->size());
            groups_[place_of(*block)] = {count, block->particles};
            count += block->particles;
        }
        check_memory(folder_, count * sizeof(Vec3f));
        particles_.positions.reserve(count);
        for (const UdaBlock* const block : found->second) add_positions(*block, *type);
    }

    void add_positions(const UdaBlock& block, const NumberType& type) {
        const std::string bytes = block_bytes(block, step_, type, swap_);
        for (std::size_t i = 0; i < block.particles; ++i) {
            const char* const at = bytes.data() + i * type.size();
            const Vec3d p{type.load(at, swap_), type.load(at + type.bytes, swap_),
                          type.load(at + 2 * type.bytes, swap_)};
            if (particles_.positions.empty() && std::isfinite(p.x + p.y + p.z)) {
                particles_.origin = p;
            }
            particles_.positions.push_back(to_float(p - particles_.origin));
        }
    }

    void add_variable(std::string_view name, const Blocks& blocks) {
        const NumberType* const type = find_type(blocks.front()->type);
        if (type == nullptr) {
            contents_.warnings.push_back(fmt::format("Variable '{}' of type {} was left out.", name,
                                                     excerpt(blocks.front()->type)));
            return;
        }
        add_field(name, type->components, [&](Field& field) {
            for (const UdaBlock* const block : blocks) fill(*block, *type, field);
        });
    }

    void fill(const UdaBlock& block, const NumberType& type, Field& field) const {
        const auto group = groups_.find(place_of(block));
        const std::size_t count = group == groups_.end() ? 0 : group->second.count;
        if (count != block.particles) {
            refuse(block, fmt::format("has {} particles, but 'p.x' has {}; repair the list",
                                      block.particles, count));
        }
        const std::string bytes = block_bytes(block, step_, type, swap_);
        float* const values = field.values.data() + group->second.begin * type.components;
        for (std::size_t i = 0; i < count * type.components; ++i) {
            values[i] = static_cast<float>(type.load(bytes.data() + i * type.bytes, swap_));
        }
    }

    void add_materials() {
        // Sorted by material first.
        if (groups_.begin()->first.first == groups_.rbegin()->first.first) return;
        add_field("material", 1, [&](Field& field) {
            for (const auto& [place, group] : groups_) {
                std::fill_n(field.values.data() + group.begin, group.count,
                            static_cast<float>(place.first));
            }
        });
    }

    /// A field that is asked for; `fill` gives the values of the particles that have one.
    template <class Fill>
    void add_field(std::string_view name, std::size_t components, const Fill& fill) {
        const bool wanted = options_.facts || is_drawn_field(name, options_.data);
        if (!wanted && !options_.summarize) {
            contents_.fields.push_back({std::string(name), components, 0, 0});
            return;
        }
        const std::size_t count = particles_.count() * components;
        check_memory(folder_, count * sizeof(float));
        Field field{std::string(name), components,
                    std::vector<float>(count, std::numeric_limits<float>::quiet_NaN())};
        fill(field);
        contents_.fields.push_back(summarize(field));
        if (wanted) particles_.fields.push_back(std::move(field));
    }

    const Path& folder_;
    const ReadOptions& options_;
    const UdaStep step_;
    const bool swap_;
    std::map<std::string, Blocks, std::less<>> variables_;
    std::map<Place, Group> groups_;  ///< where the particles of a block are among all
    Particles particles_;
    FileContents contents_;
};

FileContents read_uda(const Path& folder, const ReadOptions& options) {
    return UdaReader(folder, options).read();
}

constexpr std::array<std::string_view, 1> kExtensions{"uda"};

}  // namespace

Reader uda_reader() { return {"Uintah archive", kExtensions, read_uda, true}; }

}  // namespace ink
