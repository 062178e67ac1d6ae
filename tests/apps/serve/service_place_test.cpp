// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/service_place.hpp"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/error.hpp"
#include "service/channel/usual_socket.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace service_place_test {

using testing::HasSubstr;
using testing::StartsWith;

class ServicePlace : public testing::Test {
 protected:
  ~ServicePlace() override {
    for (const char* name : {"XDG_RUNTIME_DIR", "XDG_STATE_HOME"}) unsetenv(name);
    setenv("HOME", home_.c_str(), 1);
  }
  std::string home_ = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "/";
  TemporaryFolder folder_;
};

TEST_F(ServicePlace, LiesInTheRuntimeFolder) {
  setenv("XDG_RUNTIME_DIR", "/run/user/7", 1);
  EXPECT_EQ(usualSocket(), "/run/user/7/palpate/service.sock");
  for (const char* none : {"", "relative"}) {
    setenv("XDG_RUNTIME_DIR", none, 1);
    EXPECT_THAT(usualSocket(), StartsWith("/tmp/palpate-"));
  }
}

TEST_F(ServicePlace, IsThisUsersAlone) {
  setenv("XDG_RUNTIME_DIR", (folder_.path() / "run").c_str(), 1);
  makeSocketFolder(usualSocket());
  struct stat facts {};
  ASSERT_EQ(lstat((folder_.path() / "run/palpate").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0700U);
  makeSocketFolder(usualSocket());  // it is there already
  // A link that somebody else may have put there.
  std::filesystem::remove(folder_.path() / "run/palpate");
  std::filesystem::create_directory_symlink(folder_.path(), folder_.path() / "run/palpate");
  EXPECT_THAT(refusalOf([] { makeSocketFolder(usualSocket()); }, Error::Code::kIo),
              HasSubstr("not this user's folder"));
  std::ofstream(folder_.path() / "file") << "x";
  EXPECT_THAT(refusalOf([&] { makeSocketFolder((folder_.path() / "file/below/s.sock").string()); }, Error::Code::kIo),
              HasSubstr("it cannot be made"));
}

// Services at different sockets have different journals.
TEST_F(ServicePlace, KeepsAJournalForEachSocket) {
  setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(usualServiceJournal("/run/a.sock"), "/state/palpate/services/_run_a.sock");
  EXPECT_EQ(usualServiceJournal("/run/./x/../a.sock"), usualServiceJournal("/run/a.sock"));
  EXPECT_NE(usualServiceJournal("/run/b.sock"), usualServiceJournal("/run/a.sock"));
  EXPECT_NE(usualServiceJournal("/a/b_c"), usualServiceJournal("/a_b/c"));
  EXPECT_NE(usualServiceJournal("/a_b_c"), usualServiceJournal("/a/b/c"));
  EXPECT_EQ(usualServiceJournal("/a/b/c"), "/state/palpate/services/_a_b_c");
  unsetenv("XDG_STATE_HOME");
  setenv("HOME", "/home/me", 1);
  EXPECT_EQ(usualServiceJournal("/a"), "/home/me/.local/state/palpate/services/_a");
  unsetenv("HOME");
  EXPECT_EQ(usualServiceJournal("/a"), "");
}

}  // namespace service_place_test
}  // namespace palpate
