// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/disk_answers.hpp"

#include <cerrno>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/edit/lower_edit.hpp"
#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {
namespace disk_answers_test {

using testing::HasSubstr;

JournalHeader header() {
  const Volume volume = Volume::fromDense({8, 8, 8}, Lattice{}, std::vector<float>(512, 1.0F), {});
  return {identityOf(volume), brushProfile(0.5, 0, 1, volume.lattice().spacing_m)};
}

std::vector<EditCommand> dab() {
  EditCommand command;
  command.kind = EditKind::kRemove;
  command.radius_m = 1e-3;
  return {command};
}

struct Answers {
  DiskAnswers answers;
  std::vector<std::string> told;  // "" for an edit that is on the disk
  void make(JournalWriter& journal) {
    journal.edit(dab());
    answers.add(journal,
                [this](const std::optional<Error>& refusal) { told.push_back(refusal ? refusal->what() : ""); });
  }
};

TEST(DiskAnswers, AreGivenWhenTheEditIsOnTheDisk) {
  const TemporaryFolder folder;
  JournalOptions options;
  options.gather = std::chrono::seconds(20);  // so that none is on the disk before flush(), which waits for no more
  JournalWriter journal(folder.path(), header(), options);
  Answers edits;
  edits.make(journal);
  edits.make(journal);
  EXPECT_EQ(edits.answers.waiting(), 2U);
  edits.answers.settle(journal);
  EXPECT_THAT(edits.told, testing::IsEmpty());
  EXPECT_EQ(edits.answers.waiting(), 2U);
  journal.flush();
  edits.make(journal);
  edits.answers.settle(journal);
  EXPECT_THAT(edits.told, testing::ElementsAre("", ""));
  EXPECT_EQ(edits.answers.waiting(), 1U);
  journal.close();
  edits.answers.settle(journal);
  EXPECT_EQ(edits.told.size(), 3U);
  EXPECT_EQ(edits.answers.waiting(), 0U);
}

// Those that got there are told so, whatever came after.
TEST(DiskAnswers, SayWhichEditsAJournalThatFailedLacks) {
  const TemporaryFolder folder;
  JournalWriter journal(folder.path(), header());
  Answers edits;
  edits.make(journal);
  journal.flush();
  journal.end("an edit could not be encoded", ENOMEM);
  while (!journal.failed()) std::this_thread::yield();
  edits.make(journal);
  edits.answers.settle(journal);
  ASSERT_EQ(edits.told.size(), 2U);
  EXPECT_EQ(edits.told[0], "");
  EXPECT_THAT(edits.told[1], HasSubstr("the edit was made, but it is not on the disk"));
  EXPECT_THAT(edits.told[1], HasSubstr("could not be encoded"));
  EXPECT_THAT(edits.told[1], HasSubstr("palpate ctl save"));
  EXPECT_EQ(edits.answers.waiting(), 0U);
}

}  // namespace disk_answers_test
}  // namespace palpate
