// SPDX-License-Identifier: Apache-2.0
// A broker hands over connections and open files, does nothing else, and ends with whoever made it. Truth: what is done
// with what it hands over, and what the kernel says of its process.
#include "service/broker/broker.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "service/messages/message.hpp"
#include "tests/support/few_descriptors.hpp"
#include "tests/support/without_call.hpp"

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
  const Descriptor file(fcntl(STDERR_FILENO, F_DUPFD, 200));  // without FD_CLOEXEC
  Broker broker({.open = [](const std::string& path) {
    if (path == "dumpable") return Descriptor(prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) == 0 ? dup(0) : -1);
    int others = 0;
    for (int number = 4; number < 256; ++number) others += fcntl(number, F_GETFD) >= 0 ? 1 : 0;
    return Descriptor(others == 0 ? dup(0) : -1);
  }});
  EXPECT_TRUE(broker.open("descriptors"));
  EXPECT_TRUE(broker.open("dumpable"));
  EXPECT_EQ(statusLine(child(), "NoNewPrivs"), "1");
}

// Not even those that a servo keeps for its real time.
TEST(Broker, HasNoCapabilities) {
  constexpr const char* kNone = "0000000000000000";
  if (statusLine(getpid(), "CapPrm") == kNone) GTEST_SKIP() << "whoever runs the tests has none to give up";
  Broker broker({.open = openForReading});
  ASSERT_TRUE(broker.open("/proc/self/status"));
  for (const char* set : {"CapInh", "CapPrm", "CapEff", "CapAmb"}) EXPECT_EQ(statusLine(child(), set), kNone) << set;
  EXPECT_NE(statusLine(getpid(), "CapPrm"), kNone);
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

// Words between a test and a broker, which has no descriptor of the test's.
struct Shared {
  std::atomic<int> broker{0};  // its process, once it is at work
  std::atomic<bool> goes_on{false};
};

Shared& freshShared() {
  void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return *new (memory) Shared;
}

// A servo that is killed, whose broker does `work` when it is asked to. How the broker ended, as waitpid(2) has it; -1:
// it did not, and is killed. This process becomes the broker's parent then.
int endAfterItsServo(const std::function<void()>& begins, const std::function<void(Shared&)>& work) {
  Shared& shared = freshShared();
  prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
  const pid_t servo = fork();
  if (servo == 0) {
    begins();
    Broker broker({.open = [&](const std::string&) -> Descriptor {
      work(shared);
      return {};
    }});
    try {
      static_cast<void>(broker.open("work"));
    } catch (const Error&) {
    }
    while (true) pause();
  }
  while (shared.broker == 0 && waitpid(servo, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(servo, SIGKILL);
  waitpid(servo, nullptr, 0);
  int status = -1;
  const pid_t broker = shared.broker;
  for (int look = 0; look < 10'000 && broker > 0 && waitpid(broker, &status, WNOHANG) == 0; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  if (status == -1 && broker > 0) {
    kill(broker, SIGKILL);
    waitpid(broker, nullptr, 0);
  }
  return status;
}

// Where no call closes all that is open, and nobody kills it: its own end of the connection was the only one to close.
TEST(Broker, EndsWithAServoThatIsKilledOnAnOldKernel) {
  EXPECT_EQ(endAfterItsServo([] { loseCall(SYS_close_range, ENOSYS); },
                             [](Shared& shared) {
                               prctl(PR_SET_PDEATHSIG, 0, 0, 0, 0);
                               int others = 0;
                               for (int number = 4; number < 256; ++number)
                                 others += fcntl(number, F_GETFD) >= 0 ? 1 : 0;
                               shared.broker = others == 0 ? getpid() : -1;
                             }),
            0);
}

TEST(Broker, IsKilledWithItsServoWhereItHangs) {
  const int status = endAfterItsServo([] {},
                                      [](Shared& shared) {
                                        shared.broker = getpid();
                                        while (true) pause();
                                      });
  EXPECT_TRUE(status != -1 && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
}

// The thread that talks with an engine asks it every some milliseconds, while another one may wait for an answer.
TEST(Broker, WhetherItIsGoneWaitsForNobody) {
  Shared& shared = freshShared();
  Broker broker({.open = [&](const std::string& path) {
    shared.broker = getpid();
    while (!shared.goes_on) std::this_thread::yield();
    return openForReading(path);
  }});
  std::jthread asks([&] { EXPECT_TRUE(broker.open("/proc/self/status")); });
  while (shared.broker == 0) std::this_thread::yield();
  EXPECT_FALSE(broker.isGone());  // with a lock: for ten seconds, and then it is
  shared.goes_on = true;
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

// So a supervisor starts the servo again: another moment may have what this one lacks.
bool isOutOfMemory(const std::string& words) {
  try {
    const Broker broker({.open = openForReading});
  } catch (const Error& error) {
    return error.code() == Error::Code::kOutOfMemory && std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

// The limit counts all processes of a user, but for root.
TEST(Broker, OneThatCannotBeStartedIsTold) {
  const pid_t tries = fork();
  if (tries == 0) {
    constexpr uid_t kNobody = 65534;
    const rlimit none = {0, 0};
    if (geteuid() == 0 && setresuid(kNobody, kNobody, kNobody) != 0) _exit(2);
    if (setrlimit(RLIMIT_NPROC, &none) != 0) _exit(3);
    _exit(isOutOfMemory("no process can be started for it") ? 0 : 1);
  }
  int status = -1;
  waitpid(tries, &status, 0);
  EXPECT_EQ(status, 0);
  const FewDescriptors few(1);
  EXPECT_TRUE(isOutOfMemory("no socket can be made"));
}

}  // namespace broker_test
}  // namespace palpate
