// SPDX-License-Identifier: Apache-2.0
// `palpate serve`, `servo` and `top`: processes that come, stand still and go, and devices that are lost.
#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "base/atomic_file.hpp"
#include "base/descriptor.hpp"
#include "engine/journal/journal_format.hpp"
#include "served_sphere.hpp"
#include "service/messages/message_channel.hpp"
#include "tests/support/small_disk.hpp"

namespace palpate {
namespace serve_failures_test {

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

class ServeFailures : public ServedSphere {
 protected:
  // In the file of what was set, wherever the journal lies.
  [[nodiscard]] bool isKept(const std::string& words) const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder()))
      if (entry.path().filename() == "settings.json" && contentsOf(entry.path()).find(words) != std::string::npos)
        return true;
    return false;
  }
  [[nodiscard]] bool awaitKept(const std::string& words) const {
    for (int look = 0; look < 200; ++look) {
      if (isKept(words)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
};

// Ten edits were answered, and the third is damaged: the service says what is missing wherever one may look, and keeps
// the file.
TEST_F(ServeFailures, SaysWhatAJournalHasLost) {
  serve({kServedSphere, "--journal", "journal"});
  ASSERT_TRUE(awaitService());
  for (int n = 0; n < 10; ++n) expectSuccess(ctl({"edit", fmt::format("add:radius=2mm:at={},-12,-12mm", n - 12)}));
  engine.end(SIGKILL);
  const std::filesystem::path file_of_journal = journalFile(file("journal"));
  std::string bytes = contentsOf(file_of_journal);
  const std::string third = recordBytes(RecordKind::kEdit, 3, "").substr(4, 12);  // its kind and its number
  const std::size_t at = bytes.find(third);
  ASSERT_NE(at, std::string::npos);
  bytes[at + 20] = static_cast<char>(bytes[at + 20] ^ 1);
  std::ofstream(file_of_journal, std::ios::binary) << bytes;

  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  EXPECT_EQ(recovered.status, 4);
  EXPECT_THAT(recovered.out, HasSubstr("is damaged: 8 records in"));
  serve({kServedSphere, "--journal", "journal"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["lost_records"], 8);
  EXPECT_EQ(status()["journal_failed"], 0);
  EXPECT_EQ(status()["undoable"], 2);
  const std::string log = contentsOf(file("serve.log"));
  EXPECT_THAT(log, HasSubstr("is damaged: 8 records in"));
  EXPECT_THAT(log, HasSubstr("kept as journal/journal-unread-1.palpate"));
  EXPECT_THAT(run({"top", "--count", "1"}).out, HasSubstr("  -8  "));
  EXPECT_EQ(contentsOf(file("journal/journal-unread-1.palpate")), bytes);
  expectSuccess(ctl({"save", "served.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("served.vdb").string())), contentHash(loadVolume(file("back.vdb").string())));
  expectSuccess(ctl({"stop"}));
  EXPECT_EQ(contentsOf(file("journal/journal-unread-1.palpate")), bytes);
}

// 300 edits, a checkpoint of most of them, and damage near the journal's beginning: the checkpoint and what follows it
// come back, again after another kill, and new edits with them.
TEST_F(ServeFailures, GoesOnFromACheckpointBeyondTheDamage) {
  serve({"phantom:sphere?size=96", "--journal", "journal"});
  ASSERT_TRUE(awaitService());
  std::vector<std::string> edits;
  for (int n = 0; n < 300; ++n) edits.push_back(fmt::format("add:radius=6mm:at={},{},-30mm", n % 20 - 10, n / 20 - 8));
  int made = 0;
  const auto isThere = [&] { return std::filesystem::exists(file("journal/checkpoint-0.palpate")); };
  for (; made < 300 && !(isThere() && made >= 40); made += 10)
    for (int n = 0; n < 10; ++n) expectSuccess(ctl({"edit", edits[static_cast<std::size_t>(made + n)]}));
  ASSERT_TRUE(isThere()) << "no checkpoint after " << made << " edits";
  expectSuccess(ctl({"save", "before.vdb"}));
  engine.end(SIGKILL);
  const std::filesystem::path file_of_journal = journalFile(file("journal"));
  std::string bytes = contentsOf(file_of_journal);
  const std::size_t at = bytes.find(recordBytes(RecordKind::kEdit, 10, "").substr(4, 12));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 20] = static_cast<char>(bytes[at + 20] ^ 1);
  std::ofstream(file_of_journal, std::ios::binary) << bytes;
  std::uint64_t content = contentHash(loadVolume(file("before.vdb").string()));
  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  EXPECT_THAT(recovered.out, HasSubstr("A checkpoint has the edits up to record"));
  EXPECT_EQ(contentHash(loadVolume(file("back.vdb").string())), content);
  // Each start goes on from the last one's journal, which begins with bricks, and from the checkpoint that it wrote.
  for (int start = 0; start < 4; ++start) {
    serve({"phantom:sphere?size=96", "--journal", "journal"});
    ASSERT_TRUE(awaitService());
    EXPECT_EQ(status()["lost_records"], 0);
    expectSuccess(ctl({"save", "after.vdb"}));
    EXPECT_EQ(contentHash(loadVolume(file("after.vdb").string())), content) << start;
    for (int n = 0; n < 10; ++n)
      expectSuccess(ctl({"edit", fmt::format("add:radius=6mm:at={},{},30mm", 2 * n - 10, 3 * start)}));
    expectSuccess(ctl({"save", "more.vdb"}));
    content = contentHash(loadVolume(file("more.vdb").string()));
    engine.end(SIGKILL);
  }
  EXPECT_EQ(contentsOf(file("journal/journal-unread-1.palpate")), bytes);
}

// Edits that find their journal gone are not answered as kept. It begins anew, says so, and after a kill all are there,
// those before and those after.
TEST_F(ServeFailures, AJournalThatIsRemovedBeginsAnew) {
  serve({kServedSphere, "--journal", "journal"});
  ASSERT_TRUE(awaitService());
  for (int n = 0; n < 3; ++n) expectSuccess(ctl({"edit", fmt::format("add:radius=2mm:at={},-12,-12mm", n - 12)}));
  std::filesystem::remove_all(file("journal"));
  const Outcome edited = ctl({"edit", "add:radius=2mm:at=-6,-12,-12mm"});
  EXPECT_EQ(edited.status, 4);
  EXPECT_THAT(edited.err, HasSubstr("the edit was made, but it is not on the disk"));
  ASSERT_TRUE(awaitSaid("is kept again"));
  EXPECT_EQ(status()["journal_failed"], 0);
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-3,-12,-12mm"}));
  EXPECT_EQ(status()["undoable"], 5);
  for (int undone = 0; undone < 3; ++undone) expectSuccess(ctl({"undo"}));  // more than the new journal has
  expectSuccess(ctl({"redo"}));
  expectSuccess(ctl({"save", "before.vdb"}));
  EXPECT_TRUE(await([](const nlohmann::json& now) { return now["journal_failed"] == 0; }));
  const Descriptor lock(open(file("journal/in-use").c_str(), O_RDWR | O_CLOEXEC));
  EXPECT_NE(flock(lock.get(), LOCK_EX | LOCK_NB), 0) << "another service may begin there";
  engine.end(SIGKILL);
  serve({kServedSphere, "--journal", "journal"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["lost_records"], 0);
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("back.vdb").string())), contentHash(loadVolume(file("before.vdb").string())));
}

// A disk that gets full, then has room, then is too full for the next start to write its edits down again.
TEST_F(ServeFailures, AJournalOnAFullDiskBeginsAnewWhenThereIsRoom) {
  const SmallDisk disk(file("disk"));
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  serve({kServedSphere, "--journal", "disk/journal"});
  ASSERT_TRUE(awaitService());
  int made = 0;
  const auto makeEdit = [&] {
    ++made;
    return ctl({"edit", fmt::format("add:radius=2mm:at=-12,{},{}mm", made % 24 - 12, made / 24 - 12)});
  };
  expectSuccess(makeEdit());
  disk.fill();
  // What is left of a page is room for some.
  while (made < 60 && makeEdit().status == 0) continue;
  ASSERT_LT(made, 60);
  EXPECT_EQ(status()["journal_failed"], 1);
  EXPECT_EQ(makeEdit().status, 4);
  disk.makeRoom();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["journal_failed"] == 0; }));
  expectSuccess(makeEdit());
  expectSuccess(ctl({"save", "before.vdb"}));
  engine.end(SIGKILL);
  serve({kServedSphere, "--journal", "disk/journal"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(status()["lost_records"], 0);
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("back.vdb").string())), contentHash(loadVolume(file("before.vdb").string())));
  engine.end(SIGKILL);
}

// There is no room to write the edits of before down again: their journal counts until there is.
TEST_F(ServeFailures, AStartOnAFullDiskLosesNothing) {
  const SmallDisk disk(file("disk"));
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  serve({kServedSphere, "--journal", "disk/journal"});
  ASSERT_TRUE(awaitService());
  for (int n = 0; n < 120; ++n)
    expectSuccess(ctl({"edit", fmt::format("add:radius=2mm:at=-12,{},{}mm", n % 24 - 12, n / 24 - 12)}));
  expectSuccess(ctl({"save", "before.vdb"}));
  engine.end(SIGKILL);
  for (const bool has_room : {false, true}) {
    if (has_room) std::filesystem::remove(file("disk/journal/journal.palpate"));  // begun, and of no use to the next
    disk.fill(8192);
    serve({kServedSphere, "--journal", "disk/journal"});
    ASSERT_TRUE(awaitService()) << contentsOf(file("serve.log"));
    EXPECT_EQ(status()["journal_failed"], 1) << contentsOf(file("serve.log"));
    if (has_room) {
      disk.makeRoom();
      ASSERT_TRUE(await([](const nlohmann::json& now) { return now["journal_failed"] == 0; }));
      expectSuccess(ctl({"edit", "add:radius=2mm:at=12,12,12mm"}));
      EXPECT_FALSE(exists("disk/journal/earlier"));
    }
    expectSuccess(ctl({"save", has_room ? "before.vdb" : "back.vdb"}));
    engine.end(SIGKILL);
    if (!has_room) {
      EXPECT_EQ(contentHash(loadVolume(file("back.vdb").string())),
                contentHash(loadVolume(file("before.vdb").string())));
    }
  }
  serve({kServedSphere, "--journal", "disk/journal"});
  ASSERT_TRUE(awaitService());
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("back.vdb").string())), contentHash(loadVolume(file("before.vdb").string())));
  engine.end(SIGKILL);
}

// Killed in the middle of its work: what was answered comes back, and the servo, which lived on, takes up its contact.
TEST_F(ServeFailures, AKilledEngineComesBackWithItsEdits) {
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1"});
  join();
  ASSERT_TRUE(awaitServo());
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  const double tick = status()["tick"];
  engine.end(SIGKILL);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(servo.hasEnded());
  serveFromTheJournal({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1"});
  ASSERT_TRUE(await([&](const nlohmann::json& now) { return now["servo"] == 1 && now["force_N"] > 0.3; }))
      << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
  EXPECT_GT(status()["tick"], tick);  // the very same loop
  expectSuccess(ctl({"save", "back.vdb"}));
  EXPECT_GT(densityAt("back.vdb", Vec3(-12, -12, -12) * 1e-3), 0);
  expectSuccess(ctl({"undo"}));  // the edit can be undone by the next engine too
  EXPECT_THAT(contentsOf(file("servo.log")), HasSubstr("the force fades"));
}

// The scene's isovalue is felt, also where the edits from before began with another one.
TEST_F(ServeFailures, AnotherIsovalueInTheSceneIsTaken) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  const std::string first = ctl({"get", "isovalue"}).out;
  const double isovalue = std::stod(first.substr(first.find('=') + 1)) + 20;
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  expectSuccess(ctl({"export", "first.stl"}));
  engine.end(SIGKILL);
  serveFromTheJournal({kServedSphere, "--iso", fmt::format("{}", isovalue)});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(ctl({"get", "isovalue"}).out, fmt::format("isovalue = {}\n", isovalue));
  expectSuccess(ctl({"set", "isovalue", fmt::format("{}", isovalue)}));  // answered when it is felt
  expectSuccess(ctl({"export", "second.stl"}));
  EXPECT_NE(contentsOf(file("first.stl")), contentsOf(file("second.stl")));
  expectSuccess(ctl({"undo"}));
  // Where what is on the device serves one alone, it is that of the edits, and told.
  expectSuccess(ctl({"redo"}));
  engine.end(SIGKILL);
  serve({kServedSphere, "--iso", fmt::format("{}", isovalue), "--samples", "half"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(ctl({"get", "isovalue"}).out, first);
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("serve that one alone"));
}

// A chain that is felt no more as soon as another one is ready is asked for again meanwhile: the last word counts.
TEST_F(ServeFailures, TheLastFiltersCount) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  MessageChannel client(connectTo((file("run") / "palpate/service.sock").string()), "the service");
  std::uint64_t number = 0;
  const auto askFor = [&](const std::string& chain) {
    wire::AskT ask = asking(wire::Verb::Filter);
    ask.number = ++number;
    ask.words = {chain};
    client.send(std::move(ask));
    return number;
  };
  const auto answer = [&] { return client.expect<wire::AnswerT>(60'000).first; };
  const std::uint64_t first = askFor("gaussian:1");
  bool first_is_answered = false, second_is_done = false;
  while (!second_is_done) {
    const std::uint64_t second = askFor("");
    for (bool heard = false; !heard;) {
      const wire::AnswerT one = answer();
      if (one.number == first) first_is_answered = true;
      heard = one.number == second;
      second_is_done = heard && !one.refusal;
    }
  }
  if (!first_is_answered) {
    EXPECT_EQ(answer().number, first);
  }
  EXPECT_EQ(ctl({"get", "filter"}).out, "filter = \n");
  EXPECT_GE(status()["engines"], 3);
}

// Filters from before a crash for which there is no memory any more: it begins without them, and says so.
TEST_F(ServeFailures, FiltersThatCannotBeMadeAgainKeepNobodyOut) {
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

// Killed, too: what was set is set again, but for what the user has changed in the scene. A stop in good order forgets.
TEST_F(ServeFailures, WhatWasSetOutlivesAKill) {
  const auto gets = [this](const std::string& key) { return ctl({"get", key}).out; };
  writePress();
  const Words scene = {kServedSphere, "--path", "press.csv"};
  serve(scene + Words{"--force-limit", "2"});
  join();
  ASSERT_TRUE(awaitServo());
  const std::string first = gets("isovalue");
  const double isovalue = std::stod(first.substr(first.find('=') + 1));
  expectSuccess(ctl({"set", "isovalue", fmt::format("{}", isovalue + 10)}));
  const std::string isovalue_set = gets("isovalue");
  EXPECT_NE(isovalue_set, first);
  expectSuccess(ctl({"set", "servo.stiffness_N_per_m", "432"}));
  expectSuccess(ctl({"set", "safety.force_limit_N", "1"}));
  expectSuccess(ctl({"filter", "gaussian:1"}));
  ASSERT_TRUE(awaitKept("gaussian:1"));
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 1 && now["tick"] > 0; }));
  const double tick = status()["tick"];
  engine.end(SIGKILL);
  serve(scene + Words{"--force-limit", "2"});
  ASSERT_TRUE(awaitServo());
  EXPECT_GT(status()["tick"], tick) << "the very same loop";
  EXPECT_EQ(gets("safety.force_limit_N"), "safety.force_limit_N = 1\n");
  engine.end(SIGKILL);
  serve(scene + Words{"--force-limit", "2.5"});
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(gets("servo.stiffness_N_per_m"), "servo.stiffness_N_per_m = 432\n");
  EXPECT_EQ(gets("safety.force_limit_N"), "safety.force_limit_N = 2.5\n");
  EXPECT_EQ(gets("filter"), "filter = gaussian:1\n");
  EXPECT_EQ(gets("isovalue"), isovalue_set);
  EXPECT_THAT(contentsOf(file("serve.log")), HasSubstr("settings from before are taken again: "));
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_FALSE(isKept("gaussian:1"));
  serve(scene);
  ASSERT_TRUE(awaitService());
  EXPECT_EQ(gets("filter"), "filter = \n");
  EXPECT_EQ(gets("isovalue"), first);
}

// The servo is killed: the engine goes on, a new servo joins. A second one is turned away.
TEST_F(ServeFailures, ServosComeAndGo) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  join();
  ASSERT_TRUE(awaitServo());
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::ContainsRegex("\non +0 "));  // no rate before a second look
  RunningProgram second(PALPATE_PROGRAM, {"servo", "--connect"}, folder(), "second.log");  // to the usual socket
  EXPECT_TRUE(awaitSaid("a second servo (process "));
  EXPECT_TRUE(awaitSaid("the service: another servo touches its volume already", "second.log"))
      << contentsOf(file("second.log"));
  EXPECT_THAT(contentsOf(file("second.log")), testing::Not(HasSubstr("is gone")));
  EXPECT_EQ(status()["servos"], 1);
  servo.end(SIGKILL);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servos"] >= 2 && now["windows"] > 0; }));  // the second
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  EXPECT_EQ(WEXITSTATUS(second.end(SIGTERM)), 0);  // in good order
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 0; }));
  expectSuccess(ctl({"undo"}));
}

// Stopped and let go on, as by a debugger or a driver that hangs: no servo is lost, and no edit. The servo's log says
// why there is no force; the engine cannot.
TEST_F(ServeFailures, AStoppedEngineGoesOn) {
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; }));
  if (contentsOf(file("servo.log")).find("sends no windows") != std::string::npos)
    std::this_thread::sleep_for(std::chrono::seconds(11));  // a slow machine; it is told again after ten
  write("servo.log", "");
  engine.send(SIGSTOP);
  ASSERT_TRUE(awaitSaid("sends no windows", "servo.log"));
  engine.send(SIGCONT);
  EXPECT_TRUE(awaitSaid("sends windows again; they were stale for ", "servo.log"));
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; }));
  EXPECT_EQ(status()["servos"], 1);
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
}

// A terminal that closes takes no force away: the servo that was started in it goes on.
TEST_F(ServeFailures, AServoOutlivesAHangUp) {
  join();
  ASSERT_TRUE(awaitSaid("waiting for an engine", "servo.log"));
  killpg(servo.id(), SIGHUP);  // as the kernel sends it: to all of the terminal's group
  serve({kServedSphere});
  EXPECT_TRUE(awaitServo()) << contentsOf(file("servo.log"));
  killpg(servo.id(), SIGHUP);
  const double tick = status()["tick"];
  EXPECT_TRUE(await([&](const nlohmann::json& now) { return now["tick"] > tick; })) << contentsOf(file("servo.log"));
  EXPECT_FALSE(servo.hasEnded());
}

// A servo that stands still is there, but its pose grows old.
TEST_F(ServeFailures, AnOldPoseIsTold) {
  serve({kServedSphere});
  join();
  ASSERT_TRUE(awaitServo());
  servo.send(SIGSTOP);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["pose_age_ms"] > 500; }));
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::ContainsRegex("\non .* old "));
  servo.send(SIGCONT);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["pose_age_ms"] < 100; }));
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::Not(HasSubstr(" old ")));
}

// However long it takes: it says that it waits, and then it has its answer.
TEST_F(ServeFailures, AClientWaitsAndSaysSo) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  engine.send(SIGSTOP);
  RunningProgram client(PALPATE_PROGRAM, {"ctl", "get", "servo.n"}, folder(), "ctl.log");
  EXPECT_TRUE(awaitSaid("the service has not answered yet; Ctrl-C ends the wait", "ctl.log"));
  EXPECT_FALSE(client.hasEnded());
  engine.send(SIGCONT);
  EXPECT_TRUE(awaitSaid("servo.n = 5", "ctl.log"));
}

// A servo whose device is not there says so once, and does not flood the terminal.
TEST_F(ServeFailures, SaysOnceWhyThereIsNoServo) {
  serve({kServedSphere, "--device", "polhem-v1", "--current-limit", "3"});
  ASSERT_TRUE(awaitService());
  join();
  for (const char* log : {"serve.log", "servo.log"})
    ASSERT_TRUE(awaitSaid("none of this machine's HID devices is one", log)) << log;
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));  // it tries again
  for (const char* log : {"serve.log", "servo.log"}) {
    const std::string said = contentsOf(file(log));
    const std::size_t first = said.find("none of this machine's HID devices is one");
    EXPECT_NE(first, std::string::npos) << log << said;
    EXPECT_EQ(said.find("none of this machine's HID devices is one", first + 1), std::string::npos) << log << said;
  }
}

// What the device cannot bear is told when a servo joins, and to who sets it; an unstable contact, too, as it ends.
TEST_F(ServeFailures, WarnsOfWhatADeviceCannotBear) {
  serve({kServedSphere, "--hand", "spring", "--stiffness", "20000"});
  join();
  ASSERT_TRUE(awaitServo());
  EXPECT_TRUE(awaitSaid("a stiffness of 20000 N/m is more than this device can render"));
  EXPECT_TRUE(awaitSaid("the servo: unstable: ")) << contentsOf(file("serve.log"));
  const Outcome set = ctl({"set", "servo.stiffness_N_per_m", "30000"});
  expectSuccess(set);
  EXPECT_THAT(set.out, HasSubstr("servo.stiffness_N_per_m = 30000\na stiffness of 30000 N/m is more than"));
  EXPECT_EQ(ctl({"set", "servo.stiffness_N_per_m", "500"}).out, "servo.stiffness_N_per_m = 500\n");
}

// One command for both: whoever dies is started again, and the service ends with its engine's good end.
TEST_F(ServeFailures, IsSupervised) {
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1", "--supervise"});
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  const auto killChild = [&](const std::string& name) {
    const Outcome outcome = runPalpate({.arguments = {"-c", fmt::format("pkill -KILL -P {} -x {}", engine.id(), name)},
                                        .program = "/bin/sh",
                                        .folder = folder()});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  };
  killChild("palpate-servo");
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servos"] >= 2 && now["force_N"] > 0.3; }));
  killChild("palpate");
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["edits"] == 1 && now["force_N"] > 0.3; }))
      << contentsOf(file("serve.log"));
  EXPECT_THAT(ctl({"metrics"}).out, HasSubstr("palpate_servo 1\n"));
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(engine.hasEnded()) << contentsOf(file("serve.log"));
}

// The device is lost again and again, while a hand presses and clients edit: the engine is made anew in the same
// process, clients and servo stay, and what was answered is there.
TEST_F(ServeFailures, ALostDeviceIsMadeAnew) {
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
TEST_F(ServeFailures, MemoryThatIsNotThereForAMomentEndsNothing) {
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
TEST_F(ServeFailures, ADriverThatHangsIsLeft) {
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
TEST_F(ServeFailures, ADeviceThatIsLostForGoodEndsTheService) {
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
TEST_F(ServeFailures, AnEngineIsMadeOfNothing) {
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

// It says that the service has gone, and goes on with the next one.
TEST_F(ServeFailures, IsWatchedFromEngineToEngine) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  RunningProgram top(PALPATE_PROGRAM, {"top", "--every", "0.05"}, folder(), "top.log");
  const auto told = [&](const std::string& words, std::size_t times) {
    for (int look = 0; look < 1200; ++look) {
      const std::string text = contentsOf(file("top.log"));
      std::size_t found = 0;
      for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
      if (found >= times) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  };
  EXPECT_TRUE(told("off  ", 3)) << contentsOf(file("top.log"));
  join();
  EXPECT_TRUE(told("on   ", 3)) << contentsOf(file("top.log"));
  servo.end(SIGKILL);
  engine.end(SIGKILL);
  EXPECT_TRUE(told("has ended; Ctrl-C ends the wait", 1)) << contentsOf(file("top.log"));
  write("top.log", "");
  serve({kServedSphere});
  EXPECT_TRUE(told("off  ", 2)) << contentsOf(file("top.log"));
  engine.send(SIGSTOP);
  EXPECT_TRUE(told("does not answer", 1)) << contentsOf(file("top.log"));
  engine.send(SIGCONT);
  EXPECT_EQ(WEXITSTATUS(top.end(SIGINT)), 130);
}

// systemd hears when it is ready, what it serves, that it lives, and that it ends. One that stands still says nothing.
TEST_F(ServeFailures, TellsSystemdThatItLives) {
  const std::string path = file("notify.sock").string();
  const Descriptor inbox(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(inbox.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  setenv("WATCHDOG_USEC", "400000", 1);
  serve({kServedSphere});
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  std::vector<std::string> said;
  const auto listen = [&] {
    char message[512];
    for (ssize_t count = 0; (count = recv(inbox.get(), message, sizeof message, 0)) > 0;)
      said.emplace_back(message, static_cast<std::size_t>(count));
    return std::ranges::count(said, "WATCHDOG=1");
  };
  for (int look = 0; look < 1200 && listen() < 3; ++look) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_GE(said.size(), 5U);
  EXPECT_EQ(said[0], "READY=1");
  EXPECT_THAT(said[1], HasSubstr("STATUS=phantom:sphere?size=32 is served at "));
  engine.send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // what it said before has come
  const auto before = listen();
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  EXPECT_EQ(listen(), before);
  engine.send(SIGCONT);
  for (int look = 0; look < 1200 && listen() == before; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GT(listen(), before);
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  listen();
  EXPECT_EQ(said.back(), "STOPPING=1");
}

}  // namespace serve_failures_test
}  // namespace palpate
