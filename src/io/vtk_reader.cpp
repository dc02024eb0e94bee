// VTK XML files of points: PolyData (.vtp) and UnstructuredGrid (.vtu).
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <pugixml.hpp>

#include "base/error.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "io/particle_file.h"
#include "io/vtk_arrays.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// The file cut into its XML and the bytes after the "_" of <AppendedData>, which are no XML.
struct VtkText {
    std::string xml;
    std::string_view appended;
    bool appended_base64 = false;
};

VtkText cut_appended(std::string_view text) {
    const std::size_t begin = text.find("<AppendedData");
    const std::size_t data = begin == std::string_view::npos ? begin : text.find('_', begin);
    if (data == std::string_view::npos) return {std::string(text), {}, false};
    const std::string_view tag = text.substr(begin, data - begin);
    VtkText cut{std::string(text.substr(0, begin)) + "</VTKFile>", text.substr(data + 1),
                tag.find("base64") != std::string_view::npos};
    return cut;
}

VtkArray describe(const pugi::xml_node& node) {
    VtkArray array;
    array.name = node.attribute("Name").value();
    array.type = node.attribute("type").value();
    array.format = to_lower(node.attribute("format").as_string("ascii"));
    array.components = node.attribute("NumberOfComponents").as_uint(1);
    if (array.components == 0) array.components = 1;
    array.offset = static_cast<std::size_t>(node.attribute("offset").as_ullong(0));
    array.text = node.child_value();
    return array;
}

/// OVITO writes the scalar part of quaternions last.
void put_scalar_first(Field& field) {
    if (field.components != 4 || to_lower(field.name) != "orientation") return;
    for (auto q = field.values.begin(); q != field.values.end(); q += 4) {
        std::rotate(q, q + 3, q + 4);
    }
}

class VtkReader {
  public:
    VtkReader(const Path& file, const ReadOptions& options) : file_(file), options_(options) {}

    FileContents read() {
        const std::string text = read_text(file_);
        VtkText cut = cut_appended(text);
        pugi::xml_document document;
        const pugi::xml_parse_result result = document.load_buffer_inplace(
            cut.xml.data(), cut.xml.size(), pugi::parse_default | pugi::parse_ws_pcdata_single);
        if (!result) {
            throw InputError(file_, fmt::format("is not an XML file that can be understood ({} at "
                                                "byte {}); was it written to the end?",
                                                result.description(), result.offset));
        }
        const pugi::xml_node root = document.child("VTKFile");
        if (!root) throw InputError(file_, "has no element 'VTKFile'; is it a VTK XML file?");
        read_encoding(root, cut);
        read_pieces(root);
        return finish();
    }

  private:
    void read_encoding(const pugi::xml_node& root, const VtkText& cut) {
        const std::string_view compressor = root.attribute("compressor").value();
        if (!compressor.empty() && compressor != "vtkZLibDataCompressor") {
            throw InputError(file_, fmt::format("is compressed by {}; write it with zlib, or "
                                                "without compression",
                                                excerpt(compressor)));
        }
        encoding_.compressed = !compressor.empty();
        encoding_.big_endian =
            std::string_view(root.attribute("byte_order").value()) == "BigEndian";
        encoding_.wide_headers =
            std::string_view(root.attribute("header_type").value()) == "UInt64";
        encoding_.appended = cut.appended;
        encoding_.appended_base64 = cut.appended_base64;
    }

    void read_pieces(const pugi::xml_node& root) {
        const std::string_view type = root.attribute("type").value();
        if (type != "PolyData" && type != "UnstructuredGrid") {
            throw InputError(
                file_,
                fmt::format("holds {}; PolyData and UnstructuredGrid can be read", excerpt(type)));
        }
        for (const pugi::xml_node piece : root.child(type.data()).children("Piece")) {
            read_piece(piece);
        }
    }

    void read_piece(const pugi::xml_node& piece) {
        const auto count = parse_int(piece.attribute("NumberOfPoints").value());
        // Fewer than a billion, and each takes a byte at least.
        constexpr std::int64_t kMost = std::int64_t{1} << 31;
        if (!count || *count < 0 || *count > kMost) {
            throw InputError(file_,
                             fmt::format("a piece has {} points; repair the file",
                                         excerpt(piece.attribute("NumberOfPoints").value())));
        }
        if (*count == 0) return;
        const auto points = static_cast<std::size_t>(*count);
        const pugi::xml_node places = piece.child("Points").child("DataArray");
        if (!places) throw InputError(file_, "a piece has no array of points; export it again");
        add_positions(read_vtk_array(describe(places), encoding_, 3 * points, file_));
        for (const pugi::xml_node node : piece.child("PointData").children("DataArray")) {
            const VtkArray array = describe(node);
            if (is_vtk_number(array.type)) add_array(array, points);
        }
        points_before_ += points;
    }

    void add_positions(const std::vector<float>& places) {
        std::vector<Vec3f>& positions = particles_.positions;
        if (positions.empty()) {
            const Vec3d first{places[0], places[1], places[2]};
            if (std::isfinite(first.x + first.y + first.z)) particles_.origin = first;
        }
        const Vec3f origin = to_float(particles_.origin);
        positions.reserve(positions.size() + places.size() / 3);
        for (std::size_t i = 0; i < places.size(); i += 3) {
            positions.push_back(Vec3f{places[i], places[i + 1], places[i + 2]} - origin);
        }
    }

    void add_array(const VtkArray& array, std::size_t points) {
        constexpr std::size_t kMostComponents = 1000;
        if (array.components > kMostComponents) {
            throw InputError(file_, fmt::format("array '{}' has {} components; repair the file",
                                                array.name, array.components));
        }
        const bool wanted = options_.facts || is_drawn_field(array.name, options_.data);
        if (!wanted && !options_.summarize) {
            note({array.name, array.components, 0, 0});
            return;
        }
        Field field{array.name, array.components,
                    read_vtk_array(array, encoding_, points * array.components, file_)};
        note(summarize(field));
        if (!wanted) return;
        put_scalar_first(field);
        for (Field& known : particles_.fields) {
            if (known.name != field.name || known.components != field.components) continue;
            known.values.resize(points_before_ * known.components);
            known.values.insert(known.values.end(), field.values.begin(), field.values.end());
            return;
        }
        if (points_before_ == 0) particles_.fields.push_back(std::move(field));
    }

    void note(const FieldSummary& summary) {
        for (FieldSummary& known : contents_.fields) {
            if (known.name != summary.name) continue;
            known.least = std::min(known.least, summary.least);
            known.most = std::max(known.most, summary.most);
            return;
        }
        contents_.fields.push_back(summary);
    }

    FileContents finish() {
        check_frame(options_.frame, 1, file_);
        for (Field& field : particles_.fields) {
            field.values.resize(particles_.count() * field.components);
        }
        const bool is_grid = to_lower(file_.string()).find(".vtu") != std::string::npos;
        return particle_contents(file_, is_grid ? "VTU" : "VTP", std::move(particles_),
                                 std::move(contents_), options_);
    }

    const Path& file_;
    const ReadOptions& options_;
    VtkEncoding encoding_;
    Particles particles_;
    FileContents contents_;
    std::size_t points_before_ = 0;  ///< of the pieces before
};

FileContents read_vtk(const Path& file, const ReadOptions& options) {
    return VtkReader(file, options).read();
}

constexpr std::array<std::string_view, 2> kExtensions{"vtp", "vtu"};

}  // namespace

Reader vtk_reader() { return {"VTK", kExtensions, read_vtk}; }

}  // namespace ink
