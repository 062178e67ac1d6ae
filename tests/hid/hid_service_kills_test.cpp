// SPDX-License-Identifier: Apache-2.0
// Engine, servo and clients of a service die or stand still at random moments while an emulated arm presses on the
// volume, again and again, and its journal is damaged or removed in between. Each time all that live must find each
// other again; in the end every edit that was answered must be in the volume, but for those that the service itself has
// said are lost by damage; and the arm must never have taken a force beyond the limit or the slew.
//
// PALPATE_SERVICE_KILLS: how often (6; `./dev kills` takes 100). PALPATE_KILLS_SEED: of the moments.
// PALPATE_KILLS_RESULTS: the folder that gets what was counted.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <random>

#include "apps/bench/bench_result.hpp"
#include "base/atomic_file.hpp"
#include "base/quantile.hpp"
#include "emulated_program.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/journal/recovery.hpp"
#include "service_processes.hpp"

namespace palpate {
namespace hid_service_kills_test {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr double kForceLimit_N = 0.5, kSlew_N_per_s = 200;
// What half a milliampere of each motor makes (tests/hid/hid_faults_test.cpp).
constexpr double kRounding_N = 0.02;

constexpr const char* kIntroduction =
    "An engine (`palpate serve`), a servo with an emulated arm by hidapi (`palpate servo`) and clients (`palpate ctl`) "
    "are killed (`kill -9`) or stopped for up to 0.7 s (SIGSTOP), or the engine's Vulkan device is lost, at random "
    "moments, while the arm presses on a sphere and clients edit. After each, the time is measured from the moment at "
    "which what died was started again (or the device was told to fail) until the engine answers and the servo reads "
    "its windows. In the end every edit that was answered must be in the volume. Between a kill and the next start a "
    "bit of the journal or of a checkpoint is turned: then no more edits may be missing than the service says it has "
    "lost, and the rest is looked for in the end; and its journal is removed while it works, which must lose nothing. "
    "The forces are those that the arms took, by their own account. "
    "After a stall of the servo a force must begin at nothing.";

std::string vulkanDevice() {
  const std::vector<gpu::GpuInfo> all = gpu::listGpus();
  return all.empty() ? "none" : fmt::format("{}, {}", all.front().name, all.front().driver);
}

int numberFrom(const char* name, int usual) {
  const char* const text = std::getenv(name);
  return text != nullptr ? std::atoi(text) : usual;
}

struct Event {
  std::string what;
  Clock::time_point since = Clock::now();  // what died has been started again, or what stays has met its failure
  double back_s = 0;                       // until all that live have found each other
};

class HidServiceKills : public EmulatedHid {
 protected:
  HidServiceKills() : random_(static_cast<unsigned>(numberFrom("PALPATE_KILLS_SEED", 1))) {
    for (const auto& [name, folder] : {std::pair("XDG_RUNTIME_DIR", "run"), std::pair("XDG_STATE_HOME", "state"),
                                       std::pair("XDG_CONFIG_HOME", "config")}) {
      std::filesystem::create_directories(file(folder));
      setenv(name, file(folder).c_str(), 1);
    }
    leaveCheckedMotors(file("state"));
    write("faults.json",
          std::string(R"({"file_format_version": "1.0.0", "layer": {"name": "VK_LAYER_palpate_faults", )") +
              R"("type": "GLOBAL", "api_version": "1.3.0", "implementation_version": "1", )" +
              R"("description": "loses the device", "library_path": ")" + PALPATE_FAULTS_LAYER + R"("}})");
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_palpate_faults", 1);
    setenv("VK_LAYER_PATH", ("/usr/share/vulkan/explicit_layer.d:" + folder().string()).c_str(), 1);
    setenv("PALPATE_VULKAN_FAULT", file("fault").c_str(), 1);
  }
  ~HidServiceKills() override {
    for (const char* name : {"XDG_RUNTIME_DIR", "XDG_STATE_HOME", "XDG_CONFIG_HOME", "VK_INSTANCE_LAYERS",
                             "VK_LAYER_PATH", "PALPATE_VULKAN_FAULT"})
      unsetenv(name);
  }

  int pick(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  void pause(int least_ms, int most_ms) { std::this_thread::sleep_for(milliseconds(pick(least_ms, most_ms))); }

  void serve() {
    engine_ =
        RunningProgram(PALPATE_PROGRAM,
                       Words{"serve", "phantom:sphere?size=64"} + kArmInTheMiddle +
                           Words{"--stiffness", "400", "--slew-limit", std::to_string(kSlew_N_per_s), "--force-limit",
                                 std::to_string(kForceLimit_N), "--stale", "0.1", "--fade", "0.05"},
                       folder(), "serve.log");
  }
  void join(const Words& options = {}) {
    const std::string servo = (std::filesystem::path(PALPATE_PROGRAM).parent_path() / "palpate-servo").string();
    ++servos_;
    arm_ = RunningProgram(
        PALPATE_EMULATE_HID,
        options + Words{"--paced", "--path", "way.csv", "--at", "0,0,0", "--slew", std::to_string(kSlew_N_per_s),
                        "--log", "arm" + std::to_string(servos_), "--", servo, "--connect",
                        (file("run") / "palpate/service.sock").string(), "--calibrated"},
        folder(), "servo.log");
  }
  void signalServo(int signal) const {
    static_cast<void>(
        runPalpate({.arguments = {"-c", fmt::format("pkill -{} -P {} -x palpate-servo", signal, arm_.id())},
                    .program = "/bin/sh",
                    .folder = folder()}));
  }
  [[nodiscard]] nlohmann::json status() const {
    const Outcome outcome = run({"ctl", "status"});
    return outcome.status == 0 ? nlohmann::json::parse(outcome.out) : nlohmann::json();
  }
  // Until the engine answers and the servo reads windows of this engine: since when, in seconds. Empty: never.
  [[nodiscard]] std::optional<double> awaitAll(Clock::time_point since = Clock::now()) const {
    const auto begin = Clock::now();
    while (Clock::now() - begin < std::chrono::seconds(60)) {
      const nlohmann::json now = status();
      if (now.is_object() && now["servo"] == 1 && now["windows"] > 0 && now["pose_age_ms"] < 100)
        return std::chrono::duration<double>(Clock::now() - since).count();
      std::this_thread::sleep_for(milliseconds(20));
    }
    return std::nullopt;
  }
  // A place of its own in free space, where nothing was.
  Vec3 nextPlace() {
    const int n = places_++;
    constexpr int kAlong = 19, kLayer = kAlong * kAlong;  // 3 mm apart, three layers below the sphere and three above
    EXPECT_LT(n, 6 * kLayer) << "there is no place left";
    const int layer = n / kLayer;
    return Vec3(-28 + 3 * (n % kAlong), -28 + 3 * (n / kAlong % kAlong), layer < 3 ? -29 + 3 * layer : 14 + 3 * layer) *
           1e-3;
  }
  static std::string editAt(const Vec3& place_W) {
    return fmt::format("add:radius=1.2mm:at={:g},{:g},{:g}mm", 1e3 * place_W.x(), 1e3 * place_W.y(), 1e3 * place_W.z());
  }
  void edit() {
    const Vec3 place_W = nextPlace();
    if (run({"ctl", "edit", editAt(place_W)}).status == 0) answered_.push_back(place_W);
  }

  Event trouble() {
    const Vec3 place_W = nextPlace();
    RunningProgram client(PALPATE_PROGRAM, {"ctl", "edit", editAt(place_W)}, folder(), "client.log");  // meanwhile
    pause(0, 40);
    Clock::time_point since;
    switch (pick(0, 9)) {
      case 0:
      case 1:
        engine_.end(SIGKILL);
        pause(0, 400);
        serve();
        return {"engine killed"};
      case 2:
        engine_.send(SIGSTOP);
        pause(20, 700);
        engine_.send(SIGCONT);
        return {"engine stopped for a while"};
      case 3:
        signalServo(SIGKILL);
        for (int look = 0; look < 500 && !arm_.hasEnded(); ++look) std::this_thread::sleep_for(milliseconds(10));
        join();
        return {"servo killed"};
      case 4:
        signalServo(SIGSTOP);
        pause(20, 700);
        signalServo(SIGCONT);
        return {"servo stopped for a while"};
      case 5:
        // At the next submission, whose ever it is. The engine is made anew in the same process.
        write("fault", "submit -4 0");
        since = Clock::now();
        edit();
        for (int look = 0; look < 500 && exists("fault"); ++look) std::this_thread::sleep_for(milliseconds(10));
        EXPECT_FALSE(exists("fault")) << "the device was not lost";
        EXPECT_FALSE(engine_.hasEnded()) << contentsOf(file("serve.log"));
        return {"Vulkan device lost", since};
      case 6:
      case 7:
        engine_.end(SIGKILL);
        damaged_ = damage();
        serve();
        return {"engine killed, files damaged"};
      case 8:
        std::filesystem::remove_all(folderOfJournal());
        return {"journal removed"};
      default:
        client.end(SIGKILL);
        return {"client killed"};
    }
  }

  [[nodiscard]] std::filesystem::path folderOfJournal() const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(file("state")))
      if (entry.path().filename() == "in-use") return entry.path().parent_path();
    return {};
  }
  // A bit in one of the files that the next engine begins with. What was damaged.
  std::string damage() {
    const std::filesystem::path folder = folderOfJournal(), journal = journalFile(countingJournal(folder));
    const std::filesystem::path checkpoint = checkpointFile(folder, static_cast<std::size_t>(pick(0, 1)));
    const bool is_checkpoint = pick(0, 3) == 0 && std::filesystem::exists(checkpoint);
    const std::filesystem::path hit = is_checkpoint ? checkpoint : journal;
    std::string bytes = contentsOf(hit);
    // Behind the header, if there is something: a journal that does not say of which volume it is is refused.
    const std::size_t first = is_checkpoint ? 0 : kHeader_bytes;
    if (first >= bytes.size()) return "";
    const std::size_t at = std::uniform_int_distribution<std::size_t>(first, bytes.size() - 1)(random_);
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << pick(0, 7)));
    std::ofstream(hit, std::ios::binary) << bytes;
    return is_checkpoint ? "checkpoint" : "journal";
  }
  // After a start from damaged files, or without its journal: what is missing must have been told, and the rest is
  // there.
  void expectToldOfLosses() {
    // A removed journal is noticed within a second, begun anew, and locked.
    const auto is_kept = [this] {
      const std::filesystem::path folder = folderOfJournal();
      return !folder.empty() && std::filesystem::exists(journalFile(folder)) && status()["journal_failed"] == 0;
    };
    for (int look = 0; look < 1000 && !is_kept(); ++look) std::this_thread::sleep_for(milliseconds(20));
    ASSERT_TRUE(is_kept()) << contentsOf(file("serve.log"));
    const nlohmann::json now = status();
    const std::string what = std::exchange(damaged_, "");
    if (what.empty()) return;
    const std::vector<Vec3> missing = missingIn("damaged.vdb");
    const std::size_t told = now["lost_records"];
    EXPECT_LE(missing.size(), what == "journal" ? told : 0) << what << "\n" << contentsOf(file("serve.log"));
    told_of_ += told;
    told_missing_ += missing.size();
    std::erase_if(answered_, [&](const Vec3& place_W) { return std::ranges::find(missing, place_W) != missing.end(); });
  }
  // Edits that were answered and are not in the volume, which is written to this file.
  [[nodiscard]] std::vector<Vec3> missingIn(const std::string& name) const {
    expectSuccess(run({"ctl", "save", name}));
    const Volume volume = loadVolume(file(name).string());
    EXPECT_LE(volume.density(Vec3(28, 28, 0) * 1e-3).value_or(1), 0);  // else the places would say nothing
    std::vector<Vec3> missing;
    for (const Vec3& place_W : answered_)
      if (volume.density(place_W).value_or(-1) <= 0) missing.push_back(place_W);
    return missing;
  }

  // What an arm took, as it says itself once its program has ended.
  [[nodiscard]] std::map<std::string, double> figuresOfArm(int number) const {
    std::istringstream in(contentsOf(file("arm" + std::to_string(number))));
    std::map<std::string, double> figures;
    std::string key;
    in >> key;
    for (double value = 0; in >> key >> value;) figures[key] = value;
    return figures;
  }
  void expectSafeForces() {
    for (int number = 1; number <= servos_; ++number) {
      std::map<std::string, double> figures = figuresOfArm(number);
      ASSERT_GT(figures["reports"], 0) << number;
      EXPECT_LE(figures["force_max_N"], kForceLimit_N + kRounding_N) << number;
      EXPECT_LE(figures["beyond_slew_N"], kRounding_N) << number;
      EXPECT_EQ(figures["left_600ms_N"], 0) << number;  // its watchdog
      largest_N_ = std::max(largest_N_, figures["force_max_N"]);
      steepest_N_ = std::max(steepest_N_, figures["beyond_slew_N"]);
    }
  }

  void writeFigures(const std::vector<Event>& events, std::size_t missing) const;

  std::mt19937 random_;
  RunningProgram engine_, arm_;
  int servos_ = 0, places_ = 0;
  std::vector<Vec3> answered_;
  static constexpr std::size_t kHeader_bytes = 300;  // of a phantom's journal, with room
  std::string damaged_;                              // "journal" or "checkpoint", before the last start; "": nothing
  std::size_t told_of_ = 0, told_missing_ = 0;       // records that are lost, as the service said, and edits
  double largest_N_ = 0, steepest_N_ = 0;
};

void HidServiceKills::writeFigures(const std::vector<Event>& events, std::size_t missing) const {
  const char* const folder = std::getenv("PALPATE_KILLS_RESULTS");
  if (folder == nullptr) return;
  BenchResult result = beginBench("service-kills", vulkanDevice());
  result.commit = run({"--version"}).out;  // "palpate 0.1.0 (0123456789)"
  result.commit = result.commit.substr(result.commit.find('(') + 1);
  result.commit.resize(result.commit.find(')'));
  result.command = fmt::format("./dev kills {}", events.size());
  std::map<std::string, std::vector<double>> kinds;
  std::vector<double> all;
  for (const Event& event : events) {
    kinds[event.what].push_back(event.back_s);
    all.push_back(event.back_s);
  }
  std::string table = fmt::format("{:30}{:>8}{:>20}{:>16}\n", "what", "times", "back, median [s]", "at most [s]");
  for (auto& [what, times] : kinds) {
    const double most = *std::ranges::max_element(times);
    table += fmt::format("{:30}{:>8}{:>20.2f}{:>16.2f}\n", what, times.size(), median(times), most);
    result.rows.push_back({{"part", "event"},
                           {"kind", what},
                           {"times", static_cast<std::int64_t>(times.size())},
                           {"back_median_s", median(times)},
                           {"back_most_s", most}});
  }
  result.rows.push_back({{"part", "all"},
                         {"events", static_cast<std::int64_t>(events.size())},
                         {"answered_edits", static_cast<std::int64_t>(answered_.size())},
                         {"records_lost_by_damage_and_told", static_cast<std::int64_t>(told_of_)},
                         {"answered_edits_lost_by_damage_and_told", static_cast<std::int64_t>(told_missing_)},
                         {"servos", servos_}});
  result.targets = {{"answered edits that are missing", static_cast<double>(missing), 0},
                    {"largest force that an arm took [N]", largest_N_, kForceLimit_N + kRounding_N},
                    {"largest rise of a force beyond the slew limit and the motors' rounding [N]",
                     std::max(0.0, steepest_N_ - kRounding_N), 0},
                    {"longest time until all that live were attached again [s]", *std::ranges::max_element(all), 2}};
  // A measuring run, not a test: its times are what it is for.
  for (const BenchTarget& target : result.targets) EXPECT_TRUE(target.holds()) << target.name << ": " << target.value;
  writeFileAtomically(std::filesystem::path(folder) / "service-kills.json", jsonText(result));
  writeFileAtomically(
      std::filesystem::path(folder) / "service-kills.md",
      benchPage(result,
                {.title = "What a service survives", .introduction = kIntroduction, .tables = table, .chart = {}}));
}

// Nobody wonders why there is no force: the service's status and log say that the arm exerts none.
TEST_F(HidServiceKills, AnUncalibratedArmIsTold) {
  writeWay("phantom:sphere?size=64", 4, 2, 0.7);
  serve();
  join({"--asks-from", "0"});  // its button was pressed before anybody looked
  const auto is_off = [this] {
    const nlohmann::json now = status();
    return now.is_object() && now["servo"] == 1 && now["force_off"] == 1;
  };
  for (int look = 0; look < 500 && !is_off(); ++look) std::this_thread::sleep_for(milliseconds(20));
  EXPECT_TRUE(is_off()) << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
  EXPECT_THAT(contentsOf(file("serve.log")), testing::HasSubstr("the servo: force-off: "));
  EXPECT_THAT(run({"top", "--count", "1"}).out, testing::ContainsRegex("\non .* off +[0-9]"));
}

// By the arm's account: while the engine says nothing there is no force, and it comes back without a jump.
TEST_F(HidServiceKills, WithoutAnEngineThereIsNoForce) {
  writeWay("phantom:sphere?size=64", 4, 2, 0.7);
  const auto presses = [this] {
    for (int look = 0; look < 1000; ++look) {
      if (const nlohmann::json now = status(); now.is_object() && now["force_N"] > 0.3) return true;
      std::this_thread::sleep_for(milliseconds(20));
    }
    return false;
  };
  for (const bool is_killed : {false, true}) {
    serve();
    join();
    ASSERT_TRUE(presses()) << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
    if (is_killed) {
      engine_.end(SIGKILL);
    } else {
      engine_.send(SIGSTOP);
    }
    constexpr int kAway_ms = 1500;
    std::this_thread::sleep_for(milliseconds(kAway_ms));
    double start_s = 0;
    if (is_killed) {
      const auto begin = Clock::now();
      serve();
      while (!status().is_object() && Clock::now() - begin < std::chrono::seconds(60))
        std::this_thread::sleep_for(milliseconds(1));
      start_s = std::chrono::duration<double>(Clock::now() - begin).count();
    } else {
      engine_.send(SIGCONT);
    }
    ASSERT_TRUE(presses()) << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
    signalServo(SIGTERM);
    for (int look = 0; look < 500 && !arm_.hasEnded(); ++look) std::this_thread::sleep_for(milliseconds(10));
    // Less the age of a stale window (0.1 s), the fade (0.05 s) and the slew's way down (0.5 N at 200 N/s). A question
    // takes some 10 ms, in which the next engine may have a servo already.
    constexpr double kGoesOn_s = 0.1 + 0.05 + kForceLimit_N / kSlew_N_per_s, kQuestion_s = 0.05;
    EXPECT_GT(figuresOfArm(servos_)["without_s"], 1e-3 * kAway_ms - kGoesOn_s + start_s - kQuestion_s) << is_killed;
    engine_.end(SIGKILL);
  }
  expectSafeForces();
}

TEST_F(HidServiceKills, NothingAnsweredIsLostAndNoForceIsUnsafe) {
  writeWay("phantom:sphere?size=64", 4, 2, 0.7);
  serve();
  join();
  ASSERT_TRUE(awaitAll()) << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
  std::vector<Event> events;
  for (int i = 0; i < numberFrom("PALPATE_SERVICE_KILLS", 6); ++i) {
    for (int edits = pick(0, 2); edits > 0; --edits) edit();
    pause(0, 200);
    Event event = trouble();
    const std::optional<double> back_s = awaitAll(event.since);
    ASSERT_TRUE(back_s) << event.what << "\n" << contentsOf(file("serve.log")) << contentsOf(file("servo.log"));
    event.back_s = *back_s;
    events.push_back(event);
    ASSERT_NO_FATAL_FAILURE(expectToldOfLosses());
  }
  edit();
  ASSERT_FALSE(answered_.empty());
  // The forces say something only if the arm has pressed.
  const auto presses = [this] {
    const nlohmann::json now = status();
    return now.is_object() && now["force_N"] > 0.3;
  };
  for (int look = 0; look < 1000 && !presses(); ++look) std::this_thread::sleep_for(milliseconds(20));
  const std::size_t missing = missingIn("end.vdb").size();
  EXPECT_EQ(missing, 0U) << "of " << answered_.size();
  signalServo(SIGTERM);
  for (int look = 0; look < 500 && !arm_.hasEnded(); ++look) std::this_thread::sleep_for(milliseconds(10));
  expectSafeForces();
  EXPECT_GT(largest_N_, 0.3);  // it pressed
  writeFigures(events, missing);
}

}  // namespace hid_service_kills_test
}  // namespace palpate
