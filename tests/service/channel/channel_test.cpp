// SPDX-License-Identifier: Apache-2.0
#include "service/channel/channel.hpp"

#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>

#include "tests/support/few_descriptors.hpp"
#include "tests/support/open_descriptors.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace channel_test {

using Got = Channel::Got;
using testing::HasSubstr;

std::vector<std::byte> bytesOf(std::string_view text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}
std::string textOf(const Packet& packet) {
  return {reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size()};
}

TEST(Channel, CarriesWholeMessagesInOrder) {
  auto [one, other] = channelPair();
  Packet packet;
  EXPECT_EQ(other.receive(packet, 0), Got::kNothing);
  EXPECT_TRUE(one.send(bytesOf("first"), 0));
  EXPECT_TRUE(one.send(bytesOf("second"), 0));
  EXPECT_TRUE(other.send(bytesOf("back"), 0));
  ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(textOf(packet), "first");
  ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(textOf(packet), "second");
  EXPECT_EQ(other.receive(packet, 0), Got::kNothing);
  ASSERT_EQ(one.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(textOf(packet), "back");
  EXPECT_FALSE(packet.attached);
}

TEST(Channel, CarriesTheLongestMessageAndNoneAbove) {
  auto [one, other] = channelPair();
  std::vector<std::byte> bytes(kMostMessageBytes, std::byte{42});
  EXPECT_TRUE(one.send(bytes, 0));
  Packet packet;
  ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(packet.bytes, bytes);
  bytes.emplace_back();
  EXPECT_THAT(refusalOf([&] { static_cast<void>(one.send(bytes, 0)); }), HasSubstr("65537 bytes"));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(one.send({}, 0)); }), HasSubstr("0 bytes"));
}

TEST(Channel, CarriesAFile) {
  const long before = openDescriptors();
  {
    auto [one, other] = channelPair();
    const Descriptor file(memfd_create("sent", MFD_CLOEXEC));
    ASSERT_EQ(write(file.get(), "hello", 5), 5);
    EXPECT_TRUE(one.send(bytesOf("a"), 0, file.get()));
    EXPECT_TRUE(one.send(bytesOf("b"), 0, file.get()));
    EXPECT_TRUE(one.send(bytesOf("c"), 0));
    Packet packet;
    ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
    ASSERT_TRUE(packet.attached);
    EXPECT_NE(fcntl(packet.attached.get(), F_GETFD) & FD_CLOEXEC, 0);
    char text[5] = {};
    ASSERT_EQ(pread(packet.attached.get(), text, 5, 0), 5);
    EXPECT_EQ(std::string(text, 5), "hello");
    ASSERT_EQ(other.receive(packet, 0), Got::kPacket);  // the one that nobody took is closed
    ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
    EXPECT_FALSE(packet.attached);
  }
  EXPECT_EQ(openDescriptors(), before);
}

// Whoever speaks on a connection, whoever made it.
TEST(Channel, NamesTheSenderOfEachMessage) {
  auto [ours, theirs] = channelPair();
  const std::byte word{1};
  Packet packet;
  ASSERT_TRUE(theirs.send({&word, 1}, 0));
  const pid_t child = fork();
  if (child == 0) _exit(theirs.send({&word, 1}, 0) ? 0 : 1);
  int status = 1;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  ASSERT_EQ(ours.receive(packet, 1000), Channel::Got::kPacket);
  EXPECT_EQ(packet.sender, getpid());
  EXPECT_FALSE(packet.attached);
  ASSERT_EQ(ours.receive(packet, 1000), Channel::Got::kPacket);
  EXPECT_EQ(packet.sender, child);
}

TEST(Channel, SaysThatTheOtherSideIsGone) {
  auto [one, other] = channelPair();
  EXPECT_TRUE(one.send(bytesOf("last"), 0));
  one.close();
  Packet packet;
  ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(textOf(packet), "last");
  EXPECT_EQ(other.receive(packet, -1), Got::kClosed);
  EXPECT_FALSE(other.send(bytesOf("nobody"), 1000));
  EXPECT_FALSE(Channel().send(bytesOf("nobody"), 1000));
  EXPECT_EQ(Channel().receive(packet, -1), Got::kClosed);
}

// A side that does not read is waited for as long as was said, and what it did not get is not sent in parts.
TEST(Channel, WaitsForRoomNoLongerThanItIsTold) {
  auto [one, other] = channelPair();
  const std::vector<std::byte> bytes(kMostMessageBytes, std::byte{1});
  int sent = 0;
  while (one.send(bytes, 0)) ++sent;
  EXPECT_GT(sent, 0);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_FALSE(one.send(bytes, 50));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(50));
  std::thread reader([&other = other] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    Packet packet;
    static_cast<void>(other.receive(packet, 0));
  });
  EXPECT_TRUE(one.send(bytes, -1));
  reader.join();
  Packet packet;
  for (int i = 0; i < sent; ++i) ASSERT_EQ(other.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(other.receive(packet, 0), Got::kNothing);
}

TEST(Channel, WaitsForAMessage) {
  auto [one, other] = channelPair();
  Packet packet;
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(other.receive(packet, 50), Got::kNothing);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(50));
  std::thread writer([&one = one] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_TRUE(one.send(bytesOf("there"), 0));
  });
  EXPECT_EQ(other.receive(packet, -1), Got::kPacket);
  EXPECT_EQ(textOf(packet), "there");
  writer.join();
}

// Who sends too much ends the connection, and leaves no file open here.
TEST(Channel, EndsWithWhoeverBreaksTheRules) {
  const long before = openDescriptors();
  const auto sendRaw = [](int socket, std::size_t bytes, std::size_t files) {
    std::vector<char> text(bytes, 'x'), control(CMSG_SPACE(files * sizeof(int)));
    iovec part{.iov_base = text.data(), .iov_len = text.size()};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    if (files > 0) {
      message.msg_control = control.data();
      message.msg_controllen = control.size();
      cmsghdr* const head = CMSG_FIRSTHDR(&message);
      head->cmsg_level = SOL_SOCKET;
      head->cmsg_type = SCM_RIGHTS;
      head->cmsg_len = CMSG_LEN(files * sizeof(int));
      for (std::size_t i = 0; i < files; ++i) std::memcpy(CMSG_DATA(head) + i * sizeof(int), &socket, sizeof socket);
    }
    return sendmsg(socket, &message, MSG_NOSIGNAL);
  };
  struct Case {
    std::size_t bytes, files;
  };
  for (const Case& c : {Case{kMostMessageBytes + 1, 0}, Case{10, 2}, Case{10, 4}, Case{10, 5}, Case{10, 200}}) {
    SCOPED_TRACE(testing::Message() << c.bytes << " bytes, " << c.files << " files");
    auto [one, other] = channelPair();
    ASSERT_EQ(sendRaw(one.descriptor(), c.bytes, c.files), static_cast<ssize_t>(c.bytes));
    Packet packet;
    EXPECT_EQ(other.receive(packet, 0), Got::kClosed);
    EXPECT_FALSE(other.open());
    EXPECT_FALSE(packet.attached);
  }
  EXPECT_EQ(openDescriptors(), before);
}

class Listening : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/palpate-channel-XXXXXX";
    folder_ = mkdtemp(name);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name = "socket") const { return folder_ / name; }
  std::filesystem::path folder_;
};

TEST_F(Listening, ConnectsThisUsersProcesses) {
  Listener listener(path());
  EXPECT_FALSE(listener.accept().open());
  Channel client = connectTo(path());
  Channel served = listener.accept();
  ASSERT_TRUE(served.open());
  EXPECT_EQ(served.peer().process, getpid());
  EXPECT_EQ(served.peer().user, getuid());
  EXPECT_TRUE(client.send(bytesOf("hello"), 0));
  Packet packet;
  EXPECT_EQ(served.receive(packet, 0), Got::kPacket);
  EXPECT_EQ(textOf(packet), "hello");
}

// Where no file can be opened a connection waits, and nobody who waits for the listener is woken for it again and
// again. Once there is room it is let in.
TEST_F(Listening, RestsWhereNoDescriptorIsLeft) {
  Listener listener(path());
  const Channel client = connectTo(path());
  ASSERT_GE(listener.descriptor(), 0);
  int woken = 0;
  {
    const FewDescriptors none;
    for (int i = 0; i < 20; ++i) {
      pollfd wait{listener.descriptor(), POLLIN, 0};
      if (poll(&wait, 1, 10) <= 0) continue;
      ++woken;
      EXPECT_FALSE(listener.accept().open());
      EXPECT_TRUE(listener.lacksDescriptors());
    }
  }
  EXPECT_GE(woken, 1);
  EXPECT_LE(woken, 3);  // in some 0.2 s
  pollfd wait{-1, POLLIN, 0};
  while (wait.fd < 0) wait.fd = listener.descriptor();
  EXPECT_EQ(poll(&wait, 1, 10'000), 1);
  EXPECT_TRUE(listener.accept().open());
  EXPECT_FALSE(listener.lacksDescriptors());
}

// As many as may wait do, and nobody is let in: that is told as what it is, after a while.
TEST_F(Listening, SaysThatNobodyIsLetIn) {
  Listener listener(path());
  std::vector<Channel> waiting;
  std::string words;
  while (words.empty()) {
    ASSERT_LT(waiting.size(), 100U);
    try {
      waiting.push_back(connectTo(path(), 50));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kDevice);
      words = error.what();
    }
  }
  EXPECT_THAT(words, HasSubstr("the service lets nobody in: its engine hangs, or still loads its volume"));
  // Whoever has patience is let in when somebody is.
  std::thread later([&] {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
    while (std::chrono::steady_clock::now() < end) std::this_thread::yield();
    static_cast<void>(listener.accept());
  });
  EXPECT_TRUE(connectTo(path(), 60'000).open());
  later.join();
}

TEST_F(Listening, IsForThisUserAlone) {
  const Listener listener(path());
  struct stat facts {};
  ASSERT_EQ(stat(path().c_str(), &facts), 0);
  EXPECT_TRUE(S_ISSOCK(facts.st_mode));
  EXPECT_EQ(facts.st_mode & 0777U, 0600U);
}

// Whatever the rights of folder and socket say.
class OtherUsers : public Listening {
 protected:
  static constexpr uid_t kNobody = 65534;
  void SetUp() override {
    if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
    Listening::SetUp();
    std::filesystem::permissions(folder_, std::filesystem::perms::all);
  }
  // A process of another user; its end is awaited. 0: `work` returned true.
  static int asNobody(const std::function<bool()>& work) {
    const pid_t child = fork();
    if (child == 0) {
      bool done = setgid(kNobody) == 0 && setuid(kNobody) == 0;
      try {
        done = done && work();
      } catch (const std::exception&) {
        done = false;
      }
      _exit(done ? 0 : 1);
    }
    int status = -1;
    waitpid(child, &status, 0);
    return status;
  }
};

TEST_F(OtherUsers, AreNotServed) {
  Listener listener(path());
  std::filesystem::permissions(path(), std::filesystem::perms::all);
  // It gets through to the socket: root may listen there for everybody.
  EXPECT_EQ(asNobody([this] { return connectTo(path()).open(); }), 0);
  EXPECT_FALSE(listener.accept().open());
  const Channel ours = connectTo(path());
  EXPECT_TRUE(listener.accept().open());
}

TEST_F(OtherUsers, AreNotConnectedTo) {
  int ready[2], done[2];
  ASSERT_EQ(pipe(ready) | pipe(done), 0);
  std::thread other([&] {
    EXPECT_EQ(asNobody([&] {
                const Listener listener(path());
                char byte = 0;
                return write(ready[1], "r", 1) == 1 && read(done[0], &byte, 1) == 1;
              }),
              0);
    close(ready[1]);  // so that the test does not wait for a child that failed
  });
  char byte = 0;
  EXPECT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_THAT(refusalOf([this] { static_cast<void>(connectTo(path())); }), HasSubstr("user 65534 listens there"));
  EXPECT_EQ(write(done[1], "d", 1), 1);
  other.join();
  for (const int end : {ready[0], done[0], done[1]}) close(end);
}

TEST_F(Listening, TakesThePlaceOfOneThatDied) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path().c_str(), sizeof address.sun_path - 1);
  {
    const Descriptor dead(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
    ASSERT_EQ(bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  EXPECT_THAT(refusalOf([&] { static_cast<void>(connectTo(path())); }, Error::Code::kNotFound),
              HasSubstr("no service listens there"));
  {
    const Listener listener(path());
    EXPECT_TRUE(connectTo(path()).open());
    EXPECT_THAT(refusalOf([&] { const Listener second(path()); }, Error::Code::kIo),
                HasSubstr("somebody listens there already"));
    EXPECT_TRUE(connectTo(path()).open());  // the refusal took nothing away
  }
  EXPECT_FALSE(std::filesystem::exists(path()));
}

// A dead socket lies there, and several begin at once: one listens, the others are told so, and whoever connects then
// reaches it.
TEST_F(Listening, OfSeveralAtOnceOneGetsIt) {
  for (int round = 0; round < 200; ++round) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path().c_str(), sizeof address.sun_path - 1);
    {
      const Descriptor dead(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
      ASSERT_EQ(bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    }
    constexpr int kStarts = 3;
    std::vector<std::unique_ptr<Listener>> listeners(kStarts);
    std::vector<std::string> refusals(kStarts);
    std::atomic<int> ready = 0;
    {
      std::vector<std::jthread> starts;
      for (std::size_t i = 0; i < kStarts; ++i)
        starts.emplace_back([&, i] {
          ++ready;
          while (ready < kStarts) std::this_thread::yield();
          try {
            listeners[i] = std::make_unique<Listener>(path());
          } catch (const Error& error) {
            refusals[i] = error.what();
          }
        });
    }
    int listening = 0;
    for (std::size_t i = 0; i < kStarts; ++i) {
      if (!listeners[i]) {
        EXPECT_THAT(refusals[i], HasSubstr("somebody listens there already"));
        continue;
      }
      ++listening;
      const Channel client = connectTo(path());
      EXPECT_TRUE(listeners[i]->accept().open());
    }
    ASSERT_EQ(listening, 1);
  }
}

// What another has put in its place stays when it goes.
TEST_F(Listening, RemovesOnlyItsOwnSocket) {
  auto first = std::make_unique<Listener>(path());
  std::filesystem::rename(path(), path("moved"));
  const Listener second(path());
  Listener moved = std::move(*first);
  first.reset();
  EXPECT_TRUE(connectTo(path()).open());
  { const Listener gone = std::move(moved); }
  EXPECT_TRUE(connectTo(path()).open());
}

TEST_F(Listening, IsNotKeptWaitingByALockForEver) {
  const Descriptor folder(open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  ASSERT_EQ(flock(folder.get(), LOCK_EX), 0);
  EXPECT_THAT(refusalOf([&] { const Listener none(path()); }, Error::Code::kIo), HasSubstr("keeps its folder locked"));
  std::jthread unlocks([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    flock(folder.get(), LOCK_UN);
  });
  const Listener listener(path());
  EXPECT_TRUE(connectTo(path()).open());
}

TEST_F(Listening, LeavesAloneWhatIsNoSocket) {
  std::ofstream(path("file")) << "mine";
  EXPECT_THAT(refusalOf([&] { const Listener none(path("file")); }), HasSubstr("something else lies there"));
  EXPECT_TRUE(std::filesystem::exists(path("file")));
  std::filesystem::create_symlink(path("file"), path("link"));
  EXPECT_THAT(refusalOf([&] { const Listener none(path("link")); }), HasSubstr("something else lies there"));
  EXPECT_THAT(refusalOf([&] { const Listener none(path("no/folder")); }, Error::Code::kIo),
              HasSubstr("no socket can be made there"));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(connectTo(path("nothing"))); }, Error::Code::kNotFound),
              HasSubstr("palpate serve"));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(connectTo(path("file"))); }, Error::Code::kNotFound),
              HasSubstr("no service"));
  EXPECT_THAT(refusalOf([&] { const Listener none(std::string(108, 'x')); }), HasSubstr("1 to 107 bytes, not 108"));
  EXPECT_THAT(refusalOf([&] { const Listener none(""); }), HasSubstr("not 0"));
}

}  // namespace channel_test
}  // namespace palpate
