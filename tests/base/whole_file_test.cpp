// SPDX-License-Identifier: Apache-2.0
#include "base/whole_file.hpp"

#include <cstring>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/as_nobody.hpp"
#include "tests/support/few_descriptors.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace whole_file_test {

using testing::HasSubstr;

class WholeFile : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& content) const {
    std::ofstream(folder_.path() / "a", std::ios::binary) << content;
    return folder_.path() / "a";
  }
  TemporaryFolder folder_;
};

TEST_F(WholeFile, IsReadAsItIs) {
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 20U, (std::size_t{3} << 20U) + 7}) {
    std::string content(bytes, 'x');
    if (bytes > 1) content[bytes / 2] = '\0';
    EXPECT_TRUE(wholeFile(file(content), "it", bytes) == content) << bytes;
  }
}

TEST_F(WholeFile, HasALargestSize) {
  EXPECT_THAT(refusalOf([&] { static_cast<void>(wholeFile(file("1234"), "the list", 3)); }), HasSubstr("the list has"));
}

// None of these is waited for, and none is read without an end.
TEST_F(WholeFile, IsAPlainFile) {
  const auto refused = [](const std::filesystem::path& path) {
    EXPECT_THAT(refusalOf([&] { static_cast<void>(wholeFile(path, "the list", 1000)); }),
                HasSubstr("the list is no plain file"))
        << path;
  };
  refused(folder_.path());
  refused("/dev/zero");
  refused("/dev/null");
  const std::filesystem::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  refused(pipe);
  std::filesystem::create_symlink("/dev/zero", folder_.path() / "link");
  refused(folder_.path() / "link");
}

// Another moment may have one: a supervisor starts again what ended so.
TEST_F(WholeFile, WantsADescriptor) {
  const std::filesystem::path there = file("words");
  const FewDescriptors none;
  EXPECT_THAT(refusalOf([&] { static_cast<void>(wholeFile(there, "the list", 1000)); }, Error::Code::kOutOfMemory),
              HasSubstr("the list cannot be opened (Too many open files); raise the limit"));
}

TEST_F(WholeFile, IsThereAndMayBeRead) {
  const auto refusal = [](const std::filesystem::path& path) {
    return refusalOf([&] { static_cast<void>(wholeFile(path, "the list", 1000)); }, Error::Code::kNotFound);
  };
  EXPECT_THAT(refusal(folder_.path() / "none"), HasSubstr("the list cannot be opened (No such file"));
  EXPECT_THAT(refusal(""), HasSubstr("cannot be opened"));
  std::filesystem::create_symlink("loop", folder_.path() / "loop");
  EXPECT_THAT(refusal(folder_.path() / "loop"), HasSubstr("cannot be opened"));
  // Another failure is the system's, and may pass: a socket cannot be opened.
  const Descriptor socket_there(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
  const std::filesystem::path listening = folder_.path() / "socket";
  std::strncpy(address.sun_path, listening.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(bind(socket_there.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_THAT(refusalOf([&] { static_cast<void>(wholeFile(listening, "the list", 1000)); }, Error::Code::kIo),
              HasSubstr("cannot be opened (No such device or address); see whether its disk can be reached"));
  const std::filesystem::path secret = file("secret");
  std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
  std::filesystem::permissions(secret, std::filesystem::perms::none);
  const AsNobody nobody;
  ASSERT_TRUE(nobody.isSet());
  EXPECT_THAT(refusal(secret), HasSubstr("Permission denied"));
}

}  // namespace whole_file_test
}  // namespace palpate
