// SPDX-License-Identifier: Apache-2.0
// The built program on a machine with emulated HID devices (emulate_hid.cpp).
#pragma once

#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "checked_motors.hpp"
#include "program_test.hpp"
#include "tests/support/scans.hpp"
#include "trace.hpp"

namespace palpate {

// An arm that is calibrated and may exert forces, its workspace's middle at the world's origin, as large as it is.
inline const Words kArmInTheMiddle = {"--device", "polhem-v1",    "--place-at",      "0,0,0", "--place-scale",
                                      "1",        "--calibrated", "--current-limit", "3"};

class EmulatedHid : public ProgramTest {
 protected:
  using Json = nlohmann::json;

  [[nodiscard]] Outcome emulate(const Words& machine, const Words& program,
                                const std::vector<std::pair<std::string, std::string>>& environment = {}) const {
    Command command{.arguments = machine + Words{"--"} + program, .program = PALPATE_EMULATE_HID, .folder = folder()};
    if (motors_checked_) leaveCheckedMotors(folder() / "state");
    command.environment = {{"XDG_RUNTIME_DIR", folder().string()},
                           {"XDG_CONFIG_HOME", folder().string()},
                           {"XDG_STATE_HOME", (folder() / "state").string()}};
    command.environment.insert(command.environment.end(), environment.begin(), environment.end());
    return runPalpate(command);
  }
  [[nodiscard]] Outcome on(const Words& machine, const Words& arguments) const {
    return emulate(machine, Words{PALPATE_PROGRAM} + arguments);
  }
  [[nodiscard]] Json summary(const std::string& out = "out") const {
    return Json::parse(contentsOf(file(out) / "summary.json"));
  }
  [[nodiscard]] double figure(const std::string& key, const std::string& out = "out") const {
    return summary(out)["device"]["figures"][key];
  }

  bool motors_checked_ = true;  // of the emulated arms, before the program begins

  // A way along the surface, tick by tick, as a rigid hand goes it.
  // `share` of it: cut there. `rest_s`: the hand waits there first. What tests of one program have in common is run
  // once.
  void writeWay(const std::string& volume, double seconds, double depth_mm, double share = 1, double rest_s = 0) const {
    const Words touch = {"touch",     volume,
                         "--clock",   "simulated",
                         "--picture", "off",
                         "--seconds", fmt::format("{}", seconds),
                         "--depth",   fmt::format("{}", depth_mm),
                         "--out",     "rigid"};
    static std::map<Words, std::string> traces;
    std::string& trace = traces[touch];
    if (trace.empty()) {
      ASSERT_EQ(run(touch).status, 0);
      trace = contentsOf(file("rigid") / "trace.csv");
    }
    std::filesystem::create_directories(file("rigid"));
    write("rigid/trace.csv", trace);
    std::string csv = "time_s,x_m,y_m,z_m\n";
    std::vector<TraceRow> rows = readTrace(file("rigid") / "trace.csv").rows;
    rows.resize(static_cast<std::size_t>(share * static_cast<double>(rows.size())));
    const auto put = [&](double time_s, const Vec3& hip) {
      csv += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", time_s, hip.x(), hip.y(), hip.z());
    };
    for (int ms = 0; ms < std::lround(1e3 * rest_s); ++ms) put(1e-3 * ms, rows.front().hip_W());
    for (const TraceRow& row : rows) put(rest_s + row.time_s(), row.hip_W());
    write("way.csv", csv);
  }
};

}  // namespace palpate
