// SPDX-License-Identifier: Apache-2.0
// What a service that was killed, or whose journal was lost or damaged, brings back, and what it says of the rest.
#include <fstream>

#include <fmt/format.h>
#include <sys/file.h>

#include "base/descriptor.hpp"
#include "engine/journal/journal_format.hpp"
#include "served_sphere.hpp"
#include "tests/support/small_disk.hpp"

namespace palpate {
namespace serve_journal_test {

using testing::HasSubstr;

class ServeJournal : public ServedSphere {
 protected:
  // "before.vdb" was saved; the journal is where the service keeps it.
  void expectAllBackAfterAKill(const std::string& journal) {
    engine.end(SIGKILL);
    serve({kServedSphere, "--journal", journal});
    ASSERT_TRUE(awaitService());
    EXPECT_EQ(status()["lost_records"], 0);
    expectSuccess(ctl({"save", "back.vdb"}));
    EXPECT_EQ(contentHash(loadVolume(file("back.vdb").string())), contentHash(loadVolume(file("before.vdb").string())));
  }
};

// Ten edits were answered, and the third is damaged: the service says what is missing wherever one may look, and keeps
// the file.
TEST_F(ServeJournal, SaysWhatAJournalHasLost) {
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
  EXPECT_THAT(log, HasSubstr(". 2 edits are back, 8 records are lost"));
  EXPECT_THAT(log, HasSubstr("kept as journal/journal-unread-1.palpate"));
  EXPECT_THAT(run({"top", "--count", "1"}).out, HasSubstr("  -8  "));
  EXPECT_EQ(contentsOf(file("journal/journal-unread-1.palpate")), bytes);
  expectSuccess(ctl({"save", "served.vdb"}));
  EXPECT_EQ(contentHash(loadVolume(file("served.vdb").string())), contentHash(loadVolume(file("back.vdb").string())));
  expectSuccess(ctl({"stop"}));
  EXPECT_EQ(contentsOf(file("journal/journal-unread-1.palpate")), bytes);
  // It can be read where it lies.
  const Outcome aside = run({"recover", "journal/journal-unread-1.palpate", "--out", "aside.vdb"});
  EXPECT_EQ(aside.status, 4);
  EXPECT_THAT(aside.err, HasSubstr("journal-unread-1.palpate is damaged: 8 records in"));
  EXPECT_EQ(contentHash(loadVolume(file("aside.vdb").string())), contentHash(loadVolume(file("back.vdb").string())));
}

// 300 edits, a checkpoint of most of them, and damage near the journal's beginning: the checkpoint and what follows it
// come back, again after another kill, and new edits with them.
TEST_F(ServeJournal, GoesOnFromACheckpointBeyondTheDamage) {
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
TEST_F(ServeJournal, AJournalThatIsRemovedBeginsAnew) {
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
  ASSERT_NO_FATAL_FAILURE(expectAllBackAfterAKill("journal"));
}

// A disk that gets full, then has room, then is too full for the next start to write its edits down again.
TEST_F(ServeJournal, AJournalOnAFullDiskBeginsAnewWhenThereIsRoom) {
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
  ASSERT_NO_FATAL_FAILURE(expectAllBackAfterAKill("disk/journal"));
  engine.end(SIGKILL);
}

// There is no room to write the edits of before down again: their journal counts until there is.
TEST_F(ServeJournal, AStartOnAFullDiskLosesNothing) {
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
TEST_F(ServeJournal, AKilledEngineComesBackWithItsEdits) {
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
TEST_F(ServeJournal, AnotherIsovalueInTheSceneIsTaken) {
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

// Killed, too: what was set is set again, but for what the user has changed in the scene. A stop in good order forgets.
TEST_F(ServeJournal, WhatWasSetOutlivesAKill) {
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

}  // namespace serve_journal_test
}  // namespace palpate
