#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "io/reader.h"
#include "read_contents.h"
#include "test_files.h"

namespace ink {
namespace {

using test::data_file;
using test::expect_refused;
using test::positions;
using test::refusal;
using test::spheres;
using test::TemporaryFolder;

const FieldSummary& field(const FileContents& contents, std::string_view name) {
    return *std::ranges::find(contents.fields, name, &FieldSummary::name);
}

template <class T>
std::string raw(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(bytes);
    return {bytes.data(), bytes.size()};
}
std::string count(std::int32_t value) { return raw(value); }
std::string text(std::string_view word) {
    return raw(static_cast<std::int16_t>(word.size())) + std::string(word);
}
std::string reals(std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values) bytes += raw(value);
    return bytes;
}
std::string attribute(std::string_view name, std::int16_t components, std::int32_t type) {
    return text(name) + raw(components) + count(type);
}
std::string header(std::int32_t points, std::int32_t attributes, std::int32_t primitives = 0) {
    std::string bytes = "BgeoV" + count(5) + count(points) + count(primitives);
    for (const std::int32_t number : {0, 0, attributes, 0, 0, 0}) bytes += count(number);
    return bytes;
}

/// Two points with an attribute of each kind.
std::string two_points() {
    std::string bytes = header(2, 5);
    bytes += attribute("id", 1, 1) + count(-1);
    bytes += attribute("Cd", 3, 0) + reals({1, 1, 1});
    bytes += attribute("kind", 1, 4) + count(2) + text("") + text("water");
    bytes += attribute("v", 3, 5) + reals({0, 0, 0});
    bytes += attribute("pscale", 1, 0) + reals({1});
    bytes += reals({1, 2, 3, 1}) + count(7) + reals({1, 0, 0.2F}) + count(0);
    bytes += reals({3, 4, 0, 0.5F});
    bytes += reals({-4, 5.5F, 6, 2}) + count(-9) + reals({-1, 2, 1}) + count(1);
    return bytes + reals({0, 0, 2, 0.25F});
}

TEST(BgeoReader, DrawsPointsWithTheirRadiusColourAndFields) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.bgeo", two_points() + std::string("\0\xff", 2));
    const FileContents contents = read_file(file, {.summarize = true});
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{1, 2, 3}, {-4, 5.5, 6}}));
    EXPECT_EQ(spheres(contents).spheres[0].radius, 0.5F);
    EXPECT_EQ(spheres(contents).spheres[1].radius, 0.25F);
    EXPECT_EQ(spheres(contents).colors, (std::vector<Rgb8>{{255, 0, 51}, {0, 255, 255}}));
    EXPECT_TRUE(contents.warnings.empty());
    ASSERT_EQ(contents.fields.size(), 5U);
    EXPECT_EQ(field(contents, "id").least, -9);
    EXPECT_EQ(field(contents, "id").most, 7);
    EXPECT_EQ(field(contents, "kind").most, 1);
    EXPECT_EQ(field(contents, "v").components, 3U);
    EXPECT_EQ(field(contents, "v").most, 4);
    // The lengths of the velocities are 5 and 2.
    const FileContents sized = read_file(file, {.data = {.radius = "v", .parts = "kind"}});
    EXPECT_EQ(spheres(sized).spheres[0].radius, 5.0F);
    EXPECT_EQ(spheres(sized).spheres[1].radius, 2.0F);
    EXPECT_EQ(spheres(sized).parts, (std::vector<std::uint32_t>{0, 1}));
}

TEST(BgeoReader, RefusesAFileThatIsCutAtAnyByte) {
    const TemporaryFolder folder;
    const std::string whole = two_points();
    for (std::size_t size = 1; size < whole.size(); ++size) {
        const auto file = folder.write("a.bgeo", whole.substr(0, size));
        SCOPED_TRACE(size);
        expect_refused(file, size < 5 ? "does not begin with 'BgeoV'" : "written to the end?");
    }
}

TEST(BgeoReader, TakesAnyBytesWithoutHarm) {
    const TemporaryFolder folder;
    const std::string whole = two_points();
    for (std::size_t at = 0; at < whole.size(); ++at) {
        for (const char byte : {'\x7f', '\xff'}) {
            std::string damaged = whole;
            damaged[at] = byte;
            refusal(folder.write("a.bgeo", damaged));
        }
    }
}

TEST(BgeoReader, RefusesWhatItDoesNotUnderstandAndCountsThatLie) {
    const TemporaryFolder folder;
    const auto refused = [&](const std::string& bytes, std::string_view problem) {
        expect_refused(folder.write("a.bgeo", bytes), problem);
    };
    const std::string point = reals({0, 0, 0, 1});
    refused("\x7fNSJb and so on", "does not begin with 'BgeoV'");
    refused("BgeoV" + count(6) + std::string(32, '\0'), "is version 6 of the format");
    refused(header(0, 0), "holds no particles");
    refused(header(-2, 0) + point, "announces -2 points");
    refused(header(1, -1) + point, "announces -1 attributes");
    refused(header(std::numeric_limits<std::int32_t>::max(), 0) + point,
            "promises 2147483647 points, the file holds 1");
    refused(header(1, std::numeric_limits<std::int32_t>::max()), "end in the header");
    refused(header(1, 1) + attribute("mass", 1, 3) + point, "attribute 'mass' is of type 3");
    refused(header(1, 1) + attribute("mass", 0, 0) + point, "attribute 'mass' has no components");
    refused(header(1, 1) + attribute("mass", -1, 4) + count(0) + point,
            "promises 1 points, the file holds 0");
    refused(header(1, 1) + attribute("s", 1, 4) + count(-1) + point, "announces -1 texts");
    refused(header(1, 1) + attribute("s", 1, 4) + count(2'000'000'000) + point,
            "end in the header");
}

TEST(BgeoReader, LeavesOutPrimitivesAndPointsWithoutAPlaceAndSaysSo) {
    const TemporaryFolder folder;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const FileContents contents =
        read_file(folder.write("a.bgeo", header(3, 0, 4) + reals({nan, 0, 0, 1}) +
                                             reals({1, 2, 3, 1}) + reals({1, 2, 5, 1})));
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{1, 2, 3}, {1, 2, 5}}));
    ASSERT_EQ(contents.warnings.size(), 3U);
    EXPECT_EQ(contents.warnings[0], "4 primitives were left out; points are drawn.");
    EXPECT_TRUE(contents.warnings[1].starts_with("The particles have no radius; 1 was chosen"));
    EXPECT_TRUE(contents.warnings[2].starts_with("1 of 3 particles"));
}

TEST(BgeoReader, AgreesWithTheRealFiles) {
    const std::filesystem::path folder = data_file("particles");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no real files here";
    const FileContents scatter = read_file(folder / "partio_scatter.bgeo", {.summarize = true});
    ASSERT_EQ(positions(scatter).size(), 25U);
    EXPECT_NEAR(positions(scatter)[24].z, 1.3912677764892578, 1e-7);
    EXPECT_EQ(spheres(scatter).colors[0], (Rgb8{235, 170, 54}));
    EXPECT_EQ(field(scatter, "id").least, 0);
    EXPECT_EQ(field(scatter, "id").most, 24);
    EXPECT_EQ(field(scatter, "test").most, 2);
    const FileContents reindeer = read_file(folder / "partio_reindeer.bgeo");
    ASSERT_EQ(positions(reindeer).size(), 16U);
    EXPECT_NEAR(positions(reindeer)[0].x, -903.18408203125, 1e-4);
    EXPECT_NEAR(positions(reindeer)[15].z, 1370.9378662109375, 1e-4);
    EXPECT_EQ(reindeer.fields.size(), 491U);
    expect_refused(folder / "broken/bgeo_truncated.bgeo", "was it written to the end?");
}

}  // namespace
}  // namespace ink
