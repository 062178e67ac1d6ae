// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/session_folders.hpp"

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "engine/journal/journal_writer.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace session_folders_test {

using testing::HasSubstr;
using testing::IsEmpty;

JournalHeader header(const std::string& source) {
  JournalHeader made;
  made.volume.source = source;
  made.volume.size = Vec3i(8, 8, 8);
  made.profile = {30, -100, 100, 1000, 1e-3};
  return made;
}

void keepEdits(const std::filesystem::path& folder, const std::string& source, int edits, int undone = 0) {
  JournalWriter journal(folder, header(source));
  EditCommand dab;
  dab.radius_m = 1e-3;
  for (int i = 0; i < edits; ++i) journal.edit({&dab, 1});
  for (int i = 0; i < undone; ++i) journal.undo();
  journal.close();
}

// A session that another process holds until it is killed.
pid_t crashing(const std::filesystem::path& root, const std::string& source, int edits, int undone = 0) {
  int ready[2];
  if (pipe(ready) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) {
    const SessionFolder folder(root);
    keepEdits(folder.path(), source, edits, undone);
    static_cast<void>(write(ready[1], "x", 1));
    pause();
    _exit(0);
  }
  char byte = 0;
  static_cast<void>(read(ready[0], &byte, 1));
  close(ready[0]);
  close(ready[1]);
  return child;
}

void crash(pid_t child) {
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST(SessionFolders, AreTheirOwnAndGoWhenTheyAreEmpty) {
  const TemporaryFolder root;
  std::filesystem::path first, second;
  {
    const SessionFolder a(root.path() / "deep" / "root"), b(root.path() / "deep" / "root");
    first = a.path();
    second = b.path();
    EXPECT_NE(first, second);
    EXPECT_TRUE(std::filesystem::is_directory(first));
    std::ofstream(second / "something") << "x";
  }
  EXPECT_FALSE(std::filesystem::exists(first));
  EXPECT_TRUE(std::filesystem::exists(second / "something"));
}

// Whoever lives keeps his session; when he is killed it is found, with what is in effect.
TEST(SessionFolders, OfAKilledProgramAreFound) {
  const TemporaryFolder root;
  const pid_t child = crashing(root.path(), "scan.nii", 5, 2);
  ASSERT_GT(child, 0);
  EXPECT_THAT(leftSessions(root.path()), IsEmpty());
  crash(child);
  const std::vector<LeftSession> left = leftSessions(root.path());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].volume, "scan.nii");
  EXPECT_EQ(left[0].edits, 3U);
  EXPECT_THAT(left[0].damage, IsEmpty());
  dropLeftSession(left[0]);
  EXPECT_FALSE(std::filesystem::exists(left[0].folder));
  EXPECT_THAT(leftSessions(root.path()), IsEmpty());
}

TEST(SessionFolders, WithoutEditsInEffectAreNotOffered) {
  const TemporaryFolder root;
  crash(crashing(root.path(), "scan.nii", 0));
  crash(crashing(root.path(), "scan.nii", 2, 2));
  EXPECT_THAT(leftSessions(root.path()), IsEmpty());
}

TEST(SessionFolders, WithADamagedJournalTellWhatIsLost) {
  const TemporaryFolder root;
  crash(crashing(root.path(), "scan.nii", 4));
  const auto folder = leftSessions(root.path()).at(0).folder;
  const auto file = folder / "journal.palpate";
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 3);
  const std::vector<LeftSession> left = leftSessions(root.path());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].edits, 3U);
  EXPECT_THAT(left[0].damage, HasSubstr("1 record"));
  std::ofstream(file) << "nothing of the kind";
  EXPECT_THAT(leftSessions(root.path()), IsEmpty());
}

// It holds its edits as bricks, and may have made its folder again, which has no lock then.
TEST(SessionFolders, OfAJournalThatBeganAnewAreFoundOnceNobodyLives) {
  const TemporaryFolder root;
  const Volume volume = Volume::fromDense(Vec3i(8, 8, 8), {}, std::vector<float>(512, 1.F), {});
  const std::vector<std::uint32_t> bricks = {0};
  std::optional<JournalWriter> journal;
  journal.emplace(root.path() / "2026-01-01T000000-1", header("scan.nii"), JournalOptions{},
                  JournalBeginning{{5, 7}, &volume, bricks});
  EXPECT_THAT(leftSessions(root.path()), IsEmpty()) << "its session is alive";
  EditCommand dab;
  dab.radius_m = 1e-3;
  journal->edit({&dab, 1});
  journal.reset();
  const std::vector<LeftSession> left = leftSessions(root.path());
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].edits, 6U);
}

TEST(SessionFolders, AreRefusedWhereNoneCanBeMade) {
  const TemporaryFolder root;
  std::ofstream(root.path() / "file") << "x";
  EXPECT_THROW(SessionFolder(root.path() / "file"), Error);
  EXPECT_THAT(leftSessions(root.path() / "nothing"), IsEmpty());
}

}  // namespace session_folders_test
}  // namespace palpate
