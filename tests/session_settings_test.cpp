// Settings of the viewer: undone, taken back, in rows.

#include "session/line_rules.h"
#include "session_owner.h"

namespace inktrace::viewer {
namespace {

using namespace test;

TEST(Session, UndoesSettingsAndLeavesTheCamera) {
    Owner owner;
    owner.open({sample()});
    ASSERT_TRUE(owner.wait_for_picture());
    Session& session = owner.session;
    session.set("line-width", "5px");
    session.set("shade", "toon");
    session.move_camera(session.camera().turned(10, 0));
    const std::string eye = session.settings().get("eye");
    session.undo();
    EXPECT_EQ(session.settings().get("shade"), "lambert");
    EXPECT_EQ(session.settings().get("line-width"), "5px");
    EXPECT_EQ(session.settings().get("eye"), eye);
    session.redo();
    EXPECT_EQ(session.settings().get("shade"), "toon");
    session.reset();
    EXPECT_EQ(session.settings().get("line-width"), "3px");
    EXPECT_EQ(session.settings().get("eye"), eye);
    session.undo();
    EXPECT_EQ(session.settings().get("line-width"), "5px");
}

TEST(Session, RefusesAValueAndChangesNothing) {
    Owner owner;
    owner.open({sample()});
    EXPECT_THROW(owner.session.set("line-width", "thick"), Error);
    EXPECT_THROW(owner.session.set("no-such-thing", "1"), Error);
    EXPECT_FALSE(owner.session.can_undo());
    ASSERT_TRUE(owner.wait_for_picture());
}

TEST(Session, TakesBackASettingThatTheFileRefuses) {
    Owner owner;
    owner.open({sample()});
    ASSERT_TRUE(owner.wait_for_picture());
    owner.session.set("color-by", "no-such-field");
    ASSERT_TRUE(owner.wait_for([&] { return owner.session.message().is_error; }));
    EXPECT_EQ(owner.session.settings().get("color-by"), "");
    EXPECT_FALSE(owner.session.can_undo());
    EXPECT_NE(owner.session.message().text.find("no-such-field"), std::string::npos);
}

TEST(LineRules, GiveATypeAStyleAndLeaveTheOthers) {
    LineRules rules("all:width=2px;crease:color=red,opacity=0.5;all@2:width=9px");
    EXPECT_EQ(rules.get("crease", "width"), "2px");
    EXPECT_EQ(rules.get("silhouette", "color"), std::nullopt);
    rules.set("crease", "width", "4px");
    rules.set("silhouette", "color", "#ff0000");
    EXPECT_EQ(rules.text(),
              "all:width=2px;crease:color=red,opacity=0.5,width=4px;silhouette:color=#ff0000;"
              "all@2:width=9px");
    rules.clear("crease");
    EXPECT_FALSE(rules.has("crease"));
    rules.set("silhouette", "color", "");
    EXPECT_EQ(rules.text(), "all:width=2px;all@2:width=9px");
}

}  // namespace
}  // namespace inktrace::viewer
