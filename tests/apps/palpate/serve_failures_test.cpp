// SPDX-License-Identifier: Apache-2.0
// `palpate serve`, `servo` and `top`: processes that come, stand still and go, and devices that are lost.
#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "base/descriptor.hpp"
#include "served_sphere.hpp"
#include "service/messages/message_channel.hpp"

namespace palpate {
namespace serve_failures_test {

using testing::HasSubstr;

class ServeFailures : public ServedSphere {};

// A chain that is felt no more as soon as another one is ready is asked for again meanwhile: the last word counts.
TEST_F(ServeFailures, TheLastFiltersCount) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  MessageChannel client(connectTo((file("run") / "palpate/service.sock").string()), "the service");
  std::uint64_t number = 0;
  const auto askFor = [&](const std::string& chain) {
    wire::AskT ask = asking(wire::Verb::Filter);
    ask.number = ++number;
    ask.words = {chain};
    client.send(std::move(ask));
    return number;
  };
  const auto answer = [&] { return client.expect<wire::AnswerT>(60'000).first; };
  const std::uint64_t first = askFor("gaussian:1");
  bool first_is_answered = false, second_is_done = false;
  while (!second_is_done) {
    const std::uint64_t second = askFor("");
    for (bool heard = false; !heard;) {
      const wire::AnswerT one = answer();
      if (one.number == first) first_is_answered = true;
      heard = one.number == second;
      second_is_done = heard && !one.refusal;
    }
  }
  if (!first_is_answered) {
    EXPECT_EQ(answer().number, first);
  }
  EXPECT_EQ(ctl({"get", "filter"}).out, "filter = \n");
  EXPECT_GE(status()["engines"], 3);
}

// The servo is killed: the engine goes on, a new servo joins. A second one is turned away.
TEST_F(ServeFailures, ServosComeAndGo) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  join();
  ASSERT_TRUE(awaitServo());
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::ContainsRegex("\non +0 "));  // no rate before a second look
  RunningProgram second(PALPATE_PROGRAM, {"servo", "--connect"}, folder(), "second.log");  // to the usual socket
  EXPECT_TRUE(awaitSaid("a second servo (process "));
  EXPECT_TRUE(awaitSaid("the service: another servo touches its volume already", "second.log"))
      << contentsOf(file("second.log"));
  EXPECT_THAT(contentsOf(file("second.log")), testing::Not(HasSubstr("is gone")));
  EXPECT_EQ(status()["servos"], 1);
  servo.end(SIGKILL);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servos"] >= 2 && now["windows"] > 0; }));  // the second
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  EXPECT_EQ(WEXITSTATUS(second.end(SIGTERM)), 0);  // in good order
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servo"] == 0; }));
  expectSuccess(ctl({"undo"}));
}

// Stopped and let go on, as by a debugger or a driver that hangs: no servo is lost, and no edit. The servo's log says
// why there is no force; the engine cannot.
TEST_F(ServeFailures, AStoppedEngineGoesOn) {
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; }));
  if (contentsOf(file("servo.log")).find("sends no windows") != std::string::npos)
    std::this_thread::sleep_for(std::chrono::seconds(11));  // a slow machine; it is told again after ten
  write("servo.log", "");
  engine.send(SIGSTOP);
  ASSERT_TRUE(awaitSaid("sends no windows", "servo.log"));
  engine.send(SIGCONT);
  EXPECT_TRUE(awaitSaid("sends windows again; they were stale for ", "servo.log"));
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; }));
  EXPECT_EQ(status()["servos"], 1);
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
}

// A terminal that closes takes no force away: the servo that was started in it goes on.
TEST_F(ServeFailures, AServoOutlivesAHangUp) {
  join();
  ASSERT_TRUE(awaitSaid("waiting for an engine", "servo.log"));
  killpg(servo.id(), SIGHUP);  // as the kernel sends it: to all of the terminal's group
  serve({kServedSphere});
  EXPECT_TRUE(awaitServo()) << contentsOf(file("servo.log"));
  killpg(servo.id(), SIGHUP);
  const double tick = status()["tick"];
  EXPECT_TRUE(await([&](const nlohmann::json& now) { return now["tick"] > tick; })) << contentsOf(file("servo.log"));
  EXPECT_FALSE(servo.hasEnded());
}

// A servo that stands still is there, but its pose grows old.
TEST_F(ServeFailures, AnOldPoseIsTold) {
  serve({kServedSphere});
  join();
  ASSERT_TRUE(awaitServo());
  servo.send(SIGSTOP);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["pose_age_ms"] > 500; }));
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::ContainsRegex("\non .* old "));
  servo.send(SIGCONT);
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["pose_age_ms"] < 100; }));
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::Not(HasSubstr(" old ")));
}

// However long it takes: it says that it waits, and then it has its answer.
TEST_F(ServeFailures, AClientWaitsAndSaysSo) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  engine.send(SIGSTOP);
  RunningProgram client(PALPATE_PROGRAM, {"ctl", "get", "servo.n"}, folder(), "ctl.log");
  EXPECT_TRUE(awaitSaid("the service has not answered yet; Ctrl-C ends the wait", "ctl.log"));
  EXPECT_FALSE(client.hasEnded());
  engine.send(SIGCONT);
  EXPECT_TRUE(awaitSaid("servo.n = 5", "ctl.log"));
}

// A servo whose device is not there says so once, and does not flood the terminal.
TEST_F(ServeFailures, SaysOnceWhyThereIsNoServo) {
  serve({kServedSphere, "--device", "polhem-v1", "--current-limit", "3"});
  ASSERT_TRUE(awaitService());
  join();
  for (const char* log : {"serve.log", "servo.log"})
    ASSERT_TRUE(awaitSaid("none of this machine's HID devices is one", log)) << log;
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));  // it tries again
  for (const char* log : {"serve.log", "servo.log"}) {
    const std::string said = contentsOf(file(log));
    const std::size_t first = said.find("none of this machine's HID devices is one");
    EXPECT_NE(first, std::string::npos) << log << said;
    EXPECT_EQ(said.find("none of this machine's HID devices is one", first + 1), std::string::npos) << log << said;
  }
}

// What the device cannot bear is told when a servo joins, and to who sets it; an unstable contact, too, as it ends.
TEST_F(ServeFailures, WarnsOfWhatADeviceCannotBear) {
  serve({kServedSphere, "--hand", "spring", "--stiffness", "20000"});
  join();
  ASSERT_TRUE(awaitServo());
  EXPECT_TRUE(awaitSaid("a stiffness of 20000 N/m is more than this device can render"));
  EXPECT_TRUE(awaitSaid("the servo: unstable: ")) << contentsOf(file("serve.log"));
  const Outcome set = ctl({"set", "servo.stiffness_N_per_m", "30000"});
  expectSuccess(set);
  EXPECT_THAT(set.out, HasSubstr("servo.stiffness_N_per_m = 30000\na stiffness of 30000 N/m is more than"));
  EXPECT_EQ(ctl({"set", "servo.stiffness_N_per_m", "500"}).out, "servo.stiffness_N_per_m = 500\n");
}

// One command for both: whoever dies is started again, and the service ends with its engine's good end.
TEST_F(ServeFailures, IsSupervised) {
  writePress();
  serve({kServedSphere, "--path", "press.csv", "--fade", "0.05", "--stale", "0.1", "--supervise"});
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.3; })) << contentsOf(file("serve.log"));
  expectSuccess(ctl({"edit", "add:radius=2mm:at=-12,-12,-12mm"}));
  const auto killChild = [&](const std::string& name) {
    const Outcome outcome = runPalpate({.arguments = {"-c", fmt::format("pkill -KILL -P {} -x {}", engine.id(), name)},
                                        .program = "/bin/sh",
                                        .folder = folder()});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  };
  killChild("palpate-servo");
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["servos"] >= 2 && now["force_N"] > 0.3; }));
  killChild("palpate");
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["edits"] == 1 && now["force_N"] > 0.3; }))
      << contentsOf(file("serve.log"));
  EXPECT_THAT(ctl({"metrics"}).out, HasSubstr("palpate_servo 1\n"));
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(engine.hasEnded()) << contentsOf(file("serve.log"));
}

// It says that the service has gone, and goes on with the next one.
TEST_F(ServeFailures, IsWatchedFromEngineToEngine) {
  serve({kServedSphere});
  ASSERT_TRUE(awaitService());
  RunningProgram top(PALPATE_PROGRAM, {"top", "--every", "0.05"}, folder(), "top.log");
  const auto told = [&](const std::string& words, std::size_t times) {
    for (int look = 0; look < 1200; ++look) {
      const std::string text = contentsOf(file("top.log"));
      std::size_t found = 0;
      for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++found;
      if (found >= times) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  };
  EXPECT_TRUE(told("off  ", 3)) << contentsOf(file("top.log"));
  join();
  EXPECT_TRUE(told("on   ", 3)) << contentsOf(file("top.log"));
  servo.end(SIGKILL);
  engine.end(SIGKILL);
  EXPECT_TRUE(told("has ended; Ctrl-C ends the wait", 1)) << contentsOf(file("top.log"));
  write("top.log", "");
  serve({kServedSphere});
  EXPECT_TRUE(told("off  ", 2)) << contentsOf(file("top.log"));
  engine.send(SIGSTOP);
  EXPECT_TRUE(told("does not answer", 1)) << contentsOf(file("top.log"));
  engine.send(SIGCONT);
  EXPECT_EQ(WEXITSTATUS(top.end(SIGINT)), 130);
}

// systemd hears when it is ready, what it serves, that it lives, and that it ends. One that stands still says nothing.
TEST_F(ServeFailures, TellsSystemdThatItLives) {
  const std::string path = file("notify.sock").string();
  const Descriptor inbox(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(inbox.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  setenv("WATCHDOG_USEC", "400000", 1);
  serve({kServedSphere});
  unsetenv("NOTIFY_SOCKET");
  unsetenv("WATCHDOG_USEC");
  std::vector<std::string> said;
  const auto listen = [&] {
    char message[512];
    for (ssize_t count = 0; (count = recv(inbox.get(), message, sizeof message, 0)) > 0;)
      said.emplace_back(message, static_cast<std::size_t>(count));
    return std::ranges::count(said, "WATCHDOG=1");
  };
  for (int look = 0; look < 1200 && listen() < 3; ++look) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  ASSERT_GE(said.size(), 5U);
  EXPECT_EQ(said[0], "READY=1");
  EXPECT_THAT(said[1], HasSubstr("STATUS=phantom:sphere?size=32 is served at "));
  engine.send(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // what it said before has come
  const auto before = listen();
  std::this_thread::sleep_for(std::chrono::milliseconds(900));
  EXPECT_EQ(listen(), before);
  engine.send(SIGCONT);
  for (int look = 0; look < 1200 && listen() == before; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GT(listen(), before);
  expectSuccess(ctl({"stop"}));
  for (int look = 0; look < 200 && !engine.hasEnded(); ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  listen();
  EXPECT_EQ(said.back(), "STOPPING=1");
}

}  // namespace serve_failures_test
}  // namespace palpate
