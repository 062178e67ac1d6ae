// SPDX-License-Identifier: Apache-2.0
// A service in real time for as long as one likes: a servo slides a hand over a sphere, two clients edit, undo, look,
// draw, save and change settings. Memory must be flat, and nothing left open; the same with engines that are made anew.
//
// PALPATE_SOAK_MINUTES: how long (0.2; `./dev soak` takes 30).
#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "apps/serve/service_client.hpp"
#include "endurance_figures.hpp"
#include "memory_trend.hpp"
#include "process_facts.hpp"
#include "service_processes.hpp"

namespace palpate {
namespace soak_test {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr double kLongEnough_min = 5;  // for a figure of memory; before, caches of driver and allocator fill

class Soak : public ServiceTest {
 protected:
  // To and fro over the sphere's top, 1 mm deep, as long as the test.
  void writeWay(double seconds) const {
    std::ofstream way(file("way.csv"));
    way << "time_s,x_m,y_m,z_m\n0,0,0,0.015\n";
    constexpr double kRadius_m = 0.0102, kAngle_rad = 0.5;
    for (int i = 1; i < seconds + 60; ++i) {
      const double angle = i % 2 == 0 ? kAngle_rad : -kAngle_rad;
      way << fmt::format("{},{:.6f},0,{:.6f}\n", i, kRadius_m * std::sin(angle), kRadius_m * std::cos(angle));
    }
  }
  [[nodiscard]] std::string socket() const { return (file("run") / "palpate/service.sock").string(); }

  // Every edit is undone, so that the volume and the history stay what they are.
  void editAndUndo(const std::atomic<bool>& stop) {
    ServiceClient client(socket());
    for (int i = 0; !stop; ++i) {
      const int place = i % 7 - 3;
      ask(client, wire::Verb::Edit,
          {fmt::format("{}:radius=1.5mm:at={},{},9mm", i % 2 == 0 ? "remove" : "add", place, place / 2)});
      std::this_thread::sleep_for(milliseconds(40));
      ask(client, wire::Verb::Undo, {});
      std::this_thread::sleep_for(milliseconds(40));
      edits_ += 2;
    }
  }
  void lookAndDraw(const std::atomic<bool>& stop, bool filters) {
    ServiceClient client(socket());
    for (int i = 0; !stop; ++i) {
      ask(client, wire::Verb::Status, {});
      ask(client, wire::Verb::Set, {"servo.stiffness_N_per_m", std::to_string(300 + 50 * (i % 5))});
      ask(client, wire::Verb::Get, {});
      if (i % 5 == 0) ask(client, wire::Verb::Render, {file("now.png").string(), "320", "240"});
      if (i % 20 == 7) ask(client, wire::Verb::Save, {file("now.vdb").string()});
      if (i % 20 == 13) ask(client, wire::Verb::Save, {file("now.stl").string()});
      if (filters && i % 50 == 30) ask(client, wire::Verb::Filter, {i % 100 == 30 ? "gaussian:1" : ""});
      // One that comes and goes.
      if (i % 10 == 9) ask(*std::make_unique<ServiceClient>(socket()), wire::Verb::Status, {});
      std::this_thread::sleep_for(milliseconds(200));
    }
  }
  void ask(ServiceClient& client, wire::Verb verb, std::vector<std::string> words) {
    try {
      static_cast<void>(client.ask(verb, std::move(words)));
    } catch (const std::exception& error) {
      ADD_FAILURE() << wire::EnumNameVerb(verb) << ": " << error.what();
    }
  }
  std::atomic<std::uint64_t> edits_{0};

  void soak(double minutes, bool filters, const std::string& name);
};

// `filters`: they change, and each time the engine is made anew. `name`: of the results.
void Soak::soak(double minutes, bool filters, const std::string& name) {
  writeWay(60 * minutes);
  serve({"phantom:sphere?size=32", "--path", "way.csv", "--stiffness", "400"});
  join();
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["force_N"] > 0.1; })) << contentsOf(file("serve.log"));
  const pid_t engine_id = engine.id(), servo_id = servo.id();
  std::vector<double> engines, servos;
  std::size_t most_descriptors = 0, first_descriptors = 0, most_threads = 0;
  nlohmann::json last;
  {
    std::atomic<bool> stop{false};
    const auto end = Clock::now() + std::chrono::duration<double, std::ratio<60>>(minutes);
    struct Stopped {
      std::atomic<bool>& stop;
      std::jthread first, second;
      ~Stopped() { stop = true; }
    } const clients{stop, std::jthread([&] { editAndUndo(stop); }), std::jthread([&] { lookAndDraw(stop, filters); })};
    const auto every = std::chrono::duration<double>(std::min(2.0, 60 * minutes / 50));
    while (Clock::now() < end) {
      std::this_thread::sleep_for(every);
      engines.push_back(ownMemory(engine_id));
      servos.push_back(ownMemory(servo_id));
      const std::size_t descriptors = openDescriptorsOf(engine_id) + openDescriptorsOf(servo_id);
      if (engines.size() == 10) first_descriptors = descriptors;
      most_descriptors = std::max(most_descriptors, descriptors);
      most_threads = std::max(most_threads, threadsOf(engine_id) + threadsOf(servo_id));
      ASSERT_FALSE(engine.hasEnded() || servo.hasEnded()) << contentsOf(file("serve.log"));
    }
    last = status();
    ASSERT_TRUE(last.is_object());
  }
  EXPECT_EQ(last["servos"], last["engines"]);  // one servo, which came back to each engine
  EXPECT_EQ(last["refused"], 0);
  EXPECT_LE(last["undoable"], 1);
  EXPECT_GT(last["windows"], 0);
  // A file that is being written, a client that comes and goes, the pipe of a child process.
  constexpr std::size_t kForAMoment = 8;
  EXPECT_LE(most_descriptors, first_descriptors + kForAMoment);
  const double engine_grown = growthOf(engines), servo_grown = growthOf(servos);
  if (minutes >= kLongEnough_min) {
    if (!filters) {
      EXPECT_LE(engine_grown, 0.01);
    }
    EXPECT_LE(servo_grown, 0.01);
  }
  // Everything that came has gone again.
  ASSERT_TRUE(await([](const nlohmann::json& now) { return now["clients"] == 1; }));
  const std::size_t left = openDescriptorsOf(engine_id) + openDescriptorsOf(servo_id);
  EXPECT_LE(left, first_descriptors);

  const std::string command = fmt::format("./dev soak {:g}", minutes);
  BenchResult result = beginEndurance(name, run({"--version"}).out, command);
  for (std::size_t i = 0; i < engines.size(); i += std::max<std::size_t>(1, engines.size() / 60)) {
    const double at_s = 60 * minutes * static_cast<double>(i) / static_cast<double>(engines.size());
    result.rows.push_back({{"at_s", at_s}, {"engine_bytes", engines[i]}, {"servo_bytes", servos[i]}});
  }
  result.targets = {{"growth of the servo's own memory", servo_grown, 0.01},
                    {"descriptors left open", static_cast<double>(left) - static_cast<double>(first_descriptors), 0}};
  if (!filters)
    result.targets.insert(result.targets.begin(), {"growth of the engine's own memory", engine_grown, 0.01});
  std::string table = fmt::format("{:>12}{:>16}{:>16}\n", "at [min]", "engine [MiB]", "servo [MiB]");
  for (std::size_t i = 0; i < engines.size(); i += std::max<std::size_t>(1, engines.size() / 12)) {
    table += fmt::format("{:>12.1f}{:>16.2f}{:>16.2f}\n",
                         minutes * static_cast<double>(i) / static_cast<double>(engines.size()),
                         engines[i] / (1 << 20U), servos[i] / (1 << 20U));
  }
  table += fmt::format(
      "\n{} edits and undos, {:.0f} engines (one more for each change of filters), {} descriptors and {} threads in "
      "both "
      "at most. The engine's own memory grew by {:.1f} %.\n",
      edits_.load(), double(last["engines"]), most_descriptors, most_threads, 100 * engine_grown);
  writeEndurance(
      result, filters ? "A service whose filters change" : "A service over a long time",
      fmt::format("`palpate serve` and `palpate servo` in real time: a hand slides over a sphere, one client "
                  "edits and undoes 12 times a second, another one asks, changes settings{}, draws and "
                  "saves. Own memory is what the processes have allocated (RssAnon). Growth: the last fifth "
                  "of the looks over the second fifth, at the tenth and at the ninetieth percentile, "
                  "whichever grew more.",
                  filters ? " and filters, for which the engine is made anew," : ""),
      table);
}

TEST_F(Soak, MemoryIsFlatAndNothingIsLeftOpen) {
  soak(numberOf("PALPATE_SOAK_MINUTES", 0.2), false, "service-soak");
}

// What an engine leaves in the allocators of C and of the driver differs from one to the next.
TEST_F(Soak, NothingIsLeftOpenWhereEnginesAreMadeAnew) {
  soak(numberOf("PALPATE_SOAK_MINUTES", 0.2) / 2, true, "service-soak-engines");
}

}  // namespace soak_test
}  // namespace palpate
