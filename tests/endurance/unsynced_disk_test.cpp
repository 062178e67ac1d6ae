// SPDX-License-Identifier: Apache-2.0
// The disk of the power cuts does lose what was not synced, and nothing else: else the test that uses it would prove
// nothing.
#include "unsynced_disk.hpp"

#include <algorithm>
#include <fstream>
#include <set>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace unsynced_disk_test {

namespace fs = std::filesystem;
using testing::IsSupersetOf;

class Disk : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder);
    write("old", std::string(2000, 'o'));
    disk_.emplace(folder, 3, 1, [this](UnsyncedDisk::Image image) { images_.push_back(std::move(image)); });
  }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
  }
  void sync(const std::string& name) const {
    const Descriptor file(open((folder / name).c_str(), O_RDONLY | O_CLOEXEC));
    ASSERT_EQ(fsync(file.get()), 0);
  }
  // What a file may hold after a cut now; "none": it is not there.
  std::set<std::string> possible(const std::string& name) {
    std::set<std::string> found;
    images_.clear();
    for (int i = 0; i < 300; ++i) static_cast<void>(link((folder / "nothing").c_str(), (folder / "new").c_str()));
    for (const UnsyncedDisk::Image& image : images_)
      found.insert(image.files.contains(name) ? image.files.at(name) : "none");
    return found;
  }

  TemporaryFolder base_;
  const fs::path folder = base_.path() / "disk";
  std::vector<UnsyncedDisk::Image> images_;
  std::optional<UnsyncedDisk> disk_;
};

TEST_F(Disk, HasWhatWasThereAtFirst) {
  EXPECT_EQ(possible("old"), std::set{std::string(2000, 'o')});
}

TEST_F(Disk, LosesAFileWhoseFolderWasNotSynced) {
  write("a", "new");
  EXPECT_THAT(possible("a"), IsSupersetOf({"none", "", "new"}));
  sync("a");
  EXPECT_EQ(possible("a"), (std::set<std::string>{"none", "new"}));
  sync(".");
  EXPECT_EQ(possible("a"), std::set<std::string>{"new"});
}

// The name without the bytes, as of a program that syncs the folder alone.
TEST_F(Disk, LosesBytesThatWereNotSynced) {
  write("a", std::string(1200, 'a'));
  sync(".");
  std::set<std::string> found = possible("a");
  EXPECT_FALSE(found.contains("none"));
  EXPECT_TRUE(found.contains("") && found.contains(std::string(1200, 'a')));
  EXPECT_TRUE(std::ranges::any_of(found, [](const std::string& bytes) {
    return bytes.starts_with(std::string(512, 'a')) && bytes.size() > 1024 && bytes.find('a', 512) >= 1024;
  })) << "no sector was lost alone";
  sync("a");
  EXPECT_TRUE(possible("a") == std::set{std::string(1200, 'a')});
  // Appended: what was there stays.
  std::ofstream(folder / "a", std::ios::app) << std::string(900, 'b');
  found = possible("a");
  for (const std::string& bytes : found) EXPECT_TRUE(bytes.starts_with(std::string(1200, 'a')));
  EXPECT_GT(found.size(), 10U);
}

TEST_F(Disk, KeepsTheOldFileOrTheNewOneOfARename) {
  write("draft", "whole");
  sync("draft");
  ASSERT_EQ(rename((folder / "draft").c_str(), (folder / "old").c_str()), 0);
  EXPECT_EQ(possible("old"), (std::set<std::string>{std::string(2000, 'o'), "whole"}));
  for (const UnsyncedDisk::Image& image : images_)
    EXPECT_FALSE(image.files.at("old") == "whole" && image.files.contains("draft")) << "it is there twice";
  sync(".");
  EXPECT_EQ(possible("old"), std::set<std::string>{"whole"});
}

TEST_F(Disk, ARemovalMayNotHaveHappened) {
  ASSERT_EQ(unlink((folder / "old").c_str()), 0);
  EXPECT_EQ(possible("old"), (std::set<std::string>{std::string(2000, 'o'), "none"}));
  sync(".");
  EXPECT_EQ(possible("old"), std::set<std::string>{"none"});
}

TEST_F(Disk, WhatIsInAFolderIsThereWithItAlone) {
  fs::create_directory(folder / "deep");
  write("deep/a", "new");
  sync("deep/a");
  sync("deep");
  EXPECT_EQ(possible("deep/a"), (std::set<std::string>{"none", "new"}));
  sync(".");
  EXPECT_EQ(possible("deep/a"), std::set<std::string>{"new"});
}

}  // namespace unsynced_disk_test
}  // namespace palpate
