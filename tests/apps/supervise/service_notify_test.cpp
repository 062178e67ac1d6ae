// SPDX-License-Identifier: Apache-2.0
// A datagram socket of the test's takes systemd's place. What it must get is in sd_notify(3).
#include "apps/supervise/service_notify.hpp"

#include <array>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "base/monotonic_clock.hpp"
#include "open_descriptors.hpp"
#include "refusal.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace service_notify_test {

using testing::AllOf;
using testing::Eq;
using testing::HasSubstr;
using testing::Optional;

constexpr std::array kVariables = {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"};

class ServiceNotifyTest : public testing::Test {
 protected:
  ServiceNotifyTest() { forget(); }
  ~ServiceNotifyTest() override { forget(); }

  // Listens at an address as NOTIFY_SOCKET has it.
  void listen(const std::string& address) {
    socket_ = Descriptor(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, address.data(), address.size());
    if (address[0] == '@') at.sun_path[0] = '\0';
    const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address.size());
    ASSERT_EQ(bind(socket_.get(), reinterpret_cast<const sockaddr*>(&at), bytes), 0) << std::strerror(errno);
    setenv("NOTIFY_SOCKET", address.c_str(), 1);
  }
  // The next message; empty: none came.
  [[nodiscard]] std::string received() const {
    std::array<char, 4096> bytes{};
    const ssize_t got = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    return got > 0 ? std::string(bytes.data(), static_cast<std::size_t>(got)) : "";
  }
  [[nodiscard]] std::string path() const { return (folder_.path() / "notify").string(); }

 private:
  static void forget() {
    for (const char* variable : kVariables) unsetenv(variable);
  }
  TemporaryFolder folder_;
  Descriptor socket_;
};

TEST_F(ServiceNotifyTest, DoesNothingWhereNobodyAsks) {
  const ServiceNotify notify;
  EXPECT_FALSE(notify.isWanted());
  EXPECT_FALSE(notify.ready());
  EXPECT_FALSE(notify.reloading());
  EXPECT_FALSE(notify.stopping());
  EXPECT_FALSE(notify.status("well"));
  EXPECT_FALSE(notify.watchdog());
  EXPECT_THAT(notify.watchdogPeriod(), Eq(std::nullopt));
}

TEST_F(ServiceNotifyTest, SendsEachMessageToAPath) {
  listen(path());
  const ServiceNotify notify;
  EXPECT_TRUE(notify.isWanted());
  const long open_before = openDescriptors();
  EXPECT_TRUE(notify.ready());
  EXPECT_EQ(received(), "READY=1");
  EXPECT_TRUE(notify.stopping());
  EXPECT_EQ(received(), "STOPPING=1");
  EXPECT_TRUE(notify.watchdog());
  EXPECT_EQ(received(), "WATCHDOG=1");
  EXPECT_TRUE(notify.status("2 volumes, 1 session"));
  EXPECT_EQ(received(), "STATUS=2 volumes, 1 session");
  EXPECT_EQ(received(), "");
  EXPECT_EQ(openDescriptors(), open_before);
}

TEST_F(ServiceNotifyTest, SendsToAnAbstractSocket) {
  listen(fmt::format("@palpate-test-{}", getpid()));
  EXPECT_TRUE(ServiceNotify().ready());
  EXPECT_EQ(received(), "READY=1");
}

TEST_F(ServiceNotifyTest, AReloadHasItsTime) {
  listen(path());
  const std::int64_t before_us = monotonicNow_ns() / 1000;
  EXPECT_TRUE(ServiceNotify().reloading());
  const std::int64_t after_us = monotonicNow_ns() / 1000;
  const std::string message = received(), begin = "RELOADING=1\nMONOTONIC_USEC=";
  ASSERT_TRUE(message.starts_with(begin)) << message;
  const std::int64_t said_us = std::stoll(message.substr(begin.size()));
  EXPECT_GE(said_us, before_us);
  EXPECT_LE(said_us, after_us);
}

TEST_F(ServiceNotifyTest, AStatusStaysOneMessage) {
  listen(path());
  EXPECT_TRUE(ServiceNotify().status("a file called \nMAINPID=1"));
  EXPECT_EQ(received(), "STATUS=a file called ?MAINPID=1");
}

TEST_F(ServiceNotifyTest, GoesOnWhereNobodyListens) {
  setenv("NOTIFY_SOCKET", path().c_str(), 1);
  const ServiceNotify notify;
  EXPECT_TRUE(notify.isWanted());
  EXPECT_FALSE(notify.ready());
}

TEST_F(ServiceNotifyTest, RefusesWhatIsNoAddress) {
  for (const std::string& address : {std::string("notify"), std::string("@"), std::string("vsock:2:1234"),
                                     "/" + std::string(sizeof(sockaddr_un::sun_path), 'x')}) {
    setenv("NOTIFY_SOCKET", address.c_str(), 1);
    EXPECT_THAT(refusalOf([] { const ServiceNotify notify; }),
                AllOf(HasSubstr("NOTIFY_SOCKET: '" + address + "'"), HasSubstr("unset it")));
  }
}

TEST_F(ServiceNotifyTest, KnowsTheLongestAddress) {
  // One byte of sun_path is left, so the address is a C string too.
  std::string address = fmt::format("@palpate-test-{}-", getpid());
  address.resize(sizeof(sockaddr_un::sun_path) - 1, 'x');
  listen(address);
  EXPECT_TRUE(ServiceNotify().ready());
  EXPECT_EQ(received(), "READY=1");
}

TEST_F(ServiceNotifyTest, TheWatchdogIsForOneProcess) {
  setenv("WATCHDOG_USEC", "20000000", 1);
  EXPECT_THAT(ServiceNotify().watchdogPeriod(), Optional(std::chrono::microseconds(20'000'000)));
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_THAT(ServiceNotify().watchdogPeriod(), Optional(std::chrono::microseconds(20'000'000)));
  setenv("WATCHDOG_PID", std::to_string(getppid()).c_str(), 1);
  EXPECT_THAT(ServiceNotify().watchdogPeriod(), Eq(std::nullopt));
}

TEST_F(ServiceNotifyTest, RefusesAWatchdogThatIsNoNumber) {
  for (const char* text : {"soon", "0", "-5", "3s", "99999999999999999999"}) {
    setenv("WATCHDOG_USEC", text, 1);
    EXPECT_THAT(refusalOf([] { const ServiceNotify notify; }), HasSubstr("WATCHDOG_USEC: '" + std::string(text) + "'"));
  }
}

}  // namespace service_notify_test
}  // namespace palpate
