// VTK XML files of points and surfaces: PolyData (.vtp) and UnstructuredGrid (.vtu).
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <pugixml.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/molecule_file.h"
#include "io/particle_file.h"
#include "io/polygon_mesh.h"
#include "io/vtk_arrays.h"
#include "io/vtk_cells.h"
#include "scene/color_scale.h"
#include "scene/field.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

constexpr std::size_t kGrain = 1 << 16;

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
        read_arrays();
        return finish();
    }

  private:
    void read_arrays() {
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
    }

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
        const VtkArray where = describe_vtk_array(places);
        if (where.type == "Float32" && where.format != "ascii") {
            append_vtk_points(where, encoding_, points, file_, particles_.positions);
            shift_positions();
            surface_.single_precision = true;
        } else {
            add_positions(read_vtk_doubles(where, encoding_, 3 * points, file_));
        }
        for (const pugi::xml_node node : piece.child("PointData").children("DataArray")) {
            const VtkArray array = describe_vtk_array(node);
            if (is_vtk_number(array.type)) add_array(array, points);
        }
        other_cells_ += add_vtk_cells(piece, encoding_, points, points_before_, file_, surface_);
        points_before_ += points;
    }

    void choose_origin(Vec3d first) {
        if (points_before_ == 0 && std::isfinite(first.x + first.y + first.z)) {
            particles_.origin = first;
        }
    }

    /// The positions of this piece, which are the file's, from the origin.
    void shift_positions() {
        std::vector<Vec3f>& positions = particles_.positions;
        choose_origin(to_double(positions[points_before_]));
        parallel_ranges(positions.size() - points_before_, kGrain,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i) {
                                Vec3f& p = positions[points_before_ + i];
                                p = to_float(to_double(p) - particles_.origin);
                            }
                        });
    }

    void add_positions(const std::vector<double>& places) {
        std::vector<Vec3f>& positions = particles_.positions;
        choose_origin({places[0], places[1], places[2]});
        positions.resize(points_before_ + places.size() / 3);
        parallel_ranges(places.size() / 3, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3d place{places[3 * i], places[3 * i + 1], places[3 * i + 2]};
                positions[points_before_ + i] = to_float(place - particles_.origin);
            }
        });
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
        const char* const format = is_grid ? "VTU" : "VTP";
        if (other_cells_ > 0) {
            contents_.warnings.push_back(fmt::format(
                "{} cells that are neither points nor polygons were left out{}.", other_cells_,
                surface_.polygon_ends.empty() ? "; points are drawn" : ""));
        }
        if (!surface_.polygon_ends.empty()) return finish_surface(format);
        return particle_contents(file_, format, std::move(particles_), std::move(contents_),
                                 options_);
    }

    FileContents finish_surface(const char* format) {
        surface_.format = format;
        constexpr auto kLargest = static_cast<float>(kLargestCoordinate);
        for (std::size_t i = 0; i < particles_.count(); ++i) {
            const Vec3f p = particles_.positions[i];
            if (std::abs(p.x) + std::abs(p.y) + std::abs(p.z) <= kLargest) continue;
            throw InputError(file_, fmt::format("point {} lies at no usable place; repair it", i));
        }
        std::optional<ColorScale> scale = color_surface();
        surface_.origin = particles_.origin;
        surface_.positions = std::move(particles_.positions);
        surface_.warnings = std::move(contents_.warnings);
        FileContents mesh = mesh_contents(file_, std::move(surface_));
        mesh.fields = std::move(contents_.fields);
        mesh.objects.front().color_scale = std::move(scale);
        return mesh;
    }

    /// By a field of the points, or a colour.
    std::optional<ColorScale> color_surface() {
        const std::string& word = options_.data.color_by;
        if (word.empty() || word == "none") return std::nullopt;
        if (const auto color = parse_color(word)) {
            surface_.color = *color;
            return std::nullopt;
        }
        const std::vector<float> values = scalar_values(particles_.fields, word);
        if (values.size() != particles_.count()) {
            throw Error(
                fmt::format("--color-by: the points have no '{}'; expected a colour, none or "
                            "a field that 'inktrace info' lists",
                            word));
        }
        Coloring coloring = color_field(word, values, options_.data);
        surface_.colors = std::move(coloring.colors);
        return std::move(coloring.scale);
    }

    const Path& file_;
    const ReadOptions& options_;
    VtkEncoding encoding_;
    Particles particles_;
    PolygonMesh surface_;  ///< the polygons over the points; none: particles are drawn
    std::size_t other_cells_ = 0;
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
