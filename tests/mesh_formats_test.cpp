#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "base/error.h"
#include "io/child_process.h"
#include "io/reader.h"
#include "test_files.h"

namespace ink {
namespace {

using test::data_file;
using test::TemporaryFolder;

const Mesh& mesh(const FileContents& contents) {
    return std::get<Mesh>(contents.objects.at(0).shape);
}

std::string refusal(const std::filesystem::path& file) {
    try {
        read_file(file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "(it was read)";
}

void expect_refused(const std::filesystem::path& file, std::string_view problem) {
    const std::string message = refusal(file);
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_NE(message.find(problem), std::string::npos) << message;
}

// ---- OFF ----

constexpr std::string_view kPyramid =
    "OFF # with a comment\n5 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n\n0.5 0.5 1\n"
    "4 0 3 2 1\n3 0 1 4\n3 1 2 4 255 0 0\n3 2 3 4\n3 3 0 4\n";

TEST(OffReader, KeepsPolygonsAsFaces) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write("a.off", kPyramid));
    EXPECT_EQ(mesh(contents).vertices.size(), 5U);
    EXPECT_EQ(mesh(contents).triangles.size(), 6U);
    EXPECT_EQ(mesh(contents).faces[0], mesh(contents).faces[1]);
    EXPECT_NE(mesh(contents).faces[1], mesh(contents).faces[2]);
}

TEST(OffReader, ReadsColoursAndNormals) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write(
        "a.off",
        "CNOFF\n3 1 3\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 255 0\n0 1 0 0 0 1 0 0 255\n3 0 1 2\n"));
    EXPECT_EQ(mesh(contents).colors, (std::vector<Rgb8>{{255, 0, 0}, {0, 255, 0}, {0, 0, 255}}));
    EXPECT_EQ(mesh(contents).corner_normals.size(), 1U);
}

TEST(OffReader, NamesThePlaceAndTheRemedy) {
    const TemporaryFolder folder;
    const auto with = [&](std::string_view what, std::string_view other) {
        std::string text(kPyramid);
        text.replace(text.find(what), what.size(), other);
        return folder.write("a.off", text);
    };
    expect_refused(with("OFF", "FOO"), ":1: the first word is 'FOO', not OFF");
    expect_refused(with("OFF #", "OFF BINARY #"), "cannot be read; write plain OFF");
    expect_refused(with("5 5 0", "5000000000 5 0"), "more than fit in the file");
    expect_refused(with("5 5 0", "5 -5 0"), "expected the number of faces, found '-5'");
    expect_refused(with("3 3 0 4", "3 3 0 5"), ":13: face 4 uses vertex '5'");
    expect_refused(with("1 1 0", "1 nan 0"), ":5: vertex with a coordinate that is not finite");
    expect_refused(with("1 1 0", "1 up 0"), ":5: vertex with 'up' for a number");
    expect_refused(with("3 3 0 4\n", ""), "the file ends after 4 of 5 faces");
}

// ---- glTF ----

/// A triangle, placed by nodes: JSON of the nodes, and what the root scene holds.
std::string glb(std::string_view nodes, std::string_view accessor_max = "[1,1,0]",
                std::uint32_t vertex_count = 3, std::string_view index_type = "5123") {
    std::string binary;
    const auto add = [&](auto value) {
        const auto bytes = std::bit_cast<std::array<char, sizeof(value)>>(value);
        binary.append(bytes.data(), bytes.size());
    };
    for (const float x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) add(x);
    for (const int index : {0, 1, 2, 0}) add(static_cast<std::uint16_t>(index));
    std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{}],)"
        R"("meshes":[{{"name":"tri","primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
        R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3",)"
        R"("min":[0,0,0],"max":{}}},{{"bufferView":1,"componentType":{},"count":3,)"
        R"("type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":36}},)"
        R"({{"buffer":0,"byteOffset":36,"byteLength":6}}],"buffers":[{{"byteLength":44}}]}})",
        nodes, vertex_count, accessor_max, index_type);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::string chunk = std::exchange(binary, {});
    add(std::uint32_t{0x46546C67});
    add(std::uint32_t{2});
    add(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + chunk.size()));
    add(static_cast<std::uint32_t>(json.size()));
    add(std::uint32_t{0x4E4F534A});
    binary += json;
    add(static_cast<std::uint32_t>(chunk.size()));
    add(std::uint32_t{0x004E4942});
    return binary + chunk;
}

TEST(GltfReader, PlacesNestedAndRepeatedNodes) {
    const TemporaryFolder folder;
    // The first copy at x = 10; below it a second, twice as large, moved by 3 more.
    const FileContents contents = read_file(folder.write(
        "a.glb", glb(R"({"name":"outer","mesh":0,"translation":[10,0,0],"children":[1]},)"
                     R"({"name":"inner","mesh":0,"translation":[0,0,3],"scale":[2,2,2]})")));
    EXPECT_EQ(mesh(contents).triangles.size(), 2U);
    EXPECT_EQ(contents.objects[0].part_names, (std::vector<std::string>{"outer", "inner"}));
    const Bounds3d box = contents.objects[0].world_bounds();
    EXPECT_NEAR(length(box.lower - Vec3d{10, 0, 0}), 0.0, 1e-6);
    EXPECT_NEAR(length(box.upper - Vec3d{12, 2, 3}), 0.0, 1e-6);
}

TEST(GltfReader, KeepsTheOutsideOfAMirroredPartOutside) {
    const TemporaryFolder folder;
    const auto z_of = [&](std::string_view scale) {
        const FileContents contents =
            read_file(folder.write("a.glb", glb(fmt::format(R"({{"mesh":0,"scale":{}}})", scale))));
        const Mesh& m = mesh(contents);
        const auto& [a, b, c] = m.triangles[0];
        return cross(m.vertices[b] - m.vertices[a], m.vertices[c] - m.vertices[a]).z;
    };
    EXPECT_GT(z_of("[1,1,1]"), 0.0F);
    EXPECT_GT(z_of("[-1,1,1]"), 0.0F);
}

TEST(GltfReader, RefusesTrianglesOfVerticesThatAreNotThere) {
    const TemporaryFolder folder;
    // Two triangles, whose indices are bytes and the last ones of the file.
    std::string bytes = glb(R"({"mesh":0})", "[1,1,0]", 3, "5121");
    const std::string_view three = R"("count":3,"type":"SCALAR")";
    bytes[bytes.find(three) + three.find('3')] = '6';
    const auto with = [&](std::string indices) {
        indices.resize(8);
        return folder.write("a.glb", bytes.substr(0, bytes.size() - 8) + indices);
    };
    EXPECT_EQ(mesh(read_file(with({0, 1, 2, 2, 1, 0}))).triangles.size(), 2U);
    expect_refused(with({0, 1, 2, 0, 1, 3}),
                   "1 of 2 triangles use vertices that are not there; the file is damaged");
}

TEST(GltfReader, NamesACompressionThatItDoesNotKnow) {
    const TemporaryFolder folder;
    expect_refused(
        folder.write("a.gltf", R"({"asset":{"version":"2.0"},)"
                               R"("extensionsRequired":["KHR_draco_mesh_compression"]})"),
        "needs 'KHR_draco_mesh_compression', which is not understood; export it without");
}

TEST(MeshReader, CountsEdgesWithMoreThanTwoFaces) {
    const TemporaryFolder folder;
    // Three leaves of a book.
    const FileContents contents =
        read_file(folder.write("a.off",
                               "OFF\n5 3 0\n0 0 0\n0 0 1\n1 0 0\n-1 1 0\n-1 -1 0\n"
                               "3 0 1 2\n3 0 1 3\n3 0 1 4\n"));
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_TRUE(contents.warnings[0].starts_with("1 edge has more than two faces"));
}

TEST(MeshReader, SaysWhichTrianglesHaveNoArea) {
    const TemporaryFolder folder;
    const FileContents contents = read_file(folder.write(
        "a.off", "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 0\n0 0 0\n3 0 1 2\n3 0 1 3\n3 0 4 2\n"));
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_TRUE(contents.warnings[0].starts_with("2 of 3 triangles have no area"));
    EXPECT_EQ(mesh(contents).triangles.size(), 1U);
}

TEST(GltfReader, RefusesWhatAssimpCannotRead) {
    const TemporaryFolder folder;
    expect_refused(folder.write("a.glb", glb(R"({"mesh":7})")), "cannot be read as a glTF file");
    expect_refused(folder.write("b.glb", glb(R"({"mesh":0})").substr(0, 400)),
                   "cannot be read as a glTF file");
    expect_refused(folder.write("c.gltf", "{]"), "cannot be read as a glTF file");
    expect_refused(folder.write("d.glb", glb(R"({"mesh":0})", "[1,1,0]", 4'000'000'000U)),
                   "glTF file");
}

// ---- Child processes ----

TEST(ChildProcess, ReturnsWhatTheWorkReturns) {
    const std::string large(3'000'000, 'x');
    const ChildResult result = in_child_process([&] { return large + "y"; }, {});
    EXPECT_EQ(result.end, ChildResult::End::done);
    EXPECT_EQ(result.bytes, large + "y");
}

TEST(ChildProcess, MayDieWithoutTakingThisOneWithIt) {
    const auto kill_itself = []() -> std::string {
        std::signal(SIGKILL, SIG_DFL);
        std::raise(SIGKILL);
        return "never";
    };
    EXPECT_EQ(in_child_process(kill_itself, {}).end, ChildResult::End::died);
    const auto fail = []() -> std::string { throw std::runtime_error("no"); };
    EXPECT_EQ(in_child_process(fail, {}).end, ChildResult::End::died);
    const auto leave = []() -> std::string { std::_Exit(0); };
    EXPECT_EQ(in_child_process(leave, {}).bytes, "");
}

TEST(ChildProcess, IsStoppedWhenItTakesTooMuch) {
    const auto spin = []() -> std::string {
        while (std::chrono::steady_clock::now().time_since_epoch().count() > 0) {
        }
        return "never";
    };
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(in_child_process(spin, {.cpu_seconds = 1}).end, ChildResult::End::too_large);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    const auto talk = []() -> std::string { return std::string(1000, 'x'); };
    EXPECT_EQ(in_child_process(talk, {.result_bytes = 10}).end, ChildResult::End::too_large);
#ifndef __SANITIZE_ADDRESS__
    const auto eat = []() -> std::string { return std::string(std::size_t{1} << 30, 'x'); };
    EXPECT_EQ(in_child_process(eat, {.memory_bytes = 1 << 20}).end, ChildResult::End::too_large);
#endif
}

// ---- Real files ----

TEST(RealMeshes, OpenWithTheSizesThatTheirPagesState) {
    struct RealFile {
        const char* name;
        std::size_t triangles, parts;
    };
    const RealFile files[] = {{"3holes.off", 7200, 0},          {"BoxInterleaved.glb", 12, 0},
                              {"monkey.glb", 968, 0},           {"nested_nodes.glb", 36, 3},
                              {"kenney_character.glb", 550, 6}, {"kenney_block-coin.glb", 788, 0}};
    if (!std::filesystem::exists(data_file("meshes"))) GTEST_SKIP() << "no real files here";
    for (const RealFile& file : files) {
        SCOPED_TRACE(file.name);
        const FileContents contents = read_file(data_file("meshes") / file.name);
        EXPECT_EQ(mesh(contents).triangles.size(), file.triangles);
        EXPECT_EQ(contents.objects[0].part_names.size(), file.parts);
    }
}

}  // namespace
}  // namespace ink
