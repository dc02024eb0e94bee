#include "io/vtk_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

/// Types of cells, as VTK numbers them.
enum CellType : std::uint8_t {
    kVertex = 1,
    kPolyVertex = 2,
    kTriangle = 5,
    kTriangleStrip = 6,
    kPolygon = 7,
    kPixel = 8,
    kQuad = 9
};

/// Lists of points: cell k goes up to `ends[k]`.
struct Cells {
    std::vector<std::size_t> ends;
    std::vector<std::uint32_t> points;

    std::span<const std::uint32_t> operator[](std::size_t k) const {
        const std::size_t begin = k == 0 ? 0 : ends[k - 1];
        return std::span(points).subspan(begin, ends[k] - begin);
    }
};

class CellReader {
  public:
    CellReader(const VtkEncoding& encoding, std::size_t points, const Path& file)
        : encoding_(encoding), points_(points), file_(file) {}

    Cells read(const pugi::xml_node& list, std::size_t count) const {
        Cells cells;
        std::size_t last = 0;
        for (const double end : numbers(list, "offsets", count)) {
            // Points are fewer than 2^31; a cell names each of them a few times at the most.
            constexpr double kMost = 0x1p40;
            if (!(end >= static_cast<double>(last) && end <= kMost)) {
                throw InputError(file_, fmt::format("cell {} ends at entry {:g}, before it begins; "
                                                    "export the file again",
                                                    cells.ends.size(), end));
            }
            last = static_cast<std::size_t>(end);
            cells.ends.push_back(last);
        }
        for (const double point : numbers(list, "connectivity", last)) {
            if (!(point >= 0.0 && point < static_cast<double>(points_))) {
                throw InputError(file_, fmt::format("a cell uses point {:g}, but they go from 0 to "
                                                    "{}; export the file again",
                                                    point, points_ - 1));
            }
            cells.points.push_back(static_cast<std::uint32_t>(point));
        }
        return cells;
    }

    std::vector<double> numbers(const pugi::xml_node& list, std::string_view name,
                                std::size_t count) const {
        for (const pugi::xml_node node : list.children("DataArray")) {
            if (to_lower(node.attribute("Name").value()) != name) continue;
            return read_vtk_doubles(describe_vtk_array(node), encoding_, count, file_);
        }
        throw InputError(file_,
                         fmt::format("the cells have no array '{}'; export the file again", name));
    }

  private:
    const VtkEncoding& encoding_;
    std::size_t points_;
    const Path& file_;
};

class PolygonAdder {
  public:
    PolygonAdder(std::size_t first, PolygonMesh& mesh)
        : first_(static_cast<std::uint32_t>(first)), mesh_(mesh) {}

    void polygon(std::span<const std::uint32_t> points) {
        for (const std::uint32_t point : points) mesh_.corners.push_back(first_ + point);
        mesh_.end_polygon();
    }
    /// Every other triangle of a strip runs the other way.
    void strip(std::span<const std::uint32_t> p) {
        for (std::size_t k = 0; k + 2 < p.size(); ++k) {
            polygon(std::array{p[k], p[k + 1 + k % 2], p[k + 2 - k % 2]});
        }
    }
    /// False where the cell is not of a surface.
    bool cell(int type, std::span<const std::uint32_t> p) {
        switch (type) {
            case kTriangle:
            case kPolygon:
            case kQuad: polygon(p); return true;
            case kTriangleStrip: strip(p); return true;
            case kPixel:
                if (p.size() != 4) return false;
                polygon(std::array{p[0], p[1], p[3], p[2]});
                return true;
            default: return false;
        }
    }

  private:
    std::uint32_t first_;
    PolygonMesh& mesh_;
};

std::size_t count_of(const pugi::xml_node& piece, const char* attribute, const Path& file) {
    const std::string_view text = piece.attribute(attribute).as_string("0");
    const auto count = parse_int(text);
    constexpr std::int64_t kMost = std::int64_t{1} << 31;
    if (!count || *count < 0 || *count > kMost) {
        throw InputError(file,
                         fmt::format("{} is '{}', not a count; repair the file", attribute, text));
    }
    return static_cast<std::size_t>(*count);
}

}  // namespace

VtkArray describe_vtk_array(const pugi::xml_node& node) {
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

std::size_t add_vtk_cells(const pugi::xml_node& piece, const VtkEncoding& encoding,
                          std::size_t points, std::size_t first, const Path& file,
                          PolygonMesh& mesh) {
    const CellReader reader(encoding, points, file);
    PolygonAdder add(first, mesh);
    if (const std::size_t count = count_of(piece, "NumberOfPolys", file); count > 0) {
        const Cells cells = reader.read(piece.child("Polys"), count);
        for (std::size_t k = 0; k < count; ++k) add.polygon(cells[k]);
    }
    if (const std::size_t count = count_of(piece, "NumberOfStrips", file); count > 0) {
        const Cells cells = reader.read(piece.child("Strips"), count);
        for (std::size_t k = 0; k < count; ++k) add.strip(cells[k]);
    }
    std::size_t others = count_of(piece, "NumberOfLines", file);
    if (const std::size_t count = count_of(piece, "NumberOfCells", file); count > 0) {
        const pugi::xml_node list = piece.child("Cells");
        const std::vector<double> types = reader.numbers(list, "types", count);
        const auto is_point = [](double type) {
            return type == double{kVertex} || type == double{kPolyVertex};
        };
        if (std::ranges::all_of(types, is_point)) return others;
        const Cells cells = reader.read(list, count);
        for (std::size_t k = 0; k < count; ++k) {
            const auto type = static_cast<int>(std::clamp(types[k], 0.0, 255.0));
            if (!add.cell(type, cells[k]) && !is_point(types[k])) ++others;
        }
    }
    return others;
}

}  // namespace ink
