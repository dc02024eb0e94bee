#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "read_contents.h"
#include "test_files.h"

namespace ink {
namespace {

namespace fs = std::filesystem;
using test::data_file;
using test::expect_refused;
using test::positions;
using test::read_bytes;
using test::spheres;
using test::TemporaryFolder;

/// How an archive is written.
struct Form {
    bool big_endian = false;
    int size_bits = 64;
    bool gzip = true;
};

/// One variable of one material in one patch.
struct Variable {
    std::string name, type;
    int material, patch;
    std::size_t particles;
    std::vector<double> numbers;
};

template <class T>
void append(std::string& bytes, T number, const Form& form) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(number);
    if (form.big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
    bytes.append(raw.data(), raw.size());
}

std::string block(const Variable& variable, const Form& form) {
    std::string bytes;
    for (const double x : variable.numbers) {
        if (variable.type == "int") {
            append(bytes, static_cast<std::int32_t>(x), form);
        } else if (variable.type == "long64") {
            append(bytes, static_cast<std::int64_t>(x), form);
        } else {
            append(bytes, x, form);
        }
    }
    if (!form.gzip) return bytes;
    std::string packed;
    form.size_bits == 64 ? append(packed, std::uint64_t{bytes.size()}, form)
                         : append(packed, static_cast<std::uint32_t>(bytes.size()), form);
    std::string stream(compressBound(bytes.size()), '\0');
    uLongf size = stream.size();
    compress(reinterpret_cast<Bytef*>(stream.data()), &size,
             reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return packed + stream.substr(0, size);
}

/// An archive of one time step for each list of variables.
fs::path write_archive(const TemporaryFolder& folder,
                       const std::vector<std::vector<Variable>>& steps, const Form& form = {}) {
    fs::create_directory(folder.path() / "a.uda");
    const std::string meta =
        fmt::format("<Meta><endianness>{}_endian</endianness><nBits>{}</nBits></Meta>",
                    form.big_endian ? "big" : "little", form.size_bits);
    std::string index = "<Uintah_DataArchive>" + meta + "<variables>";
    std::string times;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        const std::string step = fmt::format("a.uda/t{}", k);
        fs::create_directories(folder.path() / step / "l0");
        std::string list;
        std::string data;
        for (const Variable& variable : steps[k]) {
            const std::string type = fmt::format("ParticleVariable&lt;{}&gt;", variable.type);
            index += fmt::format("<variable type=\"{}\" name=\"{}\"/>", type, variable.name);
            data.resize(data.size() + 5);  // blocks need not be next to each other
            const std::size_t start = data.size();
            data += block(variable, form);
            list += fmt::format(
                "<Variable type=\"{}\"><variable>{}</variable><index>{}</index>"
                "<patch>{}</patch><start>{}</start><numParticles>{}</numParticles>{}"
                "<end>{}</end><filename>p0.data</filename></Variable>",
                type, variable.name, variable.material, variable.patch, start, variable.particles,
                form.gzip ? "<compression>gzip</compression>" : "", data.size());
        }
        folder.write(step + "/l0/p0.data", data);
        folder.write(step + "/l0/p0.xml", "<Uintah_Output>" + list + "</Uintah_Output>");
        folder.write(step + "/timestep.xml",
                     "<Uintah_timestep>" + meta +
                         "<Data><Datafile href=\"l0/p0.xml\"/></Data></Uintah_timestep>");
        times += fmt::format("<timestep href=\"t{}/timestep.xml\">{}</timestep>", k, k);
    }
    folder.write("a.uda/index.xml",
                 index + "</variables><timesteps>" + times + "</timesteps></Uintah_DataArchive>");
    return folder.path() / "a.uda";
}

/// Two patches, and the second one's fields first.
std::vector<Variable> two_patches() {
    return {{"p.size", "double", 0, 1, 1, {0.75}},
            {"p.x", "Point", 0, 0, 2, {1, 2, 3, -4, 5.5, 6}},
            {"p.x", "Point", 0, 1, 1, {7, 8, 9}},
            {"p.size", "double", 0, 0, 2, {0.5, 0.25}},
            {"p.velocity", "Vector", 0, 0, 2, {1, 0, 0, 0, -2, 0}},
            {"p.velocity", "Vector", 0, 1, 1, {0, 0, 3}},
            {"p.particleID", "long64", 0, 0, 2, {4294967296, 5}},
            {"p.particleID", "long64", 0, 1, 1, {6}},
            {"p.color", "int", 0, 0, 2, {-7, 1}},
            {"p.color", "int", 0, 1, 1, {9}},
            {"p.stress", "Matrix3", 0, 1, 1, {1, 2, 3, 4, 5, 6, 7, 8, 9}}};
}

std::vector<float> radii(const FileContents& contents) {
    std::vector<float> out;
    for (const Sphere& sphere : spheres(contents).spheres) out.push_back(sphere.radius);
    return out;
}

ReadOptions with_radius(const std::string& radius) {
    ReadOptions options;
    options.data.radius = radius;
    return options;
}

std::string ranges(const FileContents& contents) {
    std::string text;
    for (const FieldSummary& field : contents.fields) {
        text +=
            fmt::format("{}({}) {} {}; ", field.name, field.components, field.least, field.most);
    }
    return text;
}

TEST(UdaReader, ReadsTheSameParticlesInEveryForm) {
    for (const bool big_endian : {false, true}) {
        for (const int size_bits : {32, 64}) {
            for (const bool gzip : {false, true}) {
                SCOPED_TRACE(fmt::format("{} {} {}", big_endian, size_bits, gzip));
                const TemporaryFolder folder;
                const fs::path archive =
                    write_archive(folder, {two_patches()}, {big_endian, size_bits, gzip});
                ReadOptions options = with_radius("p.size");
                options.summarize = true;
                const FileContents contents = read_file(archive, options);
                EXPECT_EQ(positions(contents),
                          (std::vector<Vec3d>{{1, 2, 3}, {-4, 5.5, 6}, {7, 8, 9}}));
                EXPECT_EQ(radii(contents), (std::vector<float>{0.5F, 0.25F, 0.75F}));
                EXPECT_EQ(ranges(contents),
                          "p.color(1) -7 9; p.particleID(1) 5 4294967296; p.size(1) 0.25 0.75; "
                          "p.stress(9) 1 9; p.velocity(3) -2 3; ");
                EXPECT_TRUE(contents.warnings.empty());
            }
        }
    }
}

TEST(UdaReader, TakesTheRadiiThatTheArchiveNamesSo) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(folder, {{{"p.x", "Point", 0, 0, 2, {0, 0, 0, 0, 0, 3}},
                                                     {"p.radius", "double", 0, 0, 2, {1, 2}}}});
    EXPECT_EQ(radii(read_file(archive)), (std::vector<float>{1, 2}));
}

// As most patches are that the material has not reached, the last one too.
TEST(UdaReader, ReadsPatchesWithoutParticles) {
    const TemporaryFolder folder;
    for (const bool gzip : {false, true}) {
        const fs::path archive = write_archive(folder,
                                               {{{"p.x", "Point", 0, 0, 1, {1, 2, 3}},
                                                 {"p.size", "double", 0, 0, 1, {0.5}},
                                                 {"p.x", "Point", 1, 0, 0, {}},
                                                 {"p.size", "double", 1, 0, 0, {}}}},
                                               {.gzip = gzip});
        ReadOptions options = with_radius("p.size");
        options.facts = true;
        EXPECT_EQ(radii(read_file(archive, options)), std::vector<float>{0.5F});
    }
}

TEST(UdaReader, JoinsMaterialsAndTellsThemApartByAField) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(folder, {{{"p.x", "Point", 2, 0, 1, {1, 0, 0}},
                                                     {"p.x", "Point", 1, 0, 2, {2, 0, 0, 3, 0, 0}},
                                                     {"p.size", "double", 1, 0, 2, {0.5, 0.25}},
                                                     {"p.x", "Point", 3, 0, 0, {}}}});
    EXPECT_EQ(radii(read_file(archive, with_radius("material"))), (std::vector<float>{2, 1, 1}));
    // Nothing is made up for a material that does not have a variable.
    const FileContents some = read_file(archive, with_radius("p.size"));
    EXPECT_EQ(positions(some), (std::vector<Vec3d>{{2, 0, 0}, {3, 0, 0}}));
    EXPECT_EQ(some.warnings.size(), 1U);
}

TEST(UdaReader, TakesEachTimeStepForAFrame) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(
        folder, {two_patches(), {{"p.x", "Point", 0, 0, 1, {5, 0, 0}}}}, {.gzip = false});
    ReadOptions options;
    options.frame = 1;
    const FileContents contents = read_file(archive, options);
    EXPECT_EQ(contents.frames, 2);
    EXPECT_EQ(positions(contents), (std::vector<Vec3d>{{5, 0, 0}}));
    options.frame = 2;
    expect_refused(archive, "has no frame 2; its 2 frames are 0 to 1", options);
}

TEST(UdaReader, LeavesTypesOutThatItDoesNotKnow) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(
        folder, {{{"p.x", "Point", 0, 0, 1, {5, 0, 0}}, {"p.surface", "Short27", 0, 0, 1, {1}}}});
    const FileContents contents = read_file(archive, with_radius("1"));
    ASSERT_EQ(contents.warnings.size(), 1U);
    EXPECT_EQ(contents.warnings[0], "Variable 'p.surface' of type 'Short27' was left out.");
}

TEST(UdaReader, IsAskedForByTheNameOfTheFolder) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(folder, {two_patches()});
    const FileContents contents = read_file(archive / "", with_radius("p.size"));
    EXPECT_EQ(contents.objects.at(0).name, "a");
    EXPECT_EQ(contents.objects.at(0).shape.index(),
              read_file(archive, with_radius("p.size")).objects.at(0).shape.index());
    expect_refused(archive / "t0", "is a directory; name a file in it");
    expect_refused(folder.write("b.uda", "text"), "is not a directory; name the folder");
    fs::create_directory(folder.path() / "c.uda");
    expect_refused(folder.path() / "c.uda", "index.xml: is missing; copy the archive");
}

/// What is said of a good archive in one of whose files `from` has become `to`.
std::string refusal_with(std::string_view file, std::string_view from, std::string_view to,
                         const Form& form = {}) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(folder, {two_patches()}, form);
    std::string text = read_bytes(archive / file);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    folder.write("a.uda/" + std::string(file), text.replace(at, from.size(), to));
    ReadOptions all;
    all.summarize = true;
    const std::string said = test::refusal(archive, all);
    EXPECT_NE(said.find(archive.string()), std::string::npos) << said;
    return said;
}

void expect_says(const std::string& said, std::string_view problem) {
    EXPECT_NE(said.find(problem), std::string::npos) << said;
}

constexpr std::string_view kList = "t0/l0/p0.xml";

TEST(UdaReader, OpensNothingOutsideTheFolder) {
    for (const std::string_view name : {"../../b.data", "/etc/passwd", "a/../../../b", ".."}) {
        const std::string problem = fmt::format("names the file '{}'; expected one in its", name);
        expect_says(refusal_with(kList, "p0.data", name), problem);
        expect_says(refusal_with("t0/timestep.xml", "l0/p0.xml", name), problem);
        expect_says(refusal_with("index.xml", "t0/timestep.xml", name), problem);
    }
    expect_says(refusal_with(kList, "p0.data", ""), "names the file ''");
    expect_says(refusal_with(kList, "p0.data", "p1.data"), "p1.data: is missing");
    expect_says(refusal_with(kList, "p0.data", "."), "is missing");
}

TEST(UdaReader, RefusesRangesThatAreNotInTheFile) {
    const Form raw{.gzip = false};  // p.size of patch 1 is from 5 to 13
    expect_says(refusal_with(kList, "<end>13<", "<end>999999<", raw), "goes from 5 to 999999");
    expect_says(refusal_with(kList, "<start>5<", "<start>14<", raw), "goes from 14 to 13");
    expect_says(refusal_with(kList, "<start>5<", "<start>-5<", raw), "has the start '-5'");
    expect_says(refusal_with(kList, "<end>13<", "<end>x<", raw), "has the end 'x'");
    expect_says(refusal_with(kList, "<end>13<", "<end>12<", raw), "has 7 bytes, too few for 1");
    expect_says(refusal_with(kList, "<start>5<", "<start><", raw), "has the start ''");
    expect_says(refusal_with(kList, "<numParticles>2<", "<numParticles>4000000000000000000<"),
                "too few for 4000000000000000000 particles");
    expect_says(refusal_with(kList, "<start>5<", "<start>20<"), "too few for 1");
}

TEST(UdaReader, RefusesDataThatAreCutOrDamaged) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(folder, {two_patches()});
    const fs::path data = archive / "t0/l0/p0.data";
    const std::string whole = read_bytes(data);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        fs::resize_file(data, size);
        expect_refused(archive, "was it written to the end?");
    }
    std::string damaged = whole;
    damaged[16] ^= 0x55;
    folder.write("a.uda/t0/l0/p0.data", damaged);
    ReadOptions all;
    all.summarize = true;
    expect_refused(archive, "'p.size' of material 0 in patch 1 has damaged compressed data", all);
    damaged = whole;
    damaged[12] = '\x7F';  // of the size, little-endian
    folder.write("a.uda/t0/l0/p0.data", damaged);
    expect_refused(archive, "but 1 particles take 8", all);
}

TEST(UdaReader, RefusesListsThatContradictThemselves) {
    expect_says(refusal_with(kList, "<patch>1<", "<patch>0<"), "is listed twice");
    expect_says(refusal_with(kList, "<patch>1<", "<patch>2<"), "has 1 particles, but 'p.x' has 0");
    expect_says(refusal_with(kList, "<numParticles>1<", "<numParticles>2<"), "'p.x' has 1");
    expect_says(refusal_with(kList, "&lt;double", "&lt;int"), "is of type 'double', but of 'int'");
    expect_says(refusal_with(kList, ">gzip<", ">rle, gzip<"), "is compressed by 'rle, gzip'");
}

TEST(UdaReader, RefusesArchivesThatItCannotUnderstand) {
    const std::string_view step = "t0/timestep.xml";
    expect_says(refusal_with(step, "little_endian", "middle"), "has the endianness 'middle'");
    expect_says(refusal_with(step, ">64<", ">16<"), "sizes of '16' bits");
    expect_says(refusal_with(step, "</Data>", ""), "is not an XML file that can be understood");
    expect_says(refusal_with(step, "<Datafile href=\"l0/p0.xml\"/>", ""), "holds no particles");
    expect_says(refusal_with("index.xml", "<timestep href=\"t0/timestep.xml\">0</timestep>", ""),
                "lists no time steps");
    const TemporaryFolder folder;
    expect_refused(write_archive(folder, {{}}), "lists no variables of particles");
    expect_refused(write_archive(folder, {{{"p.q", "Point", 0, 0, 1, {1, 2, 3}}}}),
                   "no positions 'p.x' are listed");
    expect_refused(write_archive(folder, {{{"p.x", "double", 0, 0, 1, {1}}}}), "not of type Point");
}

TEST(UdaReader, EndsInParticlesOrAMessageWhateverIsWrongWithItsLists) {
    const TemporaryFolder folder;
    const fs::path archive = write_archive(folder, {two_patches()});
    ReadOptions all;
    all.summarize = true;
    for (const std::string_view file : {"index.xml", "t0/timestep.xml", "t0/l0/p0.xml"}) {
        const std::string name = "a.uda/" + std::string(file);
        const std::string whole = read_bytes(archive / file);
        for (std::size_t i = 0; i < whole.size(); i += 17) {
            folder.write(name, whole.substr(0, i));
            expect_refused(archive, "not an XML file", all);
            std::string changed = whole;
            changed[i] = changed[i] == '9' ? '-' : '9';
            folder.write(name, changed);
            test::refusal(archive, all);  // anything but an InputError fails
        }
        folder.write(name, whole);
    }
}

TEST(UdaReader, ReadsTheSamePointsAsTheDumpThatAnArchiveWasMadeOf) {
    const fs::path archive = data_file("particles/synthetic_taylorbar.uda");
    const fs::path dump = data_file("particles/mpm_karamelo_taylorbar3d_step1600.lammpstrj.gz");
    if (!fs::exists(archive) || !fs::exists(dump)) GTEST_SKIP() << archive << " is not there";
    std::vector<Vec3d> found = positions(read_file(archive));
    std::vector<Vec3d> expected = positions(read_file(dump));
    ASSERT_EQ(found.size(), 30780U);
    ASSERT_EQ(expected.size(), found.size());
    const auto before = [](Vec3d a, Vec3d b) {
        const auto key = [](Vec3d p) {
            return std::array{std::lround(p.x * 1e3), std::lround(p.y * 1e3),
                              std::lround(p.z * 1e3)};
        };
        return key(a) < key(b);
    };
    std::ranges::sort(found, before);
    std::ranges::sort(expected, before);
    for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_LT(length(found[i] - expected[i]), 2e-3) << i;
    }
}

TEST(UdaReader, RefusesARealArchiveOfGridVariables) {
    const fs::path archive = data_file("particles/broken/real_uintah_grid_only_partial.uda");
    if (!fs::exists(archive)) GTEST_SKIP() << archive << " is not there";
    expect_refused(archive, "lists no variables of particles; an archive that saves 'p.x'");
}

}  // namespace
}  // namespace ink
