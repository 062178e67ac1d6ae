// SPDX-License-Identifier: Apache-2.0
// `palpate servo` with an emulated arm, beside an engine: how its force ends when it is told to end, and what it says
// of a current that no board of a kind may have.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <sys/wait.h>

#include "emulated_program.hpp"
#include "service_processes.hpp"

namespace palpate {
namespace hid_servo_test {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr double kFade_s = 0.4;
// What half a milliampere of each motor makes (tests/hid/hid_faults_test.cpp).
constexpr double kRounding_N = 0.02;

struct Moment {
  double time_s;
  Vec3 force_D;
};

class HidServo : public EmulatedHid {
 protected:
  HidServo() {
    for (const auto& [name, folder] : kFolders) {
      std::filesystem::create_directories(file(folder));
      setenv(name, file(folder).c_str(), 1);
    }
    leaveCheckedMotors(file("state"));
  }
  ~HidServo() override {
    for (const auto& [name, folder] : kFolders) unsetenv(name);
  }

  void serve(const Words& options) {
    engine_ =
        RunningProgram(PALPATE_PROGRAM, Words{"serve", "phantom:sphere?size=64"} + options, folder(), "serve.log");
  }
  void join(const Words& machine, const Words& options) {
    arm_ = RunningProgram(PALPATE_EMULATE_HID,
                          machine +
                              Words{"--paced", "--at", "0,0,0", "--", PALPATE_PROGRAM, "servo", "--connect",
                                    (file("run") / "palpate/service.sock").string(), "--calibrated"} +
                              options,
                          folder(), "servo.log");
  }
  // Which becomes the servo; 0: it is not there.
  [[nodiscard]] pid_t servo() const {
    std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", arm_.id()));
    pid_t child = 0;
    children >> child;
    return child;
  }
  [[nodiscard]] bool presses() const {
    for (int look = 0; look < 1000; ++look) {
      const Outcome outcome = run({"ctl", "status"});
      const Json now = outcome.status == 0 ? Json::parse(outcome.out) : Json();
      if (now.is_object() && now["force_N"] > 0.3) return true;
      std::this_thread::sleep_for(milliseconds(20));
    }
    return false;
  }
  [[nodiscard]] bool awaitSaid(const std::string& words) const {
    for (int look = 0; look < 1000; ++look) {
      if (contentsOf(file("servo.log")).find(words) != std::string::npos) return true;
      std::this_thread::sleep_for(milliseconds(20));
    }
    return false;
  }
  // Its exit status; -1: a signal ended it.
  [[nodiscard]] int endServo() {
    if (const pid_t id = servo(); id > 0) kill(id, SIGTERM);
    const int status = arm_.end(0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::vector<Moment> forces() const {
    std::istringstream in(contentsOf(file("forces.csv")));
    std::vector<Moment> moments;
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
      double time_us = 0;
      Vec3 force_D;
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &time_us, &force_D.x(), &force_D.y(), &force_D.z()) == 4)
        moments.push_back({1e-6 * time_us, force_D});
    }
    return moments;
  }

  RunningProgram engine_, arm_;

 private:
  static constexpr std::pair<const char*, const char*> kFolders[] = {
      {"XDG_RUNTIME_DIR", "run"}, {"XDG_STATE_HOME", "state"}, {"XDG_CONFIG_HOME", "config"}};
};

// The moments from the last whole force on to the first without any. Empty: reports came too late for anything to be
// said, as on a machine where the servo's thread had to wait.
std::vector<Moment> fadeOf(const std::vector<Moment>& all) {
  constexpr double kLongestGap_s = 0.01;
  std::size_t end = all.size();
  while (end > 0 && all[end - 1].force_D.isZero(0)) --end;
  if (end == 0 || end == all.size()) return {};
  double held_N = 0;
  for (std::size_t i = 0; i < end; ++i)
    if (all[i].time_s > all[end].time_s - 1) held_N = std::max(held_N, all[i].force_D.norm());
  std::size_t begin = end - 1;
  while (begin > 0 && all[begin].force_D.norm() < 0.95 * held_N) --begin;
  for (std::size_t i = begin + 1; i <= end; ++i) {
    const bool is_gap = all[i].time_s - all[i - 1].time_s > kLongestGap_s;
    const bool is_rest = i < end && all[i].force_D.isZero(0);  // the link's own, of a servo that said nothing
    if (is_gap || is_rest) return {};
  }
  return {all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end) + 1};
}

// SIGTERM while a hand is pushed: the force falls to nothing in a straight line over the fade time, in its own
// direction, as it does in a fault (tests/apps/held/held_starts_test.cpp has it tick by tick). Then the program ends
// well.
TEST_F(HidServo, ToldToEndItsForceFadesAsAFaultDoes) {
  writeWay("phantom:sphere?size=64", 4, 2, 0.7);  // and there the hand stays, pressing
  std::vector<Moment> fade;
  for (int attempt = 0; attempt < 8 && fade.empty(); ++attempt) {
    serve(kArmInTheMiddle + Words{"--stiffness", "400", "--slew-limit", "200", "--force-limit", "0.5", "--stall", "0.5",
                                  "--fade", fmt::format("{}", kFade_s)});
    join({"--path", "way.csv", "--forces", "forces.csv"}, {});
    ASSERT_TRUE(presses()) << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
    std::this_thread::sleep_for(milliseconds(4500));  // it has grown to the whole, and the way is over
    ASSERT_EQ(endServo(), 0) << contentsOf(file("servo.log"));
    engine_.end(SIGKILL);
    const std::vector<Moment> all = forces();
    ASSERT_FALSE(all.empty());
    ASSERT_TRUE(all.back().force_D.isZero(0)) << "it left a force of " << all.back().force_D.norm() << " N";
    fade = fadeOf(all);
  }
  ASSERT_FALSE(fade.empty()) << "the machine was too busy each time";
  EXPECT_THAT(contentsOf(file("servo.log")), HasSubstr("it was told to end: the force goes to zero"));
  const double held_N = fade.front().force_D.norm(), end_s = fade.back().time_s;
  const Vec3 direction_D = fade.front().force_D / held_N;
  EXPECT_GT(held_N, 0.3);
  // 5 % of the force may have been gone at the first of these moments. A busy machine makes it longer, never shorter.
  const double took_s = end_s - fade.front().time_s;
  EXPECT_GE(took_s, 0.95 * kFade_s - 0.02);
  // A report is late by some milliseconds, in which the force falls by 1.3 mN each.
  for (const Moment& moment : fade) {
    const double wanted_N = held_N * std::clamp((end_s - moment.time_s) / std::max(took_s, kFade_s), 0.0, 1.0);
    ASSERT_NEAR(moment.force_D.norm(), wanted_N, 0.06 * held_N + kRounding_N) << moment.time_s - end_s;
    ASSERT_LE((moment.force_D - moment.force_D.dot(direction_D) * direction_D).norm(), 2 * kRounding_N)
        << moment.time_s - end_s;
  }
}

// A kind with boards of 6 A and of 3 A, and a servo of 4 A: it says that whichever is plugged in gets no more than the
// weaker one bears. Nobody says --current-limit. That the current of each board is bounded by what is said is in
// tests/apps/servo_side/servo_ceilings_test.cpp, that no arm gets more than its current limit in
// tests/servo/devices/polhem_device_test.cpp.
TEST_F(HidServo, SaysThatEachBoardGetsWhatTheWeakestBears) {
  std::filesystem::create_directories(file("config/palpate/devices"));
  write("config/palpate/devices/a.toml",
        "[[device]]\nname = \"boards\"\nfamily = \"polhem-family\"\nwhat = \"of two boards\"\nusb = [{ id = "
        "\"1234:0006\", "
        "report_bytes = 14, current_limit_A = 6 }, { id = \"16c0:0486\", report_bytes = 64, current_limit_A = 3 }]\n");
  serve({"--device", "boards", "--place-at", "0,0,0", "--place-scale", "1"});
  join({}, {"--max-current", "4"});
  EXPECT_TRUE(awaitSaid("a current limit of 6 A, and gets 3 A (the weakest board of this kind bears 3 A)"))
      << contentsOf(file("servo.log"));
  EXPECT_EQ(endServo(), 0) << contentsOf(file("servo.log"));
}

// The device is unplugged and plugged in again beside an engine that lives. Without its broker a servo cannot open it:
// it says so and ends, so that whoever watches over it starts one that can. While the device is there it goes on.
TEST_F(HidServo, ADeviceThatIsBackWithoutABrokerEndsTheServo) {
  writeWay("phantom:sphere?size=64", 1, 2, 0.7);
  serve(kArmInTheMiddle + Words{"--stiffness", "400", "--force-limit", "0.5"});
  join({"--path", "way.csv", "--unplug-after", "12000", "--replug-ms", "500"}, {});
  ASSERT_TRUE(presses()) << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
  pid_t broker = 0;
  std::ifstream(fmt::format("/proc/{0}/task/{0}/children", servo())) >> broker;
  ASSERT_EQ(contentsOf(fmt::format("/proc/{}/comm", broker)), "palpate-broker\n");
  kill(broker, SIGKILL);
  for (int look = 0; look < 3000 && servo() > 0; ++look) std::this_thread::sleep_for(milliseconds(20));
  ASSERT_EQ(servo(), 0) << "it goes on without its device: " << contentsOf(file("servo.log"));
  const int status = arm_.end(0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << status;
  EXPECT_THAT(
      contentsOf(file("servo.log")),
      HasSubstr("the servo's broker: it is gone, and the device was to be opened again; start the servo again"));
}

}  // namespace hid_servo_test
}  // namespace palpate
