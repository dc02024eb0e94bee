// The camera of the viewer, as a hand moves it.

#include "session/camera_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace inktrace::viewer {
namespace {

using ink::Vec3d;

CameraPose some_pose() {
    CameraPose pose;
    pose.eye = {3, 4, 12};
    pose.look_at = {1, 0.5, -0.25};
    pose.up = {0.1, 1, 0.2};
    return pose;
}

void expect_near(Vec3d a, Vec3d b) { EXPECT_LT(length(a - b), 1e-12 * (1.0 + length(b))); }

TEST(CameraPose, TurnsAboutThePointItLooksAt) {
    const CameraPose before = some_pose();
    CameraPose pose = before;
    for (int k = 0; k < 36; ++k) pose = pose.turned(10, 0);
    expect_near(pose.eye, before.eye);
    expect_near(pose.look_at, before.look_at);
    pose = before.turned(33, -71);
    EXPECT_NEAR(pose.distance(), before.distance(), 1e-12);
}

TEST(CameraPose, TurnsOnOverThePoles) {
    CameraPose pose = some_pose();
    for (int k = 0; k < 36; ++k) pose = pose.turned(0, 10);
    expect_near(pose.eye, some_pose().eye);
}

TEST(CameraPose, ZoomsToThePointUnderTheCursor) {
    const ink::Size size{640, 480};
    for (const bool parallel : {false, true}) {
        const CameraPose before = some_pose().with_projection(parallel);
        const Vec3d fixed = before.under(100, 350, size);
        expect_near(before.zoomed(0.3, fixed).under(100, 350, size), fixed);
    }
}

TEST(CameraPose, PansByPixels) {
    const ink::Size size{640, 480};
    const CameraPose before = some_pose();
    const Vec3d grabbed = before.under(300, 200, size);
    expect_near(before.panned(25, -40, size.height).under(325, 160, size), grabbed);
}

TEST(CameraPose, RollsThePictureClockwise) {
    const CameraPose before = some_pose();
    const CameraPose after = before.rolled(90);
    expect_near(after.above(), -before.right());
    expect_near(after.eye, before.eye);
}

TEST(CameraPose, KeepsSizesWhenTheProjectionChanges) {
    const CameraPose before = some_pose();
    const CameraPose parallel = before.with_projection(true);
    EXPECT_DOUBLE_EQ(parallel.visible_height(), before.visible_height());
    expect_near(parallel.with_projection(false).eye, before.eye);
}

/// How far a point lies from the middle of a picture, in shares of half its sides.
double place_in(const CameraPose& pose, Vec3d point, ink::Size picture) {
    const Vec3d v = point - pose.eye;
    const double half = pose.orthographic()
                            ? 0.5 * pose.height
                            : -dot(v, pose.back()) * std::tan(pose.fov_deg * std::acos(-1.0) / 360);
    const double across = std::abs(dot(v, pose.right())) / half * picture.height / picture.width;
    return std::max(across, std::abs(dot(v, pose.above())) / half);
}

TEST(CameraPose, FramesABoxAsLargeAsThereIsRoomFor) {
    const Vec3d lower{-3, 1, 2};
    const Vec3d upper{4, 2.5, 9};
    for (const bool parallel : {false, true}) {
        for (const ink::Size size : {ink::Size{640, 480}, {300, 800}, {500, 500}}) {
            for (const CameraPose& from : {some_pose(), some_pose().turned(70, 40).rolled(20)}) {
                const CameraPose pose = from.with_projection(parallel).framing(lower, upper, size);
                double farthest = 0.0;
                for (unsigned corner = 0; corner < 8; ++corner) {
                    const Vec3d point{(corner & 1U) != 0 ? lower.x : upper.x,
                                      (corner & 2U) != 0 ? lower.y : upper.y,
                                      (corner & 4U) != 0 ? lower.z : upper.z};
                    farthest = std::max(farthest, place_in(pose, point, size));
                }
                EXPECT_LT(farthest, 1.0);
                EXPECT_GT(farthest, 0.97);
                expect_near(pose.back(), from.back());
            }
        }
    }
}

TEST(CameraPose, IsReadAsItWasWritten) {
    const CameraPose pose = some_pose().turned(17.3, 4.1).with_projection(true);
    Settings settings;
    pose.write(settings);
    const CameraPose read = CameraPose::of(settings);
    EXPECT_EQ(read.eye, pose.eye);
    EXPECT_EQ(read.look_at, pose.look_at);
    EXPECT_EQ(read.up, pose.up);
    EXPECT_EQ(read.height, pose.height);
}

}  // namespace
}  // namespace inktrace::viewer
