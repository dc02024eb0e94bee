// Wavefront OBJ and its material libraries. Read here rather than by Assimp, which takes three
// times as long, keeps 32 bits of coordinates far from the origin and names no line.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "io/file_text.h"
#include "io/formats.h"
#include "io/obj_materials.h"
#include "io/polygon_mesh.h"
#include "scene/material.h"

namespace ink {

namespace {

using Path = std::filesystem::path;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// What a corner of a face refers to: "f 1/2/3" uses vertex 1, texture coordinate 2, normal 3.
struct Reference {
    std::string_view name;
    std::int64_t count = 0;        ///< defined so far
    std::int64_t highest = 0;      ///< used so far, with
    std::size_t highest_line = 0;  ///< the line that does
};

/// As of take_word.
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

constexpr bool is_number_character(char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E';
}

/// Which faces are together: those of a group in one material.
struct Part {
    std::string name;
    std::string material;  ///< of `usemtl`; empty: none
    bool used = false;
};

class ObjReader {
  public:
    ObjReader(const Path& file, std::string_view text) : file_(file), lines_(text) {
        mesh_.format = "OBJ";
    }

    PolygonMesh read() {
        while (lines_.next()) read_line(joined_line());
        for (const Reference& reference : references_) check_highest(reference);
        if (references_[0].count == 0) {
            throw InputError(file_, "holds no vertices; is it a Wavefront OBJ file?");
        }
        if (mesh_.polygon_ends.empty()) {
            throw InputError(file_, "holds points, no faces; export the surface with its faces");
        }
        if (mesh_.colors.size() != mesh_.positions.size()) release(mesh_.colors);
        if (mesh_.colors.empty()) take_colors_of_materials();
        if (all_have_normals_ && !normals_.empty()) unshare_vertices();
        name_parts();
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void refuse(std::string_view problem) const {
        throw InputError(file_, lines_.number(), problem);
    }

    /// A backslash at its end joins a line to the next one.
    std::string_view joined_line() {
        std::string_view line = lines_.line();
        if (!line.ends_with('\\')) return line;
        joined_.clear();
        do {
            joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
            if (!lines_.next()) return joined_;
            line = lines_.line();
        } while (line.ends_with('\\'));
        return joined_.append(line);
    }

    void read_line(std::string_view line) {
        while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
        if (line.size() < 2) return;
        if (line[0] == 'v') {
            read_vertex_line(line.substr(1));
        } else if (line[0] == 'f' && is_blank(line[1])) {
            read_face(line.substr(2), kNone);
        } else if (line[0] == 'l' && is_blank(line[1])) {
            read_face(line.substr(2), 2);
        } else if (line[0] == 'p' && is_blank(line[1])) {
            read_face(line.substr(2), 1);
        } else {
            const std::string_view keyword = take_word(line);
            if (keyword == "g" || keyword == "o") begin_group(trim(line));
            if (keyword == "usemtl") use_material(trim(line));
            if (keyword == "mtllib") materials_.open(file_, trim(line));
        }
    }

    void read_vertex_line(std::string_view rest) {
        if (is_blank(rest.front())) {
            read_position(rest);
            ++references_[0].count;
        } else if (rest.front() == 't') {
            ++references_[1].count;
        } else if (rest.front() == 'n') {
            read_normal(rest.substr(1));
            ++references_[2].count;
        }
    }

    void read_position(std::string_view rest) {
        std::array<double, 6> numbers{};
        std::string_view words = rest;
        std::size_t count = 0;
        for (std::string_view word = take_word(words); !word.empty(); word = take_word(words)) {
            if (word.front() == '#') break;
            const double value = coordinate(word, rest);
            if (count < numbers.size()) numbers[count] = value;
            ++count;
        }
        if (count != 3 && count != 4 && count != 6) {
            refuse(fmt::format("vertex with {} numbers; expected x y z, x y z w or x y z r g b",
                               count));
        }
        Vec3d position{numbers[0], numbers[1], numbers[2]};
        if (count == 4) position = position / numbers[3];
        if (!mesh_.add_position(position)) {
            refuse(fmt::format("vertex with a coordinate beyond 1e15 ({}); correct it",
                               excerpt(trim(rest))));
        }
        if (count == 6) {
            mesh_.colors.push_back(
                to_rgb8({static_cast<float>(numbers[3]), static_cast<float>(numbers[4]),
                         static_cast<float>(numbers[5])}));
        }
    }

    /// Of odd spellings (3.1+e2) what makes sense at the beginning counts.
    double coordinate(std::string_view word, std::string_view vertex) const {
        if (!std::ranges::all_of(word, is_number_character)) refuse_number(vertex);
        if (word.front() == '+') word.remove_prefix(1);
        double value = 0.0;
        const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
        if (result.ec == std::errc::invalid_argument) refuse_number(vertex);
        if (result.ec != std::errc::result_out_of_range) return value;
        // Too small for a double is no harm; too large is.
        const bool small =
            word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
        return small ? 0.0 : std::numeric_limits<double>::infinity();
    }
    [[noreturn]] void refuse_number(std::string_view vertex) const {
        refuse(fmt::format("vertex with a coordinate that is not a number ({}); correct it",
                           excerpt(trim(vertex))));
    }

    /// One that makes no sense is 0, and then all are computed anew.
    void read_normal(std::string_view rest) {
        Vec3f normal;
        for (float* const axis : {&normal.x, &normal.y, &normal.z}) {
            *axis = static_cast<float>(parse_double(take_word(rest)).value_or(0.0));
        }
        normals_.push_back(normal);
    }

    // ---- Faces ----

    /// Of points and lines, `most` corners are kept, too few for a face.
    void read_face(std::string_view rest, std::uint32_t most) {
        const bool is_face = most == kNone;
        std::uint32_t corners = 0;
        for (;;) {
            while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
            if (rest.empty() || rest.front() == '#') break;
            read_corner(rest, corners++ < most, is_face);
        }
        mesh_.end_polygon();
        if (parts_.empty()) parts_.emplace_back();
        parts_.back().used = true;
        mesh_.parts.push_back(static_cast<std::uint32_t>(parts_.size() - 1));
    }

    /// Takes "7", "7/1", "7//3" or "7/1/3" off the front.
    void read_corner(std::string_view& rest, bool keep, bool is_face) {
        const std::string_view corner = rest;
        std::array<std::uint32_t, 3> indices{kNone, kNone, kNone};
        for (std::size_t k = 0; k < references_.size(); ++k) {
            const bool skipped =
                k > 0 && (rest.empty() || rest.front() == '/' || is_blank(rest.front()));
            if (!skipped) indices[k] = read_index(rest, references_[k], corner);
            if (rest.empty() || is_blank(rest.front())) break;
            if (k == 2 || rest.front() != '/') refuse_corner(corner);
            rest.remove_prefix(1);
        }
        if (!keep) return;
        mesh_.corners.push_back(indices[0]);
        const bool has_normal = indices[2] != kNone;
        if (is_face && !has_normal) all_have_normals_ = false;
        if (all_have_normals_) corner_normals_.push_back(has_normal ? indices[2] : 0);
    }

    /// Counted from 0.
    std::uint32_t read_index(std::string_view& rest, Reference& reference,
                             std::string_view corner) {
        std::int64_t index = 0;
        const auto result = std::from_chars(rest.data(), rest.data() + rest.size(), index);
        if (result.ec != std::errc{}) refuse_corner(corner);
        rest.remove_prefix(static_cast<std::size_t>(result.ptr - rest.data()));
        if (index == 0) refuse("face with index 0; OBJ counts from 1: export the file again");
        if (index < -reference.count) {
            refuse(fmt::format("face uses {} {}, but only {} come before it; export the file again",
                               reference.name, index, reference.count));
        }
        if (index < 0) return static_cast<std::uint32_t>(reference.count + index);
        // Indices may point forward, so the highest can be judged only at the end.
        if (index > reference.highest) {
            reference.highest = index;
            reference.highest_line = lines_.number();
        }
        return static_cast<std::uint32_t>(index - 1);
    }

    [[noreturn]] void refuse_corner(std::string_view corner) const {
        const std::string_view word = take_word(corner);
        refuse(fmt::format("face with the corner {}; expected numbers such as 7, 7/1 or 7/1/3",
                           excerpt(word)));
    }

    void check_highest(const Reference& reference) const {
        if (reference.highest <= reference.count) return;
        throw InputError(
            file_, reference.highest_line,
            fmt::format("face uses {} {}, but there are only {}; export the file again",
                        reference.name, reference.highest, reference.count));
    }

    /// Normals belong to corners, but those of a PolygonMesh to vertices: each corner gets a vertex
    /// of its own, until equal positions are merged.
    void unshare_vertices() {
        std::vector<Vec3f> positions;
        std::vector<Rgb8> colors;
        reserve_large(positions, mesh_.corners.size());
        reserve_large(mesh_.normals, mesh_.corners.size());
        for (std::size_t i = 0; i < mesh_.corners.size(); ++i) {
            const std::uint32_t vertex = mesh_.corners[i];
            mesh_.corners[i] = static_cast<std::uint32_t>(i);
            positions.push_back(mesh_.positions[vertex]);
            mesh_.normals.push_back(normals_[corner_normals_[i]]);
            if (!mesh_.colors.empty()) colors.push_back(mesh_.colors[vertex]);
        }
        mesh_.positions = std::move(positions);
        mesh_.colors = std::move(colors);
    }

    // ---- Groups and materials ----

    void begin_group(std::string_view name) { begin_part(std::string(name), material_); }

    /// Within a group, the faces of another material are a part of its name.
    void use_material(std::string_view name) {
        material_ = name;
        if (parts_.empty() || !parts_.back().used) {
            if (parts_.empty()) parts_.emplace_back();
            parts_.back().material = material_;
        } else if (parts_.back().material != material_) {
            begin_part(material_, material_);
        }
    }

    void begin_part(std::string name, std::string material) {
        if (!parts_.empty() && !parts_.back().used) parts_.pop_back();
        parts_.push_back({std::move(name), std::move(material)});
    }

    /// Parts of one name are one; a single one is none.
    void name_parts() {
        std::map<std::string, std::uint32_t> numbers;
        std::vector<std::uint32_t> number_of(parts_.size());
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            const Part& part = parts_[i];
            if (!part.used) continue;
            std::string name = !part.name.empty()       ? part.name
                               : !part.material.empty() ? part.material
                                                        : fmt::format("part {}", i + 1);
            const auto next = static_cast<std::uint32_t>(mesh_.part_names.size());
            const auto [known, is_new] = numbers.try_emplace(name, next);
            if (is_new) mesh_.part_names.push_back(std::move(name));
            number_of[i] = known->second;
        }
        for (std::uint32_t& part : mesh_.parts) part = number_of[part];
        if (mesh_.part_names.size() > 1) return;
        mesh_.part_names.clear();
        mesh_.parts.clear();
    }

    /// One colour for all, or several at the vertices.
    void take_colors_of_materials() {
        if (!materials_.missing().empty()) {
            mesh_.warnings.push_back(
                fmt::format("The material library '{}' is not beside the file; its colours are "
                            "left out.",
                            materials_.missing()));
        }
        std::vector<std::optional<Rgb8>> colors;
        for (const Part& part : parts_) {
            if (part.used) colors.push_back(materials_.color(part.material));
            if (!part.used) colors.push_back(colors.empty() ? std::nullopt : colors.back());
        }
        const auto differs = [&](const auto& color) { return color != colors.front(); };
        if (colors.empty() || std::ranges::none_of(colors, differs)) {
            if (!colors.empty()) mesh_.color = colors.front();
            return;
        }
        mesh_.colors.assign(mesh_.positions.size(), Material{}.color);
        std::vector<bool> done(mesh_.positions.size());
        std::uint32_t begin = 0;
        for (std::size_t i = 0; i < mesh_.polygon_ends.size(); ++i) {
            const Rgb8 color = colors[mesh_.parts[i]].value_or(Material{}.color);
            for (; begin < mesh_.polygon_ends[i]; ++begin) {
                const std::uint32_t vertex = mesh_.corners[begin];
                if (!done[vertex]) mesh_.colors[vertex] = color;
                done[vertex] = true;
            }
        }
    }

    const Path& file_;
    LineCursor lines_;
    std::string joined_;
    std::array<Reference, 3> references_{Reference{"vertex"}, Reference{"texture coordinate"},
                                         Reference{"normal"}};
    PolygonMesh mesh_;
    std::vector<Vec3f> normals_;
    std::vector<std::uint32_t> corner_normals_;  ///< a corner, as long as all have one
    bool all_have_normals_ = true;
    std::vector<Part> parts_;
    std::string material_;
    ObjMaterials materials_;
};

PolygonMesh read_polygons(const Path& file) {
    const std::string text = read_text(file);
    return ObjReader(file, text).read();
}

FileContents read_obj(const Path& file, const ReadOptions& /*options*/) {
    return mesh_contents(file, read_polygons(file));
}

}  // namespace

Reader obj_reader() {
    static constexpr std::array<std::string_view, 1> kExtensions{"obj"};
    return {"OBJ", kExtensions, read_obj};
}

}  // namespace ink
