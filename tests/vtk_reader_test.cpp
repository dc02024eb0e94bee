// Points of VTK's XML files in every encoding.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "io/reader.h"
#include "read_contents.h"
#include "test_files.h"

namespace ink {
namespace {

using test::expect_refused;
using test::positions;
using test::radii;
using test::TemporaryFolder;

constexpr std::array<float, 6> kPlaces{1, 2, 3, -4, 5.5F, 6};
constexpr std::array<double, 2> kRadii{0.5, 0.25};

template <class T, std::size_t N>
std::string raw(const std::array<T, N>& values, bool swap = false) {
    std::string bytes;
    for (const T value : values) {
        auto one = std::bit_cast<std::array<char, sizeof(T)>>(value);
        if (swap) std::ranges::reverse(one);
        bytes.append(one.data(), one.size());
    }
    return bytes;
}

std::string number(std::uint32_t value, bool swap = false) {
    return raw(std::array<std::uint32_t, 1>{value}, swap);
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        const std::size_t count = std::min<std::size_t>(bytes.size() - i, 3);
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
        }
    }
    return text;
}

/// Blocks of `block` bytes, each deflated on its own: header and data.
std::pair<std::string, std::string> deflated(std::string_view bytes, std::size_t block) {
    const std::size_t blocks = (bytes.size() + block - 1) / block;
    std::string header = number(static_cast<std::uint32_t>(blocks)) +
                         number(static_cast<std::uint32_t>(block)) +
                         number(static_cast<std::uint32_t>(bytes.size() % block));
    std::string data;
    for (std::size_t b = 0; b < blocks; ++b) {
        const std::string_view part = bytes.substr(b * block, block);
        std::string packed(compressBound(part.size()), '\0');
        uLongf size = packed.size();
        compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                 reinterpret_cast<const Bytef*>(part.data()), part.size());
        header += number(static_cast<std::uint32_t>(size));
        data += packed.substr(0, size);
    }
    return {header, data};
}

std::string vtk(std::string_view type, std::string_view attributes, std::string_view format,
                std::string_view radii_text, std::string_view places_text,
                std::string_view appended = {}, std::string_view count = "2") {
    return fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" {1}>\n<{0}><Piece NumberOfPoints=\"{6}\">\n"
        "<PointData><DataArray type=\"Float64\" Name=\"radius\" {2}>{3}</DataArray></PointData>\n"
        "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" "
        "{4}>{5}</DataArray></Points>\n"
        "</Piece></{0}>{7}</VTKFile>\n",
        type, attributes, format, radii_text, format, places_text, count, appended);
}

TEST(VtkReader, ReadsTheSamePointsFromEveryEncoding) {
    const TemporaryFolder folder;
    const std::string r = raw(kRadii);
    const std::string p = raw(kPlaces);
    const auto [r_head, r_data] = deflated(r, 10);
    const auto [p_head, p_data] = deflated(p, 10);
    constexpr std::string_view kLittle = "byte_order=\"LittleEndian\"";
    const std::string zlib = std::string(kLittle) + " compressor=\"vtkZLibDataCompressor\"";
    const auto appended = [&](std::string_view encoding, const std::string& radii_bytes,
                              const std::string& places_bytes, std::string_view attributes) {
        std::string text = vtk("PolyData", attributes, "format=\"appended\" offset=\"0\"", "", "",
                               fmt::format("<AppendedData encoding=\"{}\">\n  _", encoding));
        const std::string second = fmt::format("offset=\"{}\"", radii_bytes.size());
        text.replace(text.rfind("offset=\"0\""), 10, second);
        const std::size_t end = text.find("</VTKFile>");
        return text.insert(end, radii_bytes + places_bytes + "\n</AppendedData>");
    };
    const std::map<std::string, std::string> files{
        {"ascii.vtp", vtk("PolyData", kLittle, "format=\"ascii\"", "0.5\n 0.25", "1 2 3 -4 5.5 6")},
        {"ascii.vtu",
         vtk("UnstructuredGrid", kLittle, "format=\"ascii\"", "0.5 0.25", "1 2 3 -4 +5.5 6e0")},
        {"base64.vtp",
         vtk("PolyData", kLittle, "format=\"binary\"", fmt::format("\n{}", base64(number(16) + r)),
             base64(number(24) + p) + "\n")},
        {"zlib.vtp", vtk("PolyData", zlib, "format=\"binary\"", base64(r_head) + base64(r_data),
                         base64(p_head) + base64(p_data))},
        {"raw.vtp", appended("raw", number(16) + r, number(24) + p, kLittle)},
        {"big.vtp", appended("raw", number(16, true) + raw(kRadii, true),
                             number(24, true) + raw(kPlaces, true), "byte_order=\"BigEndian\"")},
        {"rawzlib.vtp", appended("raw", r_head + r_data, p_head + p_data, zlib)},
        {"appended64.vtp",
         appended("base64", base64(number(16) + r), base64(number(24) + p), kLittle)},
        {"wide.vtp", appended("raw", raw(std::array<std::uint64_t, 1>{16}) + r,
                              raw(std::array<std::uint64_t, 1>{24}) + p,
                              std::string(kLittle) + " header_type=\"UInt64\"")}};
    for (const auto& [name, text] : files) {
        SCOPED_TRACE(name);
        const FileContents contents = read_file(folder.write(name, text));
        EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{1, 2, 3}, {-4, 5.5, 6}}));
        EXPECT_EQ(radii(contents), (std::vector<float>{0.5F, 0.25F}));
    }
}

TEST(VtkReader, RefusesDataThatDoNotHoldWhatIsAnnounced) {
    const TemporaryFolder folder;
    const auto ascii = [&](std::string_view radii_text, std::string_view count) {
        return folder.write(
            "a.vtp", vtk("PolyData", "", "format=\"ascii\"", radii_text, "1 2 3 4 5 6", {}, count));
    };
    expect_refused(ascii("1  ", "2"), "array 'radius' has 1 of 2 numbers");
    expect_refused(ascii("1 x", "2"), "no number in place 2");
    expect_refused(ascii("1 1", "999999999"), "fewer numbers than it announces");
    expect_refused(ascii("1 1", "-3"), "a piece has '-3' points");
    expect_refused(ascii("1 1", "0"), "holds no particles");
    expect_refused(
        folder.write("b.vtp", vtk("PolyData", "", "format=\"appended\" offset=\"99\"", "", "")),
        "begins after the end of the data");
    expect_refused(folder.write("c.vtp", "<VTKFile type=\"PolyData\"><PolyData>"),
                   "was it written");
    expect_refused(folder.write("d.vtp", vtk("ImageData", "", "format=\"ascii\"", "1 1", "")),
                   "holds 'ImageData'");
    expect_refused(folder.write("e.vtp", vtk("PolyData", "compressor=\"vtkLZ4DataCompressor\"",
                                             "format=\"binary\"", "", "")),
                   "compressed by 'vtkLZ4DataCompressor'");
}

TEST(VtkReader, SetsNoMemoryAsideForBlocksThatLie) {
    const TemporaryFolder folder;
    const std::string lie =
        base64(number(1) + number(0xF0000000U) + number(0) + number(8)) + base64("12345678");
    const auto file = folder.write("a.vtp", vtk("PolyData", "compressor=\"vtkZLibDataCompressor\"",
                                                "format=\"binary\"", lie, lie, {}, "300000000"));
    expect_refused(file, "block of no sense");
}

}  // namespace
}  // namespace ink
