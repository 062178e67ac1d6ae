// SPDX-License-Identifier: Apache-2.0
// Vulkan devices that are lost, hang or have no memory while a service works.
#include <fstream>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "served_sphere.hpp"

namespace palpate {
namespace lost_device_test {

using testing::HasSubstr;

// A Vulkan layer that loses the device when it is told to (tests/support/vulkan_faults_layer.cpp).
class LosesDevices {
 public:
  explicit LosesDevices(const std::filesystem::path& folder) : order_(folder / "fault") {
    std::filesystem::create_directories(folder / "layers");
    std::ofstream(folder / "layers/faults.json")
        << R"({"file_format_version": "1.0.0", "layer": {"name": "VK_LAYER_palpate_faults", "type": "GLOBAL", )"
        << R"("api_version": "1.3.0", "implementation_version": "1", "description": "loses the device", )"
        << R"("library_path": ")" << PALPATE_FAULTS_LAYER << R"("}})";
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_palpate_faults", 1);
    setenv("VK_LAYER_PATH", ("/usr/share/vulkan/explicit_layer.d:" + (folder / "layers").string()).c_str(), 1);
    setenv("PALPATE_VULKAN_FAULT", order_.c_str(), 1);
  }
  ~LosesDevices() {
    for (const char* name : {"VK_INSTANCE_LAYERS", "VK_LAYER_PATH", "PALPATE_VULKAN_FAULT"}) unsetenv(name);
  }
  LosesDevices(const LosesDevices&) = delete;
  LosesDevices& operator=(const LosesDevices&) = delete;
  // With the next submission: VK_ERROR_DEVICE_LOST.
  void next() const { writeFileAtomically(order_, "submit -4"); }
  // The same, and then there is no memory for the next buffer: VK_ERROR_OUT_OF_DEVICE_MEMORY.
  void nextWithoutMemory() const { writeFileAtomically(order_, "submit -4\nallocate -2"); }
  void noMemory() const { writeFileAtomically(order_, "allocate -2"); }
  // With the next wait: VK_TIMEOUT, as of a kernel that does not end.
  void hangs() const { writeFileAtomically(order_, "wait 2"); }
  [[nodiscard]] bool isDone() const { return !std::filesystem::exists(order_); }
  void noMore() const { std::filesystem::remove(order_); }

 private:
  std::filesystem::path order_;
};

class LostDevice : public ServedSphere {};

// Filters from before a crash for which there is no memory any more: it begins without them, and says so.
TEST_F(LostDevice, FiltersThatCannotBeMadeAgainKeepNobodyOut) {
  const LosesDevices loses(folder());
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  expectSuccess(ctl({"filter", "gaussian:1"}));
  ASSERT_TRUE(awaitKept("gaussian:1"));
  engine.end(SIGKILL);
  loses.noMemory();
  serve({kServedSphere});
  ASSERT_TRUE(awaitService()) << contentsOf(file("serve.log"));
  EXPECT_TRUE(loses.isDone());
  EXPECT_EQ(ctl({"get", "filter"}).out, "filter = \n");
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("settings from before are not taken: "));
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_GT(densityAt("back.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
}

// The device is lost again and again, while a hand presses and clients edit: the engine is made anew in the same
// process, clients and servo stay, and what was answered is there.
TEST_F(LostDevice, ALostDeviceIsMadeAnew) {
  const LosesDevices loses(folder());
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1"});
  const pid_t process = engine.id();
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  const double tick = status()["tick"];
  std::size_t answered = 0;
  for (int lost = 0; lost < 3; ++lost) {
    loses.next();
    for (int i = 0; i < 4; ++i) {
      const Outcome edit = ctl({"edit", fmt::format("add:radius=1mm:at={},-12,-12mm", -12 + 2 * (4 * lost + i))});
      if (edit.status == 0) ++answered;
      EXPECT_TRUE(edit.status == 0 || edit.err.find("driver") != std::string::npos) << edit.err;
    }
    ASSERT_TRUE(await([&](const nlohmann::json& now) { return now["engines"] == lost + 2 && now["force_N"] > 0.3; }))
        << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
  }
  EXPECT_EQ(engine.id(), process);
  EXPECT_FALSE(engine.hasEnded());
  EXPECT_GE(answered, 9U);
  EXPECT_EQ(status()["undoable"], answered);
  // What was undone before the device was lost can be redone after.
  expectSuccess(ctl({"save", "all.vdb"}));
  for (int i = 0; i < 3; ++i) expectSuccess(ctl({"undo"}));
  loses.next();
  expectSuccess(ctl({"render", "between.png", "--width", "64", "--height", "48"}));  // by the next engine
  ASSERT_TRUE(await([&](const nlohmann::json& now) { return now["engines"] == 5 && now["force_N"] > 0.3; }))
      << contentsOf(file("serve.log"));
  EXPECT_EQ(status()["redoable"], 3);
  for (int i = 0; i < 3; ++i) expectSuccess(ctl({"redo"}));
  expectSuccess(ctl({"save", "again.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("again.vdb").string())), contentHash(loadVolume(file("all.vdb").string())));
  EXPECT_GT(status()["tick"], tick);  // the very same loop
  expectSuccess(ctl({"render", "after.png", "--width", "64", "--height", "48"}));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("the engine is made anew from the volume with its edits"));
}

// Another program has taken the device's memory, for a moment. What cannot be is refused, and the service goes on; an
// engine that must be made anew is tried again.
TEST_F(LostDevice, MemoryThatIsNotThereForAMomentEndsNothing) {
  const LosesDevices loses(folder());
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=1mm:at=-12,-12,-12mm"}));
  loses.noMemory();
  expectRefusal(ctl({"filter", "gaussian:1"}), "", "left for it (", 5);
  EXPECT_TRUE(loses.isDone());
  EXPECT_EQ(ctl({"get", "filter"}).out, "filter = \n");
  loses.nextWithoutMemory();
  expectSuccess(ctl({"render", "between.png", "--width", "64", "--height", "48"}));  // by the next engine
  EXPECT_TRUE(loses.isDone());
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("left for it ("));
  expectSuccess(ctl({"edit", "add:radius=1mm:at=12,-12,-12mm"}));
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"save", "both.vdb"}));
  for (const double x : {-12e-3, 12e-3}) EXPECT_GT(densityAt("both.vdb", Vec3(x, -12e-3, -12e-3)), 0);
  EXPECT_FALSE(engine.hasEnded());
}

// A kernel that does not end is waited for a minute (here it is said at once), and then the engine is made anew.
TEST_F(LostDevice, ADriverThatHangsIsLeft) {
  const LosesDevices loses(folder());
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  loses.hangs();
  for (int edits = 0; edits < 5 && !loses.isDone(); ++edits)
    static_cast<void>(ctl({"edit", "add:radius=2mm:at=12,-12,-12mm"}));
  EXPECT_TRUE(loses.isDone());
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["engines"] == 2; })) << contentsOf(file("serve.log"));
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("a kernel did not finish within 60 s"));
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_GT(densityAt("back.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
  EXPECT_FALSE(engine.hasEnded());
}

// With nobody there the next edit meets the failure; it is not lost either, as it was not answered.
TEST_F(LostDevice, ADeviceThatIsLostForGoodEndsTheService) {
  const LosesDevices loses(folder());
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  for (int lost = 0; lost < 30 && !engine.hasEnded(); ++lost) {
    loses.next();
    static_cast<void>(ctl({"edit", "add:radius=2mm:at=12,-12,-12mm"}));
  }
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(engine.hasEnded());
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("its device has failed again and again"));
  loses.noMore();
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  // What was answered is there. Whether it can be undone depends on how long edits took: a checkpoint may hold it.
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_GT(densityAt("back.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
}

// Nothing is left of the object: engines are made of that, too, and undo brings it back.
TEST_F(LostDevice, AnEngineIsMadeOfNothing) {
  const LosesDevices loses(folder());
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"edit", "remove:radius=40mm:at=0,0,0"}));
  loses.next();
  expectSuccess(ctl({"render", "nothing.png", "--width", "64", "--height", "48"}));
  expectSuccess(ctl({"filter", "gaussian:1"}));
  EXPECT_EQ(status()["engines"], 3);
  expectSuccess(ctl({"filter", ""}));
  expectSuccess(ctl({"undo"}));
  expectSuccess(ctl({"save", "again.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("again.vdb").string())), contentHash(loadVolume(kServedSphere)));
}

}  // namespace lost_device_test
}  // namespace palpate
