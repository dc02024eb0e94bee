#include "io/uda_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <pugixml.hpp>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/molecule_file.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

constexpr std::string_view kParticles = "ParticleVariable<";

/// The file that `owner` names, from its own folder on. The names are a stranger's: nothing outside
/// the archive is opened.
Path named_file(const Path& owner, std::string_view name) {
    const Path path(name);
    if (path.empty() || path.is_absolute() || std::ranges::find(path, "..") != path.end()) {
        throw InputError(owner, fmt::format("names the file {}; expected one in its own folder or "
                                            "below",
                                            excerpt(name)));
    }
    return owner.parent_path() / path;
}

void check_file(const Path& file) {
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) return;
    throw InputError(file, "is missing; copy the archive with all its files");
}

void load_xml(const Path& file, const char* root, pugi::xml_document& document) {
    check_file(file);
    const std::string text = read_text(file);
    const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
    if (!result) {
        throw InputError(file, fmt::format("is not an XML file that can be understood ({} at byte "
                                           "{}); was it written to the end?",
                                           result.description(), result.offset));
    }
    if (!document.child(root)) {
        throw InputError(file,
                         fmt::format("has no element '{}'; is it of a Uintah archive?", root));
    }
}

std::string_view text_of(const pugi::xml_node& node, const char* name) {
    return trim(node.child(name).text().get());
}

/// Those of materials and patches may be -1.
std::int64_t number_of(const pugi::xml_node& node, const char* name, std::int64_t least,
                       const Path& file) {
    const auto number = parse_int(text_of(node, name));
    if (number && *number >= least) return *number;
    throw InputError(
        file, fmt::format("variable {} has the {} {}; repair the file",
                          excerpt(text_of(node, "variable")), name, excerpt(text_of(node, name))));
}

class StepReader {
  public:
    StepReader(const Path& folder, int frame) : index_(folder / "index.xml"), frame_(frame) {}

    UdaStep read() {
        pugi::xml_document index;
        load_xml(index_, "Uintah_DataArchive", index);
        const pugi::xml_node root = index.child("Uintah_DataArchive");
        check_variables(root.child("variables"));
        const auto steps = root.child("timesteps").children("timestep");
        step_.frames = static_cast<int>(std::distance(steps.begin(), steps.end()));
        if (step_.frames == 0) {
            throw InputError(index_, "lists no time steps; was the archive written to the end?");
        }
        check_frame(frame_, step_.frames, index_.parent_path());
        const pugi::xml_node step = *std::next(steps.begin(), frame_);
        read_step(named_file(index_, step.attribute("href").value()), root.child("Meta"));
        return std::move(step_);
    }

  private:
    void check_variables(const pugi::xml_node& variables) const {
        for (const pugi::xml_node variable : variables.children("variable")) {
            const std::string_view type = variable.attribute("type").value();
            if (type.starts_with(kParticles)) return;
        }
        throw InputError(index_,
                         "lists no variables of particles; an archive that saves 'p.x' is "
                         "needed");
    }

    void read_step(const Path& file, const pugi::xml_node& general_meta) {
        pugi::xml_document document;
        load_xml(file, "Uintah_timestep", document);
        const pugi::xml_node root = document.child("Uintah_timestep");
        const pugi::xml_node meta = root.child("Meta");
        read_encoding(meta.child("endianness") ? meta : general_meta, file);
        for (const pugi::xml_node data : root.child("Data").children("Datafile")) {
            read_list(named_file(file, data.attribute("href").value()));
        }
    }

    void read_encoding(const pugi::xml_node& meta, const Path& file) {
        const std::string_view order = text_of(meta, "endianness");
        if (order != "little_endian" && order != "big_endian") {
            throw InputError(file, fmt::format("has the endianness {}; expected little_endian or "
                                               "big_endian",
                                               excerpt(order)));
        }
        const std::string_view bits = text_of(meta, "nBits");
        if (bits != "64" && bits != "32") {
            throw InputError(file, fmt::format("has sizes of {} bits (nBits); expected 64 or 32",
                                               excerpt(bits)));
        }
        step_.big_endian = order == "big_endian";
        step_.header_bytes = bits == "64" ? 8 : 4;
    }

    /// The list of what is in one data file.
    void read_list(const Path& file) {
        pugi::xml_document document;
        load_xml(file, "Uintah_Output", document);
        for (const pugi::xml_node node : document.child("Uintah_Output").children("Variable")) {
            const std::string_view type = node.attribute("type").value();
            if (type.starts_with(kParticles) && type.ends_with('>')) add_block(node, file);
        }
    }

    void add_block(const pugi::xml_node& node, const Path& file) {
        const std::string_view type = node.attribute("type").value();
        UdaBlock block{.variable = std::string(text_of(node, "variable")),
                       .type = std::string(
                           type.substr(kParticles.size(), type.size() - kParticles.size() - 1)),
                       .material = number_of(node, "index", -1, file),
                       .patch = number_of(node, "patch", -1, file),
                       .file = {}};
        block.particles = static_cast<std::size_t>(number_of(node, "numParticles", 0, file));
        if (block.particles == 0) return;
        block.begin = static_cast<std::size_t>(number_of(node, "start", 0, file));
        block.end = static_cast<std::size_t>(number_of(node, "end", 0, file));
        const std::string_view compression = text_of(node, "compression");
        block.compressed = compression == "gzip";
        if (!block.compressed && !compression.empty() && compression != "none") {
            throw InputError(file, fmt::format("variable '{}' is compressed by {}; save it with "
                                               "gzip, or without compression",
                                               block.variable, excerpt(compression)));
        }
        block.file = named_file(file, text_of(node, "filename"));
        check_range(block);
        step_.blocks.push_back(std::move(block));
    }

    static void check_range(const UdaBlock& block) {
        check_file(block.file);
        std::error_code error;
        const std::uintmax_t size = std::filesystem::file_size(block.file, error);
        if (!error && block.begin <= block.end && block.end <= size) return;
        throw InputError(
            block.file,
            fmt::format("has {} bytes, but '{}' of patch {} goes from {} to {}; was it "
                        "written to the end?",
                        error ? 0 : size, block.variable, block.patch, block.begin, block.end));
    }

    const Path index_;
    const int frame_;
    UdaStep step_;
};

}  // namespace

UdaStep read_uda_step(const Path& folder, int frame) { return StepReader(folder, frame).read(); }

}  // namespace ink
