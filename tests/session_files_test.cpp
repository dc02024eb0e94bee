// Files of the viewer: read again, played, and what lies under the pointer.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "session_owner.h"

namespace inktrace::viewer {
namespace {

using namespace test;

// ---- Files ----

TEST(Session, SaysWhyAFileCannotBeShown) {
    const TemporaryFolder folder;
    Owner owner;
    owner.open({folder.path() / "missing.pdb"});
    ASSERT_TRUE(owner.wait_for([&] { return owner.session.message().is_error; }));
    EXPECT_FALSE(owner.session.has_scene());
    EXPECT_NE(owner.session.message().text.find("missing.pdb"), std::string::npos);
    owner.open({sample()});
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(owner.session.message().text, "");
}

TEST(Session, ReadsAFileAgainWhenItChangesAndOutlivesIt) {
    const TemporaryFolder folder;
    const fs::path file = folder.write("molecule.xyz", kFrames);
    Owner owner;
    owner.open({file});
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(owner.session.frames(), 3);
    folder.write("molecule.xyz", "1\none\nC 0 0 0\n");
    ASSERT_TRUE(owner.wait_for([&] { return owner.session.frames() == 1; }));
    fs::remove(file);
    ASSERT_TRUE(owner.wait_for([&] { return owner.session.message().is_error; }));
    EXPECT_TRUE(owner.session.has_scene());
    owner.session.move_camera(owner.session.camera().turned(5, 5));
    ASSERT_TRUE(owner.wait_for_picture());
    folder.write("molecule.xyz", kFrames);
    ASSERT_TRUE(owner.wait_for([&] { return owner.session.frames() == 3; }));
    EXPECT_FALSE(owner.session.message().is_error);
}

TEST(Session, ReadsAnArchiveAgainWhenAFileInItChanges) {
    const fs::path archive = ink::test::data_file("particles/synthetic_taylorbar.uda");
    if (!fs::exists(archive)) GTEST_SKIP() << "no shared data";
    const TemporaryFolder folder;
    const fs::path copy = folder.path() / "run.uda";
    fs::copy(archive, copy, fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(copy)) {
        fs::permissions(entry.path(), fs::perms::owner_all, fs::perm_options::add);
    }
    Owner owner;
    owner.open({copy});
    ASSERT_TRUE(owner.wait_for_picture());
    for (const char* const name : {"index.xml", "t01600/l0/p00000.xml"}) {
        const std::string whole = ink::test::read_bytes(copy / name);
        folder.write("run.uda/" + std::string(name), "<nonsense");
        ASSERT_TRUE(owner.wait_for([&] { return owner.session.message().is_error; })) << name;
        EXPECT_TRUE(owner.session.has_scene());
        folder.write("run.uda/" + std::string(name), whole);
        ASSERT_TRUE(owner.wait_for([&] { return !owner.session.message().is_error; })) << name;
    }
}

TEST(Session, EndsInTheMiddleOfWork) {
    for (int k = 0; k < 3; ++k) {
        Owner owner;
        owner.session.open({sample()}, {{"method", "stencil"}, {"aa", "multisample:64"}});
        owner.session.resize({400, 400});
        if (k > 0) owner.wait_for([&] { return owner.session.has_scene(); });
        if (k > 1) owner.wait_for([&] { return owner.session.refinement() > 0.0; });
    }
}

TEST(Session, PlaysAndStepsThroughFrames) {
    const TemporaryFolder folder;
    Owner owner;
    owner.open({folder.write("run.xyz", kFrames)});
    ASSERT_TRUE(owner.wait_for_picture());
    Session& session = owner.session;
    EXPECT_EQ(session.frames(), 3);
    session.set_frame(-1);
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(session.frame(), 2);
    ASSERT_EQ(run(session.command_line("x.png"), folder.path()), 0);
    EXPECT_EQ(read_png(folder.path() / "x.png"), bytes(*session.painting().picture));
    session.frames_per_second = 100;
    session.play(true);
    ASSERT_TRUE(owner.wait_for([&] { return session.frame() == 1; }));
    session.play(false);
}

TEST(Session, PlaysWithTheColoursOfKindsThatAnAnimationIsDrawnWith) {
    // One kind in the first frame, two in the second.
    std::string text;
    for (const int type : {1, 2}) {
        text += fmt::format(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n"
            "0 9\nITEM: ATOMS id type x y z radius\n1 1 0 0 0 1\n2 {} 3 0 0 1\n",
            type);
    }
    const TemporaryFolder folder;
    Owner owner;
    Session& session = owner.session;
    session.open({folder.write("run.lammpstrj", text)}, {});
    session.resize({120, 90});
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(session.settings().get("color-by"), "");
    session.frames_per_second = 100;
    session.play(true);
    ASSERT_TRUE(owner.wait_for([&] { return session.frame() == 1; }));
    session.play(false);
    session.set_frame(0);
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(session.settings().get("color-by"), "type");
    EXPECT_EQ(session.settings().get("colormap"), "categories");
    ASSERT_EQ(run(session.command_line("x.png"), folder.path()), 0);
    EXPECT_EQ(read_png(folder.path() / "x.png"), bytes(*session.painting().picture));
}

TEST(Session, PlaysWithTheRadiusAndRangeOfColoursThatAnAnimationIsDrawnWith) {
    // Neighbours at distance 1, then 2, then 1; the greatest value comes last.
    std::string text;
    for (const auto& [gap, value] : {std::pair{1, 5}, {2, 20}, {1, 50}}) {
        text += fmt::format(
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n"
            "0 9\nITEM: ATOMS id x y z heat cold\n1 0 0 0 0 0\n2 {} 0 0 {} {}\n",
            gap, value, -value);
    }
    const TemporaryFolder folder;
    Owner owner;
    Session& session = owner.session;
    session.open({folder.write("run.lammpstrj", text)}, {{"color-by", "heat"}});
    session.resize({120, 90});
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(session.settings().get("color-range"), "") << "a frame alone has its own";
    session.frames_per_second = 100;
    session.play(true);
    ASSERT_TRUE(owner.wait_for([&] { return session.frame() == 2; }));
    session.play(false);
    ASSERT_TRUE(owner.wait_for_picture());
    EXPECT_EQ(session.settings().get("color-range"), "0:50");
    EXPECT_EQ(session.settings().get("radius"), "0.5");
    ASSERT_EQ(run(session.command_line("x.png"), folder.path()), 0);
    EXPECT_EQ(read_png(folder.path() / "x.png"), bytes(*session.painting().picture));

    session.set("color-by", "cold");
    EXPECT_EQ(session.settings().get("color-range"), "") << "that was another field's";
    session.play(true);
    ASSERT_TRUE(owner.wait_for([&] { return session.settings().get("color-range") == "-50:0"; }));
    session.play(false);
    session.set("color-range", "0:1");
    session.play(true);
    const int before = session.frame();
    ASSERT_TRUE(owner.wait_for([&] { return session.frame() != before; }));
    EXPECT_EQ(session.settings().get("color-range"), "0:1") << "set by hand";
}

// ---- Picking ----

TEST(Session, TellsTheAtomUnderThePointer) {
    const TemporaryFolder folder;
    Owner owner;
    owner.open({folder.write("ala.pdb", kPdb)});
    owner.session.standard_view("front");
    ASSERT_TRUE(owner.wait_for_picture());
    const auto hit = owner.session.pick(90, 45);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->kind, "atom");
    EXPECT_EQ(hit->primitive, 1U);
    EXPECT_NEAR(hit->center[0], 2.0, 1e-5);
    const auto fact = [&](const std::string& name) {
        for (const auto& [known, value] : hit->facts) {
            if (known == name) return value;
        }
        return std::string();
    };
    EXPECT_EQ(fact("name"), "CA");
    EXPECT_EQ(fact("residue"), "ALA 7");
    EXPECT_EQ(fact("chain"), "A");
    EXPECT_EQ(fact("bfactor"), "20.25");
    EXPECT_FALSE(owner.session.pick(1, 1));
    // What is focused comes to the middle.
    const Vec3d center{hit->center[0], hit->center[1], hit->center[2]};
    owner.session.move_camera(owner.session.camera().focused(center));
    const auto middle = owner.session.pick(60, 45);
    ASSERT_TRUE(middle);
    EXPECT_EQ(middle->primitive, 1U);
}

TEST(Session, TellsTheFieldsOfTheParticleUnderThePointer) {
    const TemporaryFolder folder;
    Owner owner;
    owner.session.open({folder.write("dust.csv",
                                     "x,y,z,radius,mass,vx,vy,vz\n9,0,0,1,1,0,0,0\n"
                                     "0,0,0,1,2.5,1,2,3\n4,0,0,1,7,4,5,6\n")},
                       {{"clip", "x=:5"}, {"view", "front"}});
    owner.session.resize({120, 90});
    ASSERT_TRUE(owner.wait_for_picture());
    const auto hit = owner.session.pick(90, 45);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->kind, "particle");
    using Fact = std::pair<std::string, std::string>;
    EXPECT_NE(std::ranges::find(hit->facts, Fact{"mass", "7"}), hit->facts.end());
    EXPECT_NE(std::ranges::find(hit->facts, Fact{"vy", "5"}), hit->facts.end());
}

TEST(Session, TellsTheTriangleUnderThePointer) {
    Owner owner;
    owner.open({ink::test::source_dir() / "tests/pictures/box_on_floor.obj"});
    ASSERT_TRUE(owner.wait_for_picture());
    const auto hit = owner.session.pick(60, 45);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->kind, "triangle");
}

}  // namespace
}  // namespace inktrace::viewer
