// SPDX-License-Identifier: Apache-2.0
// The modules "sample" and two strays are built beside this test (CMakeLists.txt).
#include "base/module.hpp"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/mapped_libraries.hpp"
#include "refusal.hpp"
#include "sample_table.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace module_test {

using testing::AllOf;
using testing::Contains;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string refusalOfLoading(const std::filesystem::path& file, const std::string& table = "palpate_stray") {
  return refusalOf([&] { (void)moduleTable(file, table); }, Error::Code::kNotFound);
}

// In one test, since a module stays loaded.
TEST(Module, IsLoadedWhenItIsFirstUsed) {
  EXPECT_THAT(mappedLibraries(), Not(Contains("sample.so")));
  EXPECT_EQ(loadModule<SampleModule>().twice(21), 42);
  EXPECT_THAT(mappedLibraries(), Contains("sample.so").Times(1));
  EXPECT_EQ(&loadModule<SampleModule>(), &loadModule<SampleModule>());
}

// For a process that soon may load nothing. What is not there is told when it is needed.
TEST(Module, IsLoadedAheadWhereThatIsAskedFor) {
  EXPECT_EXIT(
      {
        loadAhead({"none", "sample"});
        _exit(std::ranges::count(mappedLibraries(), "sample.so") == 1 ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

// A servo's process says so, whose libraries were all loaded before: mending the file alone is not enough.
TEST(Module, WhatIsMissingAfterwardsWantsANewServo) {
  constexpr const char* kAgain = ", and start the servo again";
  EXPECT_THAT(refusalOfLoading("/none.so"), Not(HasSubstr(kAgain)));
  EXPECT_EXIT(
      {
        loadAhead({"none"});
        const bool all = refusalOfLoading("/none.so").ends_with(kAgain) &&
                         refusalOfLoading(PALPATE_OLD_STRAY).ends_with(kAgain) &&
                         refusalOfLoading("/proc/self/exe").ends_with(kAgain);
        _exit(all ? 0 : 1);
      },
      testing::ExitedWithCode(0), "");
}

TEST(Module, ThrowsWhatIsCaughtAsAnError) {
  try {
    loadModule<SampleModule>().refuseIt("file.nii");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
    EXPECT_STREQ(error.what(), "file.nii: it is refused; go on");
    EXPECT_EQ(error.remedy(), "go on");
  }
}

TEST(Module, LiesBesideTheFolderOfTheProgram) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  EXPECT_EQ(moduleFile("itk"), self.parent_path().parent_path() / "lib/palpate/itk.so");
}

TEST(Module, ThatIsMissingIsTold) {
  EXPECT_THAT(refusalOfLoading("/nowhere/lib/palpate/itk.so"),
              AllOf(StartsWith("/nowhere/lib/palpate/itk.so: this part of Palpate is missing"),
                    HasSubstr("./dev build"), HasSubstr("copy the folder lib/palpate")));
}

TEST(Module, ThatTheLoaderRefusesIsToldWithItsReason) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "itk.so";
  std::ofstream(file) << "no library";
  EXPECT_THAT(refusalOfLoading(file), AllOf(StartsWith(file.string() + ": this part of Palpate cannot be loaded ("),
                                            HasSubstr("file too short"), EndsWith("lists the packages")));
}

TEST(Module, OfAnotherVersionIsRefused) {
  EXPECT_THAT(refusalOfLoading(PALPATE_STRAY), HasSubstr("it is a part of Palpate of unknown version, and this is "));
  EXPECT_THAT(refusalOfLoading(PALPATE_OLD_STRAY),
              AllOf(HasSubstr("it is a part of Palpate 0.0.0, and this is "),
                    EndsWith("take the program and the folder lib/palpate from one build")));
}

TEST(Module, WithoutItsTableIsRefused) {
  EXPECT_THAT(refusalOfLoading(moduleFile("sample"), "palpate_embree"),
              HasSubstr("sample.so: it has no palpate_embree"));
}

TEST(MappedLibraries, AreThoseOfThisProgram) {
  const std::vector<std::string> names = mappedLibraries();
  EXPECT_THAT(names, Contains("libc.so.6").Times(1));
  EXPECT_THAT(names, Contains(StartsWith("libstdc++.so")).Times(1));
  EXPECT_THAT(names, Not(Contains(HasSubstr("/"))));
}

}  // namespace module_test
}  // namespace palpate
