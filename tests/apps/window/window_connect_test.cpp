// SPDX-License-Identifier: Apache-2.0
// `palpate sculpt --connect`: a window that shows the volume of a running service.
#include "engine/journal/volume_identity.hpp"
#include "sculpt_window.hpp"
#include "tests/endurance/process_facts.hpp"

namespace palpate {
namespace window_connect_test {

class OfAService : public OnADesktop {
 protected:
  void SetUp() override {
    OnADesktop::SetUp();
    if (!IsSkipped())
      service = std::make_unique<Started>(
          "", folder.path() / "service",
          std::vector<std::string>{"serve", kBall, "--device", "mouse", "--supervise", "--socket", socket()});
  }
  [[nodiscard]] std::string socket() const { return (folder.path() / "run.sock").string(); }
  [[nodiscard]] pid_t engine() const { return childOf(service->id(), "palpate"); }
  // It is there once its socket is; the window waits for the rest.
  [[nodiscard]] bool isServed() const {
    return waitUntil([&] { return std::filesystem::exists(socket()); });
  }
  std::unique_ptr<Started> service;
};

// It draws and drills there, survives the engine, and leaves the service as it found it.
TEST_F(OfAService, IsSeenDrilledAndSavedAndOutlived) {
  ASSERT_TRUE(isServed());
  shows = {"--connect", socket()};
  start();
  ASSERT_TRUE(showsBall()) << program->said() << service->said();
  const Screen before = desktop->look();
  ASSERT_TRUE(drills());
  const Screen drilled = desktop->look();
  EXPECT_GT(differing(before, drilled, kUpper), 200) << service->said();
  desktop->does({"key", "ctrl+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) == 0; }));
  desktop->does({"key", "ctrl+shift+z"});
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kUpper) == 0; }));
  const std::string file = (folder.path() / "drilled.vdb").string();
  enters(kFileX, kSaveY, file);
  ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); })) << program->said() << service->said();
  EXPECT_NE(contentHash(loadVolume(file)), contentHash(loadVolume(kBall)));

  ASSERT_TRUE(movesOff());
  const Screen saved = desktop->look();
  const pid_t first = engine();
  ASSERT_GT(first, 0);
  kill(first, SIGKILL);
  EXPECT_TRUE(saysSomething(saved)) << program->said();
  EXPECT_TRUE(waitUntil([&] { return engine() > 0 && engine() != first; })) << service->said();
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kUpper) == 0; }));
  ASSERT_TRUE(movesOff());
  // On a busy machine a force has faded now and then, and what is not touched is not drilled.
  EXPECT_TRUE(waitUntil([&] {
    desktop->drags(kMiddleX, kMiddleY, kMiddleX - 60, kMiddleY, 1);
    return movesOff() && differing(drilled, desktop->look(), kUpper) > 200;
  })) << service->said();
  endsWell();
  EXPECT_FALSE(std::filesystem::exists(journals()) && !std::filesystem::is_empty(journals()));
  EXPECT_TRUE(service->runs());
  service->signals(SIGTERM);
  EXPECT_EQ(service->ends(), 0) << service->said();
}

TEST_F(OfAService, RefusesWhatIsNotItsOwn) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{kBall, "--connect", socket()},
                                                {"--connect", socket(), "--iso", "3"},
                                                {"--connect", socket(), "--device", "mouse"},
                                                {"--gpu", "x", "--connect"}}) {
    shows = words;
    start();
    EXPECT_EQ(program->ends(), 2) << program->said();
    EXPECT_THAT(program->said(), testing::HasSubstr("from the service"));
  }
  shows = {"--connect", (folder.path() / "none.sock").string()};
  start();
  EXPECT_EQ(program->ends(), 3) << program->said();
  EXPECT_THAT(program->said(), testing::HasSubstr("no service listens there"));
  shows = {};
  start();
  EXPECT_EQ(program->ends(), 2) << program->said();
  EXPECT_THAT(program->said(), testing::HasSubstr("no volume is named"));
}

}  // namespace window_connect_test
}  // namespace palpate
