// SPDX-License-Identifier: Apache-2.0
#include "base/part_file.hpp"

#include <csignal>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/atomic_file.hpp"
#include "temporary_folder.hpp"
#include "tests/support/open_descriptors.hpp"

namespace palpate {
namespace part_file_test {

class PartFiles : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name) const { std::ofstream(file(name)) << name; }
  [[nodiscard]] bool exists(const std::string& name) const { return std::filesystem::exists(file(name)); }
  TemporaryFolder folder_;
};

// Process 1 lives, and never wrote these.
TEST_F(PartFiles, WhatIsLeftOfTheTargetIsRemovedWhoseverNumberItBears) {
  for (const char* name : {"a.vdb.1.palpate-part", "a.vdb.1-2.palpate-part", "a.vdb.999999999.palpate-part",
                           "a.vdb.102.palpate-part", "a.vdb.7-30.palpate-part"})
    write(name);
  writeFileAtomically(file("a.vdb"), "new");
  EXPECT_EQ(contentsOf(file("a.vdb")), "new");
  EXPECT_EQ(folder_.files(), 1);
}

// Two that begin alike are two targets, and a killed writer's file is still known as that of its target.
TEST_F(PartFiles, LongNamesAreToldApart) {
  const std::string begin(250, 'n'), a = begin + "a.vdb", b = begin + "b.vdb", accents = std::string(1, 'x') + [] {
    std::string text;
    for (int i = 0; i < 125; ++i) text += "\u00e9";
    return text;
  }();
  for (const std::string& name : {a, accents}) {
    std::string left;
    {
      const AtomicFile writing(file(name));
      ASSERT_EQ(folder_.files(), 1);
      left = std::filesystem::directory_iterator(folder_.path())->path().filename();
      EXPECT_LE(left.size(), 255U);
    }
    EXPECT_EQ(folder_.files(), 0);
    write(left);  // as a killed process leaves it
    writeFileAtomically(file(b), "new");
    EXPECT_EQ(folder_.files(), 2);
    writeFileAtomically(file(name), "new");
    EXPECT_EQ(folder_.files(), 2);
    EXPECT_EQ(contentsOf(file(name)), "new");
    std::filesystem::remove(file(b));
    std::filesystem::remove(file(name));
  }
}

// A name without "palpate-part" is some other program's, or a person's.
const std::initializer_list<const char*> kOthers = {"a.vdb.1.part",
                                                    "a.vdb.2024-01-02.part",
                                                    "a.vdb.part",
                                                    "a.vdb.palpate-part",
                                                    "a.vdb..palpate-part",
                                                    "a.vdb.1x.palpate-part",
                                                    "a.vdb.-1.palpate-part",
                                                    "a.vdb.1-.palpate-part",
                                                    "a.vdb.2024-01-02.palpate-part",
                                                    "a.vdb.1.palpate-part.old",
                                                    "a.vdb.1"};

TEST_F(PartFiles, OtherFilesStay) {
  for (const char* name : kOthers) write(name);
  write("b.vdb.1.palpate-part");
  write("x.a.vdb.1.palpate-part");
  std::filesystem::create_directory(file("a.vdb.2.palpate-part"));
  std::filesystem::create_symlink(file("b.vdb.1.palpate-part"), file("a.vdb.3.palpate-part"));
  ASSERT_EQ(mkfifo(file("a.vdb.4.palpate-part").c_str(), 0600), 0);
  const long open = openDescriptors();
  writeFileAtomically(file("a.vdb"), "new");
  for (const char* name : kOthers) EXPECT_EQ(contentsOf(file(name)), name);
  for (const char* name : {"b.vdb.1.palpate-part", "x.a.vdb.1.palpate-part", "a.vdb.2.palpate-part",
                           "a.vdb.3.palpate-part", "a.vdb.4.palpate-part"})
    EXPECT_TRUE(exists(name)) << name;
  EXPECT_EQ(openDescriptors(), open);
}

TEST_F(PartFiles, AFolderIsSweptOfEveryTarget) {
  for (const char* name : {"a.vdb.1.palpate-part", "b.nrrd.2-3.palpate-part", "c.txt.4.palpate-part"}) write(name);
  for (const char* name : kOthers) write(name);
  sweepPartFiles(folder_.path());
  EXPECT_EQ(folder_.files(), static_cast<std::ptrdiff_t>(kOthers.size()));
  for (const char* name : kOthers) EXPECT_EQ(contentsOf(file(name)), name);
}

// Another process is killed in the middle of its write: until then its file stays, then it goes.
TEST_F(PartFiles, WhatIsBeingWrittenStaysUntilItsWriterDies) {
  const pid_t child = fork();
  if (child == 0) {
    AtomicFile unfinished(file("a.vdb"));
    unfinished.write(std::string(1'000'000, 'u'));
    write("ready");
    for (;;) pause();
  }
  while (contentsOf(file("ready")) != "ready") usleep(1000);
  const std::string part = "a.vdb." + std::to_string(child) + ".palpate-part";
  writeFileAtomically(file("a.vdb"), "first");
  EXPECT_TRUE(exists(part));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(exists(part));
  writeFileAtomically(file("a.vdb"), "second");
  EXPECT_FALSE(exists(part));
  EXPECT_EQ(contentsOf(file("a.vdb")), "second");
}

TEST_F(PartFiles, BearTheNumberOfTheirProcess) {
  const PartFile first = openPartFile(file("a.vdb")), second = openPartFile(file("a.vdb"));
  const std::string number = std::to_string(getpid());
  EXPECT_EQ(first.name, file("a.vdb." + number + ".palpate-part"));
  EXPECT_EQ(second.name, file("a.vdb." + number + "-1.palpate-part"));
  for (const PartFile* part : {&first, &second}) {
    EXPECT_EQ(part->error, 0);
    EXPECT_TRUE(part->leftover);
    EXPECT_EQ(close(part->descriptor), 0);
  }
  const PartFile none = openPartFile(file("none/a.vdb"));
  EXPECT_EQ(none.error, ENOENT);
  EXPECT_EQ(none.descriptor, -1);
  EXPECT_FALSE(none.leftover);
}

// Two writers of one process have two files, and both are whole.
TEST_F(PartFiles, TwoWritersOfOneTargetDoNotMix) {
  AtomicFile slow(file("a.vdb"));
  slow.write(std::string(200'000, 's'));
  writeFileAtomically(file("a.vdb"), std::string(100'000, 'q'));
  EXPECT_EQ(contentsOf(file("a.vdb")), std::string(100'000, 'q'));
  slow.commit();
  EXPECT_EQ(contentsOf(file("a.vdb")), std::string(200'000, 's'));
  EXPECT_EQ(folder_.files(), 1);
}

}  // namespace part_file_test
}  // namespace palpate
