#include "readers.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <utility>

#include "io/reader.h"

namespace ink::bench {

namespace {

using Text = std::string;

/// The same numbers on every machine, from 0 to 100.
class Places {
  public:
    double next() { return static_cast<double>(random_()) * (100.0 * 0x1p-32); }

  private:
    std::mt19937 random_{1};
};

template <class T>
void add_raw(Text& text, T value) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    text.append(bytes.data(), bytes.size());
}

template <class... Values>
void add(Text& text, fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

Text pdb(std::size_t bytes) {
    Places at;
    Text text;
    for (std::size_t i = 1; text.size() < bytes; ++i) {
        add(text, "ATOM  {:5}  CA  ALA A{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00 20.00           C\n",
            i % 100000, i % 10000, at.next(), at.next(), at.next());
    }
    return text;
}

Text mmcif(std::size_t bytes) {
    Places at;
    Text text =
        "data_x\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
        "_atom_site.label_atom_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n"
        "_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
        "_atom_site.B_iso_or_equiv\n";
    for (std::size_t i = 1; text.size() < bytes; ++i) {
        add(text, "ATOM {} C CA ALA A {} {:.3f} {:.3f} {:.3f} 20.00\n", i, i / 8, at.next(),
            at.next(), at.next());
    }
    return text;
}

Text lammps(std::size_t bytes) {
    Places at;
    Text rows;
    std::size_t count = 0;
    while (rows.size() < bytes) {
        add(rows, "{} 1 {:.6f} {:.6f} {:.6f} {:.6f} 0.5\n", ++count, at.next(), at.next(),
            at.next(), at.next());
    }
    return fmt::format(
               "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS pp pp pp\n0 100\n"
               "0 100\n0 100\nITEM: ATOMS id type x y z vx radius\n",
               count) +
           rows;
}

Text raw_vtp(std::size_t bytes) {
    Places at;
    const std::size_t count = bytes / 16;
    Text text = fmt::format(
        "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><PolyData>"
        "<Piece NumberOfPoints=\"{}\"><PointData><DataArray type=\"Float32\" Name=\"radius\" "
        "format=\"appended\" offset=\"0\"/></PointData><Points><DataArray type=\"Float32\" "
        "NumberOfComponents=\"3\" format=\"appended\" offset=\"{}\"/></Points></Piece></PolyData>"
        "<AppendedData encoding=\"raw\">_",
        count, 8 + 4 * count);
    add_raw(text, std::uint64_t{4 * count});
    for (std::size_t i = 0; i < count; ++i) add_raw(text, 0.5F);
    add_raw(text, std::uint64_t{12 * count});
    for (std::size_t i = 0; i < 3 * count; ++i) add_raw(text, static_cast<float>(at.next()));
    return text + "</AppendedData></VTKFile>";
}

/// Corner k of triangle `t` of a square sheet of waves, `side` squares along.
Vec3f sheet_corner(std::size_t t, std::size_t k, std::size_t side) {
    static constexpr std::array<std::array<std::size_t, 3>, 2> kCorners{{{0, 1, 3}, {0, 3, 2}}};
    const std::size_t corner = kCorners[t % 2][k];
    const auto x = static_cast<float>(t / 2 % side + corner % 2);
    const auto y = static_cast<float>(t / 2 / side + corner / 2);
    return {x, y, 3.0F * std::sin(0.1F * x) * std::sin(0.1F * y)};
}

Text binary_stl(std::size_t bytes) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(bytes) / 100.0)) + 1;
    const std::size_t count = 2 * side * side;
    Text text(80, ' ');
    add_raw(text, static_cast<std::uint32_t>(count));
    for (std::size_t t = 0; t < count; ++t) {
        text.append(12, '\0');
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f p = sheet_corner(t, k, side);
            add_raw(text, p.x);
            add_raw(text, p.y);
            add_raw(text, p.z);
        }
        text.append(2, '\0');
    }
    return text;
}

/// The corner that a triangle of the sheet has at `k`, as a number of the sheet's points.
std::size_t sheet_index(std::size_t t, std::size_t k, std::size_t side) {
    static constexpr std::array<std::array<std::size_t, 3>, 2> kCorners{{{0, 1, 3}, {0, 3, 2}}};
    const std::size_t corner = kCorners[t % 2][k];
    return (t / 2 / side + corner / 2) * (side + 1) + t / 2 % side + corner % 2;
}

/// Calls `point(x, y, z)` for the points of a sheet and `triangle(a, b, c)` for its triangles.
template <class AddPoint, class AddTriangle>
void make_sheet(std::size_t side, const AddPoint& point, const AddTriangle& triangle) {
    for (std::size_t i = 0; i < (side + 1) * (side + 1); ++i) {
        const auto x = static_cast<float>(i % (side + 1));
        const auto y = static_cast<float>(i / (side + 1));
        point(Vec3f{x, y, 3.0F * std::sin(0.1F * x) * std::sin(0.1F * y)});
    }
    for (std::size_t t = 0; t < 2 * side * side; ++t) {
        triangle(sheet_index(t, 0, side), sheet_index(t, 1, side), sheet_index(t, 2, side));
    }
}

Text obj(std::size_t bytes) {
    Text text;
    make_sheet(
        static_cast<std::size_t>(std::sqrt(static_cast<double>(bytes) / 75.0)) + 1,
        [&](Vec3f p) { add(text, "v {:.5f} {:.5f} {:.5f}\n", p.x, p.y, p.z); },
        [&](std::size_t a, std::size_t b, std::size_t c) {
            add(text, "f {} {} {}\n", a + 1, b + 1, c + 1);
        });
    return text;
}

Text binary_ply(std::size_t bytes) {
    const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(bytes) / 38.0)) + 1;
    Text text = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
        "property float y\nproperty float z\nelement face {}\n"
        "property list uchar int vertex_indices\nend_header\n",
        (side + 1) * (side + 1), 2 * side * side);
    make_sheet(
        side,
        [&](Vec3f p) {
            for (const float v : {p.x, p.y, p.z}) add_raw(text, v);
        },
        [&](std::size_t a, std::size_t b, std::size_t c) {
            add_raw(text, std::uint8_t{3});
            for (const std::size_t i : {a, b, c}) add_raw(text, static_cast<std::int32_t>(i));
        });
    return text;
}

double seconds_to_read(const std::filesystem::path& file) {
    const auto start = std::chrono::steady_clock::now();
    const Scene scene(read_file(file).objects);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::vector<ReaderRow> measure_readers(double megabytes, const std::vector<std::string>& only) {
    const auto bytes = static_cast<std::size_t>(megabytes * 1e6);
    const std::filesystem::path folder = std::filesystem::temp_directory_path();
    const std::pair<const char*, Text (*)(std::size_t)> formats[] = {
        {"pdb", pdb},        {"cif", mmcif}, {"lammpstrj", lammps}, {"vtp", raw_vtp},
        {"stl", binary_stl}, {"obj", obj},   {"ply", binary_ply}};
    std::vector<ReaderRow> rows;
    for (const auto& [format, make] : formats) {
        if (!only.empty() && std::ranges::find(only, format) == only.end()) continue;
        const auto file = folder / fmt::format("inktrace-bench-{}.{}", getpid(), format);
        const Text text = make(bytes);
        std::ofstream(file, std::ios::binary) << text;
        double best = seconds_to_read(file);
        for (int k = 0; k < 2; ++k) best = std::min(best, seconds_to_read(file));
        std::filesystem::remove(file);
        const double size = static_cast<double>(text.size()) * 1e-6;
        rows.push_back({format, size, size / best});
    }
    return rows;
}

}  // namespace ink::bench
