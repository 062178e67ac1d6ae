// SPDX-License-Identifier: Apache-2.0
// A broker hands over connections and open files, does nothing else, and ends with whoever made it. Truth: what is done
// with what it hands over, and what the kernel says of its process.
#include "service/broker/broker.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "service/messages/message.hpp"

namespace palpate {
namespace broker_test {

using testing::HasSubstr;

std::string errorIn(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

// The first child of this process; 0: it has none.
pid_t child() {
  std::ifstream children("/proc/thread-self/children");
  pid_t first = 0;
  children >> first;
  return first;
}

std::string statusLine(pid_t process, const std::string& key) {
  std::ifstream file("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(key + ":\t")) return line.substr(key.size() + 2);
  return {};
}

Descriptor openForReading(const std::string& path) {
  Descriptor opened(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!opened) throw Error(Error::Code::kNotFound, path, "it is not there", "make it");
  return opened;
}

TEST(Broker, HandsOverWhatItOpens) {
  Broker broker({.open = openForReading});
  const Descriptor opened = broker.open("/proc/self/status");  // of the process that opened it
  std::string text(4096, '\0');
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, read(opened.get(), text.data(), text.size()))));
  EXPECT_THAT(text, HasSubstr("Name:\tpalpate-broker\n"));
  EXPECT_NE(fcntl(opened.get(), F_GETFD) & FD_CLOEXEC, 0);
  EXPECT_EQ(errorIn([&] { static_cast<void>(broker.open("/there/is/none")); }),
            Error(Error::Code::kNotFound, "/there/is/none", "it is not there", "make it").what());
  EXPECT_FALSE(broker.isGone()) << "after a refusal";
  EXPECT_TRUE(broker.open("/proc/self/status"));
}

TEST(Broker, HandsOverAConnectionThatIsGreeted) {
  const std::string folder = [] {
    std::string name = (std::filesystem::temp_directory_path() / "palpate-broker-XXXXXX").string();
    return std::string(mkdtemp(name.data()));
  }();
  {
    const std::string path = folder + "/socket";
    Listener listener(path);
    Broker broker({.greet = [&path](std::uint64_t first_version) {
      Channel channel = connectTo(path);
      const auto byte = static_cast<std::byte>(first_version);
      static_cast<void>(channel.send({&byte, 1}, 0));
      return channel;
    }});
    Channel servo = broker.greet(7);
    Channel engine = listener.accept();
    Packet packet;
    ASSERT_EQ(engine.receive(packet, 5000), Channel::Got::kPacket);
    EXPECT_EQ(packet.bytes, std::vector{std::byte{7}});
    EXPECT_EQ(packet.sender, child()) << "the kernel names who greeted";
    EXPECT_EQ(engine.peer().process, child());
    ASSERT_TRUE(servo.send(packet.bytes, 0));
    ASSERT_EQ(engine.receive(packet, 5000), Channel::Got::kPacket);
    EXPECT_EQ(packet.sender, getpid()) << "and who speaks then";
  }
  std::filesystem::remove_all(folder);
}

TEST(Broker, DoesNothingElse) {
  Broker opens({.open = openForReading});
  EXPECT_THAT(errorIn([&] { static_cast<void>(opens.greet(1)); }), HasSubstr("what it does not do"));
  EXPECT_THAT(errorIn([&] { static_cast<void>(opens.open(std::string(5000, 'x'))); }), HasSubstr("are no path"));
  Broker greets({.greet = [](std::uint64_t) { return Channel(); }});
  EXPECT_THAT(errorIn([&] { static_cast<void>(greets.open("/proc/self/status")); }), HasSubstr("what it does not do"));
}

TEST(Broker, HasNoRightsAndNothingOpen) {
  const Descriptor file(open("/proc/self/status", O_RDONLY));  // without FD_CLOEXEC
  Broker broker({.open = [](const std::string& path) {
    if (path == "dumpable") return Descriptor(prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) == 0 ? dup(0) : -1);
    int others = 0;
    for (int number = 4; number < 256; ++number) others += fcntl(number, F_GETFD) >= 0 ? 1 : 0;
    return Descriptor(others == 0 ? dup(0) : -1);
  }});
  EXPECT_TRUE(broker.open("descriptors"));
  EXPECT_TRUE(broker.open("dumpable"));
  const pid_t process = child();
  EXPECT_EQ(statusLine(process, "NoNewPrivs"), "1");
  for (const char* set : {"CapInh", "CapPrm", "CapEff", "CapAmb"})
    EXPECT_EQ(statusLine(process, set), "0000000000000000") << set;
}

// Whoever ends a servo with Ctrl-C reaches its whole group; the servo still has to bring the force to zero.
TEST(Broker, EndsWithItsServoAndNotBefore) {
  pid_t process = 0;
  {
    Broker broker({.open = openForReading});
    process = child();
    ASSERT_GT(process, 0);
    ASSERT_TRUE(broker.open("/proc/self/status"));  // it has come so far as to heed no signals
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) kill(process, signal);
    EXPECT_TRUE(broker.open("/proc/self/status"));
  }
  EXPECT_EQ(kill(process, 0), -1) << "it is not even a zombie";
}

TEST(Broker, WhoIsGoneIsTold) {
  Broker broker({.open = openForReading});
  kill(child(), SIGKILL);
  for (int again = 0; again < 2; ++again)
    EXPECT_THAT(errorIn([&] { static_cast<void>(broker.open("/proc/self/status")); }),
                HasSubstr("the servo's broker: its process has ended; start the servo again"));
  EXPECT_TRUE(broker.isGone());
}

TEST(Broker, OneThatHangsIsTold) {
  Broker broker({.open = openForReading}, std::chrono::milliseconds(50));
  const pid_t process = child();
  kill(process, SIGSTOP);
  for (const char* how : {"does not answer", "has ended"})  // for an answer that comes later nobody listens
    EXPECT_THAT(errorIn([&] { static_cast<void>(broker.open("/proc/self/status")); }),
                HasSubstr(std::string("the servo's broker: its process ") + how));
  EXPECT_TRUE(broker.isGone());
  kill(process, SIGCONT);
}

// The limit counts all processes of a user, but for root.
TEST(Broker, OneThatCannotBeStartedIsTold) {
  const pid_t tries = fork();
  if (tries == 0) {
    constexpr uid_t kNobody = 65534;
    const rlimit none = {0, 0};
    if (geteuid() == 0 && setresuid(kNobody, kNobody, kNobody) != 0) _exit(2);
    if (setrlimit(RLIMIT_NPROC, &none) != 0) _exit(3);
    const std::string why = errorIn([] { const Broker broker({.open = openForReading}); });
    _exit(why.find("no process can be started for it") != why.npos ? 0 : 1);
  }
  int status = -1;
  waitpid(tries, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace broker_test
}  // namespace palpate
