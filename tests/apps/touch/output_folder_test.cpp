// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/output_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace output_folder_test {

namespace fs = std::filesystem;

void save(const fs::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

class OutputFolderTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const char* name) const { return (folder_.path() / name).string(); }
  [[nodiscard]] bool exists(const char* name) const { return fs::exists(folder_.path() / name); }
  [[nodiscard]] std::string refusal(const std::string& path) const {
    try {
      OutputFolder out(path);
      return "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kIo);
      return error.what();
    }
  }
  TemporaryFolder folder_;
};

TEST_F(OutputFolderTest, IsMadeWithItsParentsAndGoneAgainIfNothingIsPublished) {
  {
    OutputFolder out(path("a/b/c/"));
    EXPECT_TRUE(exists("a/b/c"));
    save(out.draft("x"), "half");
  }
  EXPECT_EQ(folder_.files(), 0);
}

TEST_F(OutputFolderTest, HoldsWhatWasPublishedAndNoDrafts) {
  {
    OutputFolder out(path("a/b"));
    save(out.draft("x"), "1");
    save(out.draft("y"), "2");
    EXPECT_FALSE(fs::exists(out.file("x")));
    out.publish();
  }
  EXPECT_EQ(contentsOf(folder_.path() / "a/b/x"), "1");
  EXPECT_EQ(contentsOf(folder_.path() / "a/b/y"), "2");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path() / "a/b"), {}), 2);
}

// A full disk, for example: the draft lies in a hidden folder that nobody knows.
TEST_F(OutputFolderTest, AnErrorNamesTheFileAndNotItsDraft) {
  const OutputFolder out(path("a"));
  const auto errorOf = [&](const std::function<void(const fs::path&)>& work) {
    return refusalOf([&] { out.write("x", work); }, Error::Code::kIo);
  };
  const auto full = [](const fs::path& draft) {
    throw Error(Error::Code::kIo, draft.string(), "it cannot be written", "make room");
  };
  EXPECT_EQ(errorOf(full), path("a/x") + ": it cannot be written; make room");
  const auto other = [](const fs::path&) { throw Error(Error::Code::kIo, "GPU", "it is lost", "start again"); };
  EXPECT_EQ(errorOf(other), "GPU: it is lost; start again");
  out.write("x", [](const fs::path& draft) { save(draft, "1"); });
  EXPECT_TRUE(fs::exists(out.draft("x")));
}

TEST_F(OutputFolderTest, KeepsOlderFilesUntilNewOnesArePublished) {
  fs::create_directory(path("a"));
  save(path("a/x"), "old");
  {
    OutputFolder out(path("a"));
    save(out.draft("x"), "new");
  }
  EXPECT_EQ(contentsOf(path("a/x")), "old");
  {
    OutputFolder out(path("a"));
    save(out.draft("x"), "new");
    out.publish();
  }
  EXPECT_EQ(contentsOf(path("a/x")), "new");
}

// A kind of file that a run leaves out would otherwise stay from the one before and pass for its own.
TEST_F(OutputFolderTest, RemovesAnOlderFileThatIsLeftOut) {
  fs::create_directories(path("a/z"));
  save(path("a/x"), "old");
  save(path("a/other"), "mine");
  {
    OutputFolder out(path("a"));
    save(out.draft("y"), "new");
    out.leaveOut("x");
    out.leaveOut("z");  // no file
    EXPECT_TRUE(exists("a/x"));
    out.publish();
  }
  EXPECT_FALSE(exists("a/x"));
  EXPECT_TRUE(exists("a/z"));
  EXPECT_EQ(contentsOf(path("a/y")), "new");
  EXPECT_EQ(contentsOf(path("a/other")), "mine");
}

TEST_F(OutputFolderTest, WhatWasLeftOutStaysIfNothingIsPublished) {
  fs::create_directory(path("a"));
  save(path("a/x"), "old");
  OutputFolder(path("a")).leaveOut("x");
  EXPECT_EQ(contentsOf(path("a/x")), "old");
}

TEST_F(OutputFolderTest, PublishesNothingWhereAFolderIsInTheWay) {
  fs::create_directories(path("a/y"));
  OutputFolder out(path("a"));
  save(out.draft("x"), "1");
  save(out.draft("y"), "2");
  EXPECT_THROW(out.publish(), Error);
  EXPECT_FALSE(exists("a/x"));
  EXPECT_TRUE(fs::is_directory(path("a/y")));
}

TEST_F(OutputFolderTest, KeepsAFolderThatSomebodyElseFilledMeanwhile) {
  {
    OutputFolder out(path("a/b"));
    save(path("a/other"), "mine");
  }
  EXPECT_TRUE(exists("a/other"));
  EXPECT_FALSE(exists("a/b"));
}

// Behind a link lies a larger disk, say: the result goes there, and the link stays.
TEST_F(OutputFolderTest, PublishesThroughSymbolicLinks) {
  for (const char* folder : {"a", "elsewhere"}) fs::create_directory(path(folder));
  save(path("elsewhere/x"), "old");
  fs::create_symlink(path("elsewhere/x"), path("a/x"));
  fs::create_symlink("../elsewhere/y", path("a/y"));  // not there yet
  fs::create_directory_symlink("a", path("link"));
  {
    OutputFolder out(path("link"));
    for (const char* name : {"x", "y", "z"}) save(out.draft(name), name);
    out.publish();
  }
  EXPECT_TRUE(fs::is_symlink(fs::symlink_status(path("a/x"))));
  EXPECT_EQ(contentsOf(path("elsewhere/x")), "x");
  EXPECT_EQ(contentsOf(path("elsewhere/y")), "y");
  EXPECT_EQ(contentsOf(path("a/z")), "z");
  EXPECT_EQ(std::distance(fs::directory_iterator(path("a")), {}), 3);
  EXPECT_EQ(std::distance(fs::directory_iterator(path("elsewhere")), {}), 2);
}

// More than is copied at once.
TEST_F(OutputFolderTest, PublishesLargeFilesThroughSymbolicLinks) {
  fs::create_directory(path("a"));
  fs::create_symlink("../x", path("a/x"));
  std::string text(3'000'001, ' ');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i % 23);
  {
    OutputFolder out(path("a"));
    save(out.draft("x"), text);
    out.publish();
  }
  EXPECT_EQ(contentsOf(path("x")), text);
}

TEST_F(OutputFolderTest, MovesNothingWhereALinkLeadsNowhere) {
  fs::create_directory(path("a"));
  fs::create_symlink("none/x", path("a/x"));
  OutputFolder out(path("a"));
  for (const char* name : {"w", "x", "y"}) save(out.draft(name), name);
  EXPECT_THROW(out.publish(), Error);
  EXPECT_FALSE(exists("a/w"));
  EXPECT_FALSE(exists("a/y"));
}

// An older result that does not belong to this run: the file goes, the link is the user's.
TEST_F(OutputFolderTest, LeavesOutBehindALinkToo) {
  for (const char* folder : {"a", "elsewhere"}) fs::create_directory(path(folder));
  save(path("elsewhere/x"), "old");
  save(path("a/y"), "old");
  fs::create_symlink("../elsewhere/x", path("a/x"));
  OutputFolder out(path("a"));
  out.leaveOut("x");
  out.leaveOut("y");
  out.publish();
  EXPECT_FALSE(exists("elsewhere/x"));
  EXPECT_TRUE(fs::is_symlink(fs::symlink_status(path("a/x"))));
  EXPECT_FALSE(exists("a/y"));
}

// Drafts and parts that nobody holds any more. What has another program's name stays, though it lies beside its target.
TEST_F(OutputFolderTest, IsSweptOfWhatKilledRunsLeft) {
  fs::create_directories(path("a/.palpate-Ab12xY"));
  save(path("a/.palpate-Ab12xY/trace.csv"), "half");
  for (const char* name : {"a/s.vdb.1.palpate-part", "a/view.png.2-1.palpate-part"}) save(path(name), "half");
  const auto mine = {"a/head.nii.gz.1.part", "a/head.nii.gz", "a/data.csv.2024-01-02.part",
                     "a/film.mkv.4.part",    "a/s.vdb.part",  "a/.palpate-short"};
  for (const char* name : mine) save(path(name), "mine");
  { OutputFolder out(path("a")); }
  EXPECT_EQ(std::distance(fs::directory_iterator(path("a")), {}), static_cast<std::ptrdiff_t>(mine.size()));
  for (const char* name : mine) EXPECT_EQ(contentsOf(path(name)), "mine");
}

TEST_F(OutputFolderTest, IsNotSweptOfWhatLives) {
  OutputFolder first(path("a"));
  save(first.draft("x"), "1");
  AtomicFile part(path("a/s.vdb"));
  OutputFolder second(path("a"));
  first.publish();
  EXPECT_EQ(contentsOf(path("a/x")), "1");
  part.write("whole");
  part.commit();
  EXPECT_EQ(contentsOf(path("a/s.vdb")), "whole");
}

TEST_F(OutputFolderTest, IsRefusedWhereNothingCanBeWritten) {
  save(path("file"), "mine");
  EXPECT_THAT(refusal(path("file")), testing::StartsWith(path("file") + ": nothing can be written there"));
  EXPECT_THAT(refusal(path("file/inner")), testing::HasSubstr("; choose another folder with --out"));
  EXPECT_THAT(refusal("/proc/palpate"), testing::HasSubstr("/proc/palpate: nothing can be written"));
  EXPECT_THAT(refusal(""), testing::HasSubstr("--out '': "));
  EXPECT_THAT(refusal(path("new/") + std::string(300, 'x')), testing::HasSubstr("too long"));
  EXPECT_FALSE(exists("new"));
  EXPECT_EQ(contentsOf(path("file")), "mine");
}

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class RunResults : public testing::Test {
 protected:
  void save(const char* name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }
  [[nodiscard]] std::vector<std::string> foreign() const { return foreignResults(folder_.path()); }
  TemporaryFolder folder_;
};

TEST_F(RunResults, OfAnEarlierRunMayBeReplaced) {
  save("summary.json",
       R"({"schema": "palpate.touch.summary/2", "files": ["x/report.html", "x/summary.json", "x/trace.csv"]})");
  save("trace.csv", "");
  save("report.html", "");
  save("notes.txt", "anything else in the folder is nobody's business");
  EXPECT_THAT(foreign(), IsEmpty());
  EXPECT_NO_THROW(refuseForeignResults(folder_.path()));
  save("view.png", "a picture that that run did not draw");
  EXPECT_THAT(foreign(), ElementsAre("view.png"));
}

TEST_F(RunResults, OfAnEarlierVersionMayBeReplaced) {
  save("summary.json", R"({"schema": "palpate.touch.summary/1", "files": ["trace.csv"]})");
  save("trace.csv", "");
  EXPECT_THAT(foreign(), IsEmpty());
}

TEST_F(RunResults, ThatNobodyListsAreForeign) {
  EXPECT_THAT(foreign(), IsEmpty());
  EXPECT_THAT(foreignResults(folder_.path() / "none"), IsEmpty());
  save("report.html", "a report of another program");
  EXPECT_THAT(foreign(), ElementsAre("report.html"));
  try {
    refuseForeignResults(folder_.path());
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_EQ(std::string(error.what()), (folder_.path() / "report.html").string() +
                                             ": it is not a result of palpate and would be replaced by one; "
                                             "move it away or choose another folder with --out");
  }
}

// Whatever it is, it says nothing of the others and is not replaced itself.
TEST_F(RunResults, ASummaryOfAnotherKindIsForeign) {
  save("trace.csv", "");
  for (const char* text : {"", "[]", "{", "7", R"({"schema": "another/1", "files": ["trace.csv"]})", R"({"schema": 7})",
                           R"({"files": ["trace.csv", "summary.json"]})"}) {
    save("summary.json", text);
    EXPECT_THAT(foreign(), ElementsAre("trace.csv", "summary.json")) << text;
  }
  for (const char* files : {"7", "[7]", "{}", "null"}) {
    save("summary.json", std::string(R"({"schema": "palpate.touch.summary/2", "files": )") + files + "}");
    EXPECT_THAT(foreign(), ElementsAre("trace.csv")) << files;
  }
}

}  // namespace output_folder_test
}  // namespace palpate
