// SPDX-License-Identifier: Apache-2.0
// The volume that a session saves while edits go on, against the CPU twin; and errands that need every edit.
#include <atomic>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/reference/edit.hpp"
#include "sample_session.hpp"

namespace palpate {
namespace session_saves_test {

using ::testing::HasSubstr;

// Two hundred edits with a save due after each of them: every file is the volume at one edit version, the one that it
// names, bit for bit what the twin's replay of so many edits gives.
TEST(SessionSaves, EverySaveIsTheVolumeAtOneVersion) {
  Session s;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> saved;  // version, content
  const auto write = [&](const Volume& volume, std::uint64_t version) {
    saved.emplace_back(version, contentHash(volume));
    return std::uint64_t{0};
  };
  s.session.keepSaved(s.volume, write, 1);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 10);
  Volume twin = sampleVolume();
  std::vector<std::uint64_t> contents = {contentHash(twin)};
  std::int64_t now_ns = 0;
  for (int i = 0; i < 200; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, now_ns);
    now_ns += 1'500'000'000;
    s.session.feedSaver(now_ns);
    reference::applyEdits(twin, lowerEdits(commands, twin.size(), twin.lattice(), s.header.profile));
    contents.push_back(contentHash(twin));
  }
  s.session.close();
  EXPECT_GE(saved.size(), 2U);
  for (const auto& [version, content] : saved) EXPECT_EQ(content, contents[version]) << "edit " << version;
  EXPECT_EQ(saved.back().first, 200U);
  EXPECT_EQ(s.session.figures().saves.version, 200U);
  EXPECT_EQ(contentHash(s.volume), contents.back());  // given back, with every edit in it
  EXPECT_EQ(s.engine.readBack(s.volume), 0U);
}

// Edits that change more bricks than are handed over at once: the parts are taken while further edits come in between,
// and still no save begins before all of them are there.
TEST(SessionSaves, ASaveInPartsIsTheVolumeAtOneVersion) {
  const Vec3i size(96, 96, 96);
  Volume volume = sampleVolume(8, size), twin = sampleVolume(8, size);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, 0);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> saved;
  const auto write = [&](const Volume& now, std::uint64_t version) {
    saved.emplace_back(version, contentHash(now));
    return std::uint64_t{0};
  };
  session.keepSaved(volume, write, 1);
  std::vector<std::uint64_t> contents = {contentHash(twin)};
  std::int64_t now_ns = 0;
  std::size_t most_left = 0;
  for (int i = 0; i < 24; ++i) {
    EditCommand command;
    command.kind = i % 3 == 2 ? EditKind::kRemove : EditKind::kAdd;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3(20 + 5 * (i % 12), 48, 70 - 4 * (i % 9)));
    command.radius_m = i % 4 == 0 ? 30e-3 : 3e-3;
    session.edit({&command, 1}, now_ns);
    reference::applyEdits(twin, lowerEdits({&command, 1}, size, twin.lattice(), header.profile));
    contents.push_back(contentHash(twin));
    session.feedSaver(now_ns += 700'000'000);
    most_left = std::max(most_left, engine.changedBricks());
    session.saver()->wait();
  }
  for (int i = 0; i < 20; ++i) {
    session.feedSaver(now_ns += 700'000'000);
    session.saver()->wait();
  }
  const std::size_t beside = saved.size();
  session.close();
  EXPECT_GT(most_left, 0U) << "every edit was handed over whole";
  EXPECT_GE(beside, 2U);
  for (const auto& [version, content] : saved) EXPECT_EQ(content, contents[version]) << "edit " << version;
  EXPECT_EQ(saved.back().first, 24U);
  EXPECT_EQ(contentHash(volume), contents.back());
}

// What is asked for is done with all the edits that were made before, in its order, beside edits that go on; what is
// left is done at the end. A failure is told and stops nothing.
TEST(SessionSaves, ErrandsHaveEveryEditMadeBefore) {
  Session s;
  s.session.keepSaved(s.volume, {}, 0);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 14);
  std::vector<std::uint64_t> contents = {contentHash(sampleVolume())};
  Volume twin = sampleVolume();
  std::vector<std::pair<int, std::uint64_t>> done;  // number, version
  std::vector<std::uint64_t> seen;
  std::vector<std::uint64_t> asked_at;
  for (int i = 0; i < 60; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
    reference::applyEdits(twin, lowerEdits(commands, twin.size(), twin.lattice(), s.header.profile));
    contents.push_back(contentHash(twin));
    if (i % 7 == 3) {
      asked_at.push_back(s.engine.editVersion());
      s.session.ask([&, n = static_cast<int>(asked_at.size()) - 1](const Volume& volume, std::uint64_t version) {
        done.emplace_back(n, version);
        seen.push_back(contentHash(volume));
        if (n == 2) throw std::runtime_error("a full disk");
      });
    }
    s.session.feedSaver(i);
  }
  s.session.close();
  ASSERT_EQ(done.size(), asked_at.size());
  for (std::size_t i = 0; i < done.size(); ++i) {
    EXPECT_EQ(done[i].first, static_cast<int>(i));
    EXPECT_GE(done[i].second, asked_at[i]);
    EXPECT_EQ(seen[i], contents[done[i].second]) << i;
  }
  EXPECT_EQ(s.session.saver()->takeFailures(), std::vector<std::string>{"a full disk"});
  EXPECT_EQ(s.session.figures().saves.failures, 0U);  // an errand is no save
  EXPECT_FALSE(s.session.figures().saves.version.has_value());
  EXPECT_EQ(contentHash(s.volume), contents.back());
}

// Each edit changes more bricks than a look hands over, and each look comes after an edit: saves are made all the same.
TEST(SessionSaves, EditsWithoutEndDoNotPutASaveOff) {
  const Vec3i size(96, 96, 96);
  Volume volume = sampleVolume(8, size);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, 0);
  int saves = 0;
  session.keepSaved(
      volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 1);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 20; ++i) {
    EditCommand command;
    command.kind = i % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3(46 + i % 5, 48, 48));
    command.radius_m = 30e-3;
    EXPECT_GT(session.edit({&command, 1}, now_ns).changed_bricks, 2U * 256);
    session.feedSaver(now_ns += 700'000'000);
    session.saver()->wait();
  }
  EXPECT_GE(saves, 2);
}

// Many bricks wait when a long write is done, and the next save is due: each look takes 256 of them and as many as the
// edit before it changed, no more, and the save is made.
TEST(SessionSaves, WhatWaitsForADueSaveIsHandedOverInParts) {
  Volume volume = sampleVolume(8, {96, 96, 96});
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, 0);
  std::mutex door;
  std::atomic<int> begun = 0;
  std::unique_lock closed(door);
  const auto write = [&](const Volume&, std::uint64_t) {
    ++begun;
    const std::lock_guard open(door);
    return std::uint64_t{1};
  };
  session.keepSaved(volume, write, 1);
  std::int64_t now_ns = 0;
  const auto changed = [&] { return engine.changedBricks(); };
  const auto edit = [&](double radius_m, int i) {
    EditCommand command;
    command.kind = i % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3(46 + i % 5, 48, 48));
    command.radius_m = radius_m;
    session.edit({&command, 1}, now_ns);
  };
  for (int i = 0; begun == 0; ++i) {
    edit(3e-3, i);
    session.feedSaver(now_ns += 1'500'000'000);
  }
  edit(60e-3, 0);
  session.feedSaver(now_ns += 1'500'000'000);
  ASSERT_GT(changed(), 1024U);
  closed.unlock();
  session.saver()->wait();
  for (int i = 0; i < 20; ++i) {
    const std::size_t before = changed();
    edit(3e-3, i);
    const std::size_t listed = changed();
    session.feedSaver(now_ns += 1'500'000'000);
    EXPECT_LE(listed - changed(), 256 + (listed - before)) << i;
    session.saver()->wait();
  }
  EXPECT_GE(begun, 2);
}

// An edit beside the volume counts, but the file holds the volume at its version already.
TEST(SessionSaves, AnEditThatReachesNothingIsNotSaved) {
  Session s;
  int saves = 0;
  s.session.keepSaved(
      s.volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 1);
  std::int64_t now_ns = 0;
  EditCommand command = dab(0);
  command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
  EditCommand away = dab(0);
  away.from_W = away.to_W = s.volume.lattice().toWorld({-15, 10, 9});  // 10 mm from the volume
  s.session.edit({&command, 1}, 0);
  for (int i = 0; i < 20; ++i) {
    s.session.feedSaver(now_ns += 1'500'000'000);
    s.session.saver()->wait();
    s.session.edit({&away, 1}, now_ns);
  }
  EXPECT_EQ(saves, 1);
  s.session.close();
  EXPECT_EQ(saves, 1);
  EXPECT_EQ(s.session.figures().saves.version, 21U);
}

// A save stands still for as long as the test likes: edits are applied, windows published and looks taken all the
// same, no second save is begun, and what changed meanwhile is in the next one.
TEST(SessionSaves, EditsGoOnDuringASlowSave) {
  Session s;
  std::mutex door;
  std::atomic<int> begun = 0;
  std::unique_lock closed(door);
  const auto write = [&](const Volume& volume, std::uint64_t) {
    ++begun;
    const std::lock_guard open(door);
    return contentHash(volume);
  };
  s.session.keepSaved(s.volume, write, 1);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 12);
  std::int64_t now_ns = 0;
  const auto edit = [&] {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, now_ns);
    now_ns += 1'500'000'000;
    s.session.feedSaver(now_ns);
  };
  while (begun == 0) edit();
  const std::uint64_t before = s.engine.editVersion();
  for (int i = 0; i < 100; ++i) edit();
  EXPECT_EQ(s.engine.editVersion(), before + 100);  // the save has not ended: it needs the door
  EXPECT_EQ(begun, 1);
  EXPECT_TRUE(s.session.figures().saves.seconds.empty());
  closed.unlock();
  s.session.close();
  EXPECT_EQ(begun, 2);  // the one of the end; nothing was queued
  const SaveFigures saves = s.session.figures().saves;
  EXPECT_EQ(saves.version, s.engine.editVersion());
  EXPECT_EQ(saves.bytes, contentHash(s.volume));
}

TEST(SessionSaves, WithoutAPeriodItIsSavedOnceAtTheEnd) {
  Session s;
  int saves = 0;
  s.session.keepSaved(
      s.volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 0);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 14);
  for (int i = 0; i < 20; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
    s.session.feedSaver(i * std::int64_t{1'000'000'000'000});
  }
  s.session.close();
  s.session.close();
  EXPECT_EQ(saves, 1);
}

// The first look begins the first period of 1.5 s, each save another one. A save that was due while nothing had changed
// begins with the first look after a change. A save that failed is tried again a period later, though nothing changed.
TEST(SessionSaves, SavesAreDueAPeriodApart) {
  std::vector<std::uint64_t> tried;
  bool full = false;
  Session s;
  const auto write = [&](const Volume&, std::uint64_t version) -> std::uint64_t {
    tried.push_back(version);
    if (full) throw Error(Error::Code::kIo, "file", "the disk is full", "make room");
    return 1;
  };
  s.session.keepSaved(s.volume, write, 1.5);
  const auto look = [&](std::int64_t now_ns) {
    s.session.feedSaver(now_ns);
    s.session.saver()->wait();
    return tried.size();
  };
  double radius_m = 1e-3;
  const auto edit = [&] {
    EditCommand command = dab(0);
    command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
    command.radius_m = radius_m += 0.5e-3;
    EXPECT_GT(s.session.edit({&command, 1}, 0).changed_bricks, 0U);
  };
  edit();
  EXPECT_EQ(look(5'000'000'000), 0U);
  EXPECT_EQ(look(6'499'999'999), 0U);
  EXPECT_EQ(look(6'500'000'000), 1U);
  edit();
  EXPECT_EQ(look(7'999'999'999), 1U);
  EXPECT_EQ(look(8'000'000'000), 2U);
  EXPECT_EQ(look(20'000'000'000), 2U);
  edit();
  EXPECT_EQ(look(20'000'000'001), 3U);
  edit();
  full = true;
  EXPECT_EQ(look(30'000'000'000), 4U);
  EXPECT_EQ(s.session.figures().saves.version, 3U);
  full = false;
  EXPECT_EQ(look(31'499'999'999), 4U);
  EXPECT_EQ(look(31'500'000'000), 5U);
  EXPECT_EQ(s.session.figures().saves.version, 4U);
  EXPECT_EQ(s.session.figures().saves.failures, 1U);
  EXPECT_THAT(tried, testing::ElementsAre(1, 2, 3, 4, 4));
}

// There is a file at the end in any case.
TEST(SessionSaves, WithoutAnEditTheVolumeIsSavedAtTheEnd) {
  std::vector<std::uint64_t> saved;
  Session s;
  const auto write = [&](const Volume& volume, std::uint64_t version) {
    saved.push_back(version);
    return contentHash(volume);
  };
  s.session.keepSaved(s.volume, write, 1);
  s.session.close();
  EXPECT_THAT(saved, testing::ElementsAre(0));
  EXPECT_EQ(s.session.figures().saves.version, 0U);
  EXPECT_EQ(s.session.figures().saves.bytes, s.header.volume.content);
}

TEST(SessionSaves, WhatDidNotChangeIsNotSavedAgain) {
  Session s;
  int saves = 0;
  s.session.keepSaved(
      s.volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 1);
  std::int64_t now_ns = 0;
  const auto look = [&] {
    for (int i = 0; i < 20; ++i) {
      s.session.feedSaver(now_ns += 1'500'000'000);
      s.session.saver()->wait();
    }
  };
  look();
  EXPECT_EQ(saves, 0);
  EditCommand command = dab(0);
  command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
  s.session.edit({&command, 1}, 0);
  look();
  EXPECT_EQ(saves, 1);
  s.session.close();
  EXPECT_EQ(saves, 1);
}

}  // namespace session_saves_test
}  // namespace palpate
