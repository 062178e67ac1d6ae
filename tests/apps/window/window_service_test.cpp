// SPDX-License-Identifier: Apache-2.0
// `palpate sculpt --service`: the window's servo is in a process of its own, and may be killed.
#include <csignal>

#include "sculpt_window.hpp"
#include "tests/endurance/process_facts.hpp"

namespace palpate {
namespace window_service_test {

// What was drilled stays, can be undone and drilled again, and is saved; another volume has another servo.
TEST_F(OnADesktop, TheWindowOutlivesItsServo) {
  options = {"--service"};
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  ASSERT_TRUE(drills());
  const Screen drilled = desktop->look();
  EXPECT_GT(differing(before, drilled, kUpper), 200);
  const auto servo = [&] { return childOf(program->id(), "palpate-servo"); };
  const pid_t first = servo();
  ASSERT_GT(first, 0);
  kill(first, SIGKILL);
  EXPECT_TRUE(saysSomething(drilled)) << program->said();
  desktop->does({"key", "ctrl+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  desktop->does({"key", "ctrl+shift+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kUpper) == 0; }));
  const std::string file = (folder.path() / "drilled.vdb").string();
  enters(kFileX, kSaveY, file);
  ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); })) << program->said();

  enters(kFileX, kOpenY, "phantom:sphere?size=48&seed=2");
  EXPECT_TRUE(waitUntil([&] { return servo() > 0 && servo() != first; })) << program->said();
  ASSERT_TRUE(movesOff());  // it is open
  endsWell();
  EXPECT_EQ(servo(), 0);
}

}  // namespace window_service_test
}  // namespace palpate
