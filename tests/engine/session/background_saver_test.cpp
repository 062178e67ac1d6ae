// SPDX-License-Identifier: Apache-2.0
// The saver alone, without a device: what it writes, that nobody waits for it, and that a failure ends nothing.
#include "engine/session/background_saver.hpp"

#include <condition_variable>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace background_saver_test {

using ::testing::HasSubstr;

// Made brick by brick by one thread: the thread sanitizer does not know how TBB's threads wait for each other.
Volume plainVolume() {
  return Volume::fromBricks({27, 22, 19}, sampleLattice(), {}, [](const Vec3i& brick, float* values) {
    std::fill_n(values, kBrickVoxels, static_cast<float>(brick.x()));
    return brick.y() != 1;
  });
}

// Every brick of the volume gets `value`; the third keeps 512 densities, so that both forms are taken in.
std::vector<BrickContent> bricksOf(const Volume& volume, float value) {
  std::vector<BrickContent> bricks;
  for (std::uint32_t brick = 0; brick < static_cast<std::uint32_t>(volume.brickCount().prod()); ++brick) {
    bricks.push_back({brick, std::vector<float>(brick == 2 ? kBrickVoxels : 1, value)});
  }
  return bricks;
}

bool allAre(const Volume& volume, float value) {
  const std::vector<float> dense = volume.toDense();
  return std::all_of(dense.begin(), dense.end(), [&](float v) { return v == value; });
}

// A door that a save stands at until it is opened.
class Door {
 public:
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    waiting_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_; });
  }
  void waitForVisitor() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false, waiting_ = false;
};

TEST(BackgroundSaver, WritesWhatItWasGivenUnderItsVersion) {
  Volume volume = plainVolume();
  std::vector<std::pair<std::uint64_t, bool>> written;
  BackgroundSaver saver(volume, [&](const Volume& now, std::uint64_t version) {
    written.emplace_back(version, allAre(now, static_cast<float>(version)));
    return version * 10;
  });
  for (const std::uint64_t version : {3U, 4U, 9U}) {
    saver.give(bricksOf(volume, static_cast<float>(version)), version);
    saver.wait();
  }
  saver.give(bricksOf(volume, 11), BackgroundSaver::Completes::kVersion);  // taken in, not saved
  saver.close();
  EXPECT_THAT(written, testing::ElementsAre(std::pair(3, true), std::pair(4, true), std::pair(9, true)));
  EXPECT_TRUE(allAre(volume, 11));
  const SaveFigures figures = saver.figures();
  EXPECT_EQ(figures.seconds.size(), 3U);
  EXPECT_EQ(figures.bytes, 90U);
  EXPECT_EQ(figures.version, 9U);
  EXPECT_EQ(saver.savedVersion(), 9U);
  EXPECT_EQ(figures.failures, 0U);
}

// While a save stands still, the giver is told that nothing is taken, at once, as often as it asks.
TEST(BackgroundSaver, TakesNothingWhileItWrites) {
  Volume volume = plainVolume();
  Door door;
  BackgroundSaver saver(volume, [&](const Volume&, std::uint64_t) {
    door.pass();
    return std::uint64_t{1};
  });
  EXPECT_TRUE(saver.ready());
  saver.give({}, 1);
  door.waitForVisitor();
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(saver.ready());
  EXPECT_TRUE(saver.takeFailures().empty());
  EXPECT_TRUE(saver.figures().seconds.empty());  // not on disk yet
  door.open();
  saver.wait();
  EXPECT_TRUE(saver.ready());
  EXPECT_EQ(saver.figures().version, 1U);
}

TEST(BackgroundSaver, AFailureLeavesTheOlderFileAndTheNextSaveSucceeds) {
  TemporaryFolder folder;
  const std::filesystem::path place = folder.path() / "place";
  const std::string file = (place / "a.nrrd").string();
  std::filesystem::create_directory(place);
  Volume volume = plainVolume();
  BackgroundSaver saver(volume, [&](const Volume& now, std::uint64_t) { return saveVolume(now, file); });
  const auto save = [&](std::uint64_t version) {
    saver.give(bricksOf(volume, static_cast<float>(version)), version);
    saver.wait();
  };
  save(1);
  const std::string first = contentsOf(file);
  {
    const FileSizeLimit limit(first.size() / 2);  // the disk is full
    save(2);
  }
  EXPECT_EQ(contentsOf(file), first);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(place), {}), 1);
  const std::vector<std::string> told = saver.takeFailures();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told[0], HasSubstr("edit 2 was not saved: " + file));
  EXPECT_THAT(told[0], HasSubstr("make room"));
  EXPECT_TRUE(saver.takeFailures().empty());  // once
  EXPECT_THAT(saver.figures().failure, HasSubstr("make room"));
  EXPECT_EQ(saver.figures().version, 1U);

  std::filesystem::rename(place, folder.path() / "elsewhere");  // the folder is gone
  save(3);
  const std::vector<std::string> gone = saver.takeFailures();
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_THAT(gone[0], HasSubstr("make the folder first"));
  EXPECT_EQ(contentsOf(folder.path() / "elsewhere" / "a.nrrd"), first);

  std::filesystem::rename(folder.path() / "elsewhere", place);
  save(4);
  EXPECT_TRUE(saver.takeFailures().empty());
  EXPECT_EQ(saver.figures().failures, 2U);
  EXPECT_EQ(saver.figures().failure, "");
  EXPECT_EQ(saver.figures().version, 4U);
  EXPECT_EQ(contentsOf(file).size(), first.size());
  EXPECT_NE(contentsOf(file), first);
}

TEST(BackgroundSaver, AFailureWithoutWordsIsNoSuccess) {
  struct Silent : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return ""; }
  };
  Volume volume = plainVolume();
  BackgroundSaver saver(volume, [&](const Volume&, std::uint64_t version) -> std::uint64_t {
    if (version == 1) throw Silent();
    if (version == 2) throw 2;
    return 1;
  });
  for (const std::uint64_t version : {1U, 2U}) {
    saver.give({}, version);
    saver.wait();
    EXPECT_EQ(saver.takeFailures().size(), 1U) << version;
    EXPECT_EQ(saver.figures().failures, version);
    EXPECT_FALSE(saver.figures().version) << version;
    EXPECT_FALSE(saver.savedVersion()) << version;
    EXPECT_NE(saver.figures().failure, "");
  }
  saver.give({}, 3);
  saver.wait();
  EXPECT_EQ(saver.figures().version, 3U);
  EXPECT_EQ(saver.figures().failure, "");
}

// A brick that cannot be taken in leaves the older file in peace: what is written afterwards would lack it.
TEST(BackgroundSaver, ACopyThatMissesABrickIsNeverWritten) {
  Volume volume = plainVolume();
  int written = 0;
  BackgroundSaver saver(volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++written); });
  saver.give(bricksOf(volume, 1), 1);
  saver.wait();
  saver.give({{0, {2.0F}}, {1, {}}, {2, {2.0F}}}, 2);
  saver.wait();
  const std::vector<std::string> told = saver.takeFailures();
  ASSERT_EQ(told.size(), 1U);
  EXPECT_THAT(told[0], HasSubstr("saved no more"));
  saver.give(bricksOf(volume, 3), 3);
  saver.close();
  EXPECT_TRUE(saver.takeFailures().empty());  // once
  EXPECT_EQ(written, 1);
  EXPECT_EQ(saver.figures().version, 1U);
  EXPECT_NE(saver.figures().failure, "");
}

// Where the giver could not read a brick, the copy lacks it: the same, with the giver's words.
TEST(BackgroundSaver, WhatIsGivenUpIsNeverWritten) {
  Volume volume = plainVolume();
  int written = 0;
  BackgroundSaver saver(volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++written); });
  saver.give(bricksOf(volume, 1), 1);
  saver.wait();
  saver.abandon("the device is gone");
  EXPECT_THAT(saver.takeFailures(), testing::ElementsAre("the volume is saved no more: "
                                                         "the copy of it to save is incomplete (the device is gone)"));
  EXPECT_EQ(saver.figures().failure, "the device is gone");
  EXPECT_EQ(saver.figures().failures, 1U);
  saver.give(bricksOf(volume, 2), 2);
  saver.close();
  EXPECT_EQ(written, 1);
  EXPECT_TRUE(allAre(volume, 1));
  EXPECT_EQ(saver.savedVersion(), 1U);
}

// One thread gives as fast as it may, the other writes: each save holds one version, all of it.
TEST(BackgroundSaver, NoSaveMixesVersions) {
  Volume volume = plainVolume();
  std::uint64_t mixed = 0;
  BackgroundSaver saver(volume, [&](const Volume& now, std::uint64_t version) {
    mixed += allAre(now, static_cast<float>(version)) ? 0 : 1;
    return version;
  });
  std::uint64_t given = 0;
  for (std::uint64_t version = 1; given < 200; ++version) {
    if (!saver.ready()) {  // edits go on: the next batch is newer
      std::this_thread::yield();
      continue;
    }
    ++given;
    std::vector<BrickContent> bricks = bricksOf(volume, static_cast<float>(version));
    given % 3 == 0 ? saver.give(std::move(bricks), version)
                   : saver.give(std::move(bricks), BackgroundSaver::Completes::kVersion);
  }
  saver.close();
  EXPECT_EQ(mixed, 0U);
  EXPECT_EQ(saver.figures().seconds.size(), 66U);
  EXPECT_EQ(saver.figures().saves, 66U);
}

// An exception whose words need more memory than a process at its limit gets.
struct WordyFailure : std::exception {
  static constexpr std::size_t kBytes = std::size_t{64} << 20;
  [[nodiscard]] const char* what() const noexcept override {
    static const std::vector<char> words = [] {
      std::vector<char> text(kBytes, 'x');
      text.back() = '\0';
      return text;
    }();
    return words.data();
  }
};

// Whoever looks at the words of the newest failure must find some: an empty text would mean that all is saved.
TEST(BackgroundSaver, AFailureWithoutMemoryForItsWordsIsTold) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs address space of its own";
#endif
  Volume volume = plainVolume();
  static_cast<void>(WordyFailure().what());  // made while there is room
  rlimit before = {};
  getrlimit(RLIMIT_AS, &before);
  BackgroundSaver saver(volume, [&](const Volume&, std::uint64_t) -> std::uint64_t {
    const rlimit none = {0, before.rlim_max};
    setrlimit(RLIMIT_AS, &none);
    throw WordyFailure();
  });
  saver.give({}, 1);
  saver.wait();
  setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(saver.figures().failures, 1U);
  EXPECT_EQ(saver.figures().failure, "out of memory");
  EXPECT_THAT(saver.takeFailures(), testing::ElementsAre(HasSubstr("saved no more")));
  EXPECT_THAT(saver.takeFailures(), testing::IsEmpty());
  saver.give({}, 2);  // and nothing more is tried
  saver.close();
  EXPECT_EQ(saver.figures().failures, 1U);
}

}  // namespace background_saver_test
}  // namespace palpate
