// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/saved_files.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "temporary_folder.hpp"

namespace palpate {
namespace saved_files_test {

namespace fs = std::filesystem;

void put(const fs::path& file) {
  std::ofstream(file) << "x";
}

TEST(SavedFiles, WhatOthersPutThereIsForeign) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.vdb";
  SavedFiles saved;
  EXPECT_FALSE(saved.isForeign(file));  // nothing lies there
  put(file);
  EXPECT_TRUE(saved.isForeign(file));
  saved.wrote(file);
  EXPECT_FALSE(saved.isForeign(file));
  EXPECT_FALSE(saved.isForeign(folder.path() / "." / "b" / ".." / "a.vdb"));
  EXPECT_TRUE(SavedFiles().isForeign(file));  // of another session
}

TEST(SavedFiles, LinksAndFoldersAreForeignToo) {
  const TemporaryFolder folder;
  fs::create_symlink("nowhere", folder.path() / "link.vdb");
  fs::create_directory(folder.path() / "folder.vdb");
  const SavedFiles saved;
  EXPECT_TRUE(saved.isForeign(folder.path() / "link.vdb"));  // what it points to would come about
  EXPECT_TRUE(saved.isForeign(folder.path() / "folder.vdb"));
}

// A file that was announced and could not be written is not there, so nothing is asked.
TEST(SavedFiles, AWriteThatIsStillUnderWayIsNotForeign) {
  const TemporaryFolder folder;
  SavedFiles saved;
  saved.wrote(folder.path() / "a.vdb");
  EXPECT_FALSE(saved.isForeign(folder.path() / "a.vdb"));
  put(folder.path() / "a.vdb");
  EXPECT_FALSE(saved.isForeign(folder.path() / "a.vdb"));
}

}  // namespace saved_files_test
}  // namespace palpate
