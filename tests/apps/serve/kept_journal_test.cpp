// SPDX-License-Identifier: Apache-2.0
// Whenever a service is killed between two starts, the journal that counts is the one with every edit.
#include "apps/serve/kept_journal.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/journal/journal_format.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace kept_journal_test {

namespace fs = std::filesystem;

class KeptJournals : public testing::Test {
 protected:
  void writeJournal(const fs::path& at, const std::string& words) const {
    fs::create_directories(at);
    std::ofstream(journalFile(at)) << words;
  }
  [[nodiscard]] std::string journalIn(const fs::path& at) const {
    std::ifstream file(journalFile(at));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  TemporaryFolder folder_;
  const fs::path here = folder_.path() / "journal", before = here / "earlier";
};

TEST_F(KeptJournals, AreNoneAtFirst) {
  KeptJournal kept(here);
  EXPECT_TRUE(kept.earlier().empty());
  kept.takeOver(true);
  EXPECT_FALSE(fs::exists(journalFile(here)));
  EXPECT_TRUE(KeptJournal("").earlier().empty());
}

TEST_F(KeptJournals, GoFromStartToStart) {
  writeJournal(here, "first");
  for (const char* next : {"second", "third", "fourth"}) {
    KeptJournal kept(here);
    EXPECT_EQ(kept.earlier(), before);
    EXPECT_FALSE(fs::exists(journalFile(here)));
    writeJournal(here, next);
    kept.takeOver(true);
    EXPECT_FALSE(fs::exists(before));
    EXPECT_EQ(journalIn(here), next);
  }
}

// Another service must not begin in a folder that was removed and is there anew.
TEST_F(KeptJournals, AreLockedAgainInAFolderMadeAnew) {
  KeptJournal kept(here);
  fs::remove_all(here);
  fs::create_directory(here);
  kept.lockAgain();
  EXPECT_THAT(refusalOf([&] { const KeptJournal another(here); }, Error::Code::kIo),
              testing::HasSubstr("another service"));
  kept.lockAgain();  // it is locked already
  fs::remove_all(here);
  fs::create_directory(here);
  const KeptJournal another(here);
  EXPECT_THAT(refusalOf([&] { kept.lockAgain(); }, Error::Code::kIo), testing::HasSubstr("another service"));
}

// Something of it could not be read, and may be read by somebody who knows more.
TEST_F(KeptJournals, ThatWereNotReadToTheirEndArePutAside) {
  for (const char* name : {"journal-unread-1.palpate", "journal-unread-2.palpate"}) {
    writeJournal(here, name);
    KeptJournal kept(here);
    writeJournal(here, "next");
    EXPECT_EQ(kept.takeOver(false), here / name);
    EXPECT_FALSE(fs::exists(before));
    EXPECT_EQ(journalIn(here), "next");
  }
  std::ifstream first(here / "journal-unread-1.palpate");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(first), {}), "journal-unread-1.palpate");
}

// Killed while it makes the edits again: the earlier one counts, at the next start too.
TEST_F(KeptJournals, OfAKilledStartCountForNothing) {
  writeJournal(here, "first");
  for (int start = 0; start < 3; ++start) {
    KeptJournal kept(here);
    EXPECT_EQ(journalIn(kept.earlier()), "first") << start;
    EXPECT_FALSE(fs::exists(journalFile(here))) << start;
    if (start < 2) writeJournal(here, "half of it");
  }
}

// Killed when the new one held all, and the earlier one was not deleted yet: edits since then are in the new one.
TEST_F(KeptJournals, CountFromTheMarkOn) {
  writeJournal(here, "first");
  {
    KeptJournal kept(here);
    writeJournal(here, "second");
    kept.takeOver(true);
  }
  writeJournal(before, "first");  // as if it had not been deleted
  EXPECT_EQ(journalIn(KeptJournal(here).earlier()), "second");
  writeJournal(here, "half of it");
  EXPECT_EQ(journalIn(KeptJournal(here).earlier()), "second");  // the mark was not the third one's
}

// A folder with other files in it, and a name that ends in a slash.
TEST_F(KeptJournals, TouchNothingElse) {
  writeJournal(here, "first");
  std::ofstream(here / "mine.txt") << "mine";
  KeptJournal kept(here.string() + "/");
  EXPECT_EQ(journalIn(kept.earlier()), "first");
  writeJournal(here, "second");
  kept.takeOver(true);
  EXPECT_EQ(journalIn(here), "second");
  EXPECT_TRUE(fs::exists(here / "mine.txt"));
  EXPECT_FALSE(fs::exists(before));
}

TEST_F(KeptJournals, BelongToOneServiceAtATime) {
  writeJournal(here, "first");
  {
    KeptJournal kept(here);
    EXPECT_THAT(refusalOf([&] { KeptJournal another(here); }, Error::Code::kIo),
                testing::HasSubstr("another service keeps it"));
    EXPECT_EQ(journalIn(kept.earlier()), "first");
  }
  EXPECT_EQ(journalIn(KeptJournal(here).earlier()), "first");
}

}  // namespace kept_journal_test
}  // namespace palpate
