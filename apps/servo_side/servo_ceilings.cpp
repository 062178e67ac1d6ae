// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/servo_ceilings.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "apps/devices/device_table.hpp"
#include "apps/held/held_device.hpp"
#include "apps/scene/scene.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/nearest_word.hpp"
#include "base/user_folders.hpp"
#include "base/whole_file.hpp"
#include "servo/devices/device.hpp"
#include "servo/safety/safety_gate.hpp"

namespace palpate {
namespace {

constexpr CeilingRow kRows[] = {
    {"--max-force", "max_force_N", "N", 1e-3, 1000, false, "largest force at the device's handle",
     &ServoCeilings::force_N},
    {"--max-current", "max_current_A", "A", 1e-3, 20, false, "largest current of the device's motors",
     &ServoCeilings::current_A},
    {"--max-slew", "max_slew_N_per_s", "N/s", 1, 1e9, false, "fastest change of the force at the device's handle",
     &ServoCeilings::slew_N_per_s},
    {"--least-fade", "least_fade_s", "s", 0, 10, true, "shortest time in which a full force fades to zero",
     &ServoCeilings::least_fade_s},
};

constexpr std::uint64_t kMostBytes = 1 << 16;

double checked(const CeilingRow& row, const std::string& name, double value) {
  checkSetting(value >= row.lowest && value <= row.highest, name, value,
               formatted("give {} to {} {}", row.lowest, row.highest, row.unit));
  return value;
}

// `what` the engine asked for, and `why` it does not get it.
struct Clipping {
  double asked, given;
  std::string_view unit, what;
  std::string why;
};

void tellClipping(const Clipping& clipping, const TellClipped& tell) {
  if (!tell) return;
  tell(fmt::format("the engine asks for a {} of {:.4g} {}, and gets {:.4g} {} ({})", clipping.what, clipping.asked,
                   clipping.unit, clipping.given, clipping.unit, clipping.why));
}

// `asked` as it may be; says where that is something else.
double clipped(const CeilingRow& row, const ServoCeilings& ceilings, double asked, std::string_view what,
               const TellClipped& tell) {
  const std::optional<double>& bound = ceilings.*row.member;
  if (!bound) return asked;
  const double given = row.is_floor ? std::max(asked, *bound) : std::min(asked, *bound);
  if (given != asked) {
    tellClipping({.asked = asked, .given = given, .unit = row.unit, .what = what, .why = std::string(row.flag)}, tell);
  }
  return given;
}

constexpr const char* kCurrent = "current limit";

const CeilingRow& rowOf(std::optional<double> ServoCeilings::*member) {
  return *std::ranges::find_if(kRows, [&](const CeilingRow& row) { return row.member == member; });
}

// What of a kind's boards decides, where the weakest bears less than the ceiling; 0: of one nobody has said it.
std::string whyOfBoards(double least_A) {
  if (least_A > 0) return fmt::format("the weakest board of this kind bears {:.4g} A", least_A);
  return "the table of this kind does not say what each board bears; give --current-limit";
}

}  // namespace

std::span<const CeilingRow> ceilingRows() noexcept {
  return kRows;
}

ServoCeilings tighter(const ServoCeilings& a, const ServoCeilings& b) {
  ServoCeilings both = a;
  for (const CeilingRow& row : kRows) {
    const std::optional<double>& other = b.*row.member;
    std::optional<double>& value = both.*row.member;
    if (!value || !other) {
      value = value ? value : other;
    } else {
      value = row.is_floor ? std::max(*value, *other) : std::min(*value, *other);
    }
  }
  both.takes_calibrated = a.takes_calibrated && b.takes_calibrated;
  return both;
}

std::filesystem::path ceilingsFile() {
  const std::filesystem::path folder = settingsFolder();
  return folder.empty() ? folder : folder / "servo.toml";
}

ServoCeilings ceilingsOfFile(const std::filesystem::path& file) {
  if (file.empty()) return {};
  std::error_code error;
  static_cast<void>(std::filesystem::symlink_status(file, error));
  if (error == std::errc::no_such_file_or_directory) return {};
  if (error) {
    throw Error(Error::Code::kIo, file.string(),
                fmt::format("nobody can say whether the servo's ceilings are there ({})", error.message()),
                "mend the folders that its name goes through, and the rights to search them");
  }
  return readCeilings(wholeFile(file, "the servo's ceilings", kMostBytes), file.string());
}

ServoCeilings readCeilings(std::string_view text, const std::string& file) {
  toml::table root;
  try {
    root = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    refuse(fmt::format("{}:{}:{}", file, error.source().begin.line, error.source().begin.column),
           std::string(error.description()), "mend the TOML there");
  }
  std::vector<std::string> keys;
  for (const CeilingRow& row : kRows) keys.emplace_back(row.key);
  ServoCeilings ceilings;
  for (const auto& [key, node] : root) {
    const std::string name = fmt::format("{}:{}: {}", file, node.source().begin.line, key.str());
    const auto* const row = std::ranges::find_if(kRows, [&](const CeilingRow& r) { return r.key == key.str(); });
    if (row == std::end(kRows))
      refuse(name, "a servo has no such ceiling",
             withDidYouMean(std::string(key.str()), keys, "the keys are " + listed(keys)));
    const std::optional<double> value = node.value<double>();
    if (!value || !node.is_number()) refuse(name, "it is no number", fmt::format("give a number of {}", row->unit));
    ceilings.*row->member = checked(*row, name, *value);
  }
  return ceilings;
}

bool setCeiling(ServoCeilings& ceilings, std::string_view flag, const std::string& value) {
  const auto* const row = std::ranges::find_if(kRows, [&](const CeilingRow& r) { return r.flag == flag; });
  if (row == std::end(kRows)) return false;
  std::size_t used = 0;
  double number = 0;
  try {
    number = std::stod(value, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != value.size())
    refuse(fmt::format("{} {}", flag, value), "it is no number", fmt::format("give a number of {}", row->unit));
  ceilings.*row->member = checked(*row, std::string(flag), number);
  return true;
}

Scene within(const ServoCeilings& ceilings, Scene scene, const TellClipped& tell) {
  scene.force_limit_N = forceWithin(ceilings, scene, scene.force_limit_N, tell);
  const double scale = isHeld(scene) ? scene.force_scale : 1;
  scene.slew_limit_N_per_s = clipped(rowOf(&ServoCeilings::slew_N_per_s), ceilings, scene.slew_limit_N_per_s * scale,
                                     "slew limit at the handle", tell) /
                             scale;
  scene.fade_s = clipped(rowOf(&ServoCeilings::least_fade_s), ceilings, scene.fade_s, "fade time", tell);
  if (scene.current_limit_A) {
    scene.current_limit_A = clipped(rowOf(&ServoCeilings::current_A), ceilings, *scene.current_limit_A, kCurrent, tell);
  } else if (const DeviceKind* const kind = deviceKindNamed(scene.device)) {
    scene.current_limit_A = currentWithin(ceilings, *kind, tell);
  }
  if (scene.device_calibrated && !ceilings.takes_calibrated) {
    scene.device_calibrated = false;
    if (tell) {
      tell(
          "the engine says that the device is calibrated, and is not believed; calibrate it here ('palpate "
          "calibrate'), "
          "or start 'palpate servo --calibrated'");
    }
  }
  return scene;
}

std::optional<double> currentWithin(const ServoCeilings& ceilings, const DeviceKind& kind, const TellClipped& tell) {
  const std::vector<double> boards_A = kind.eachValueOf("current_limit_A");
  if (boards_A.empty() || !ceilings.current_A) return {};
  const auto [least_A, most_A] = std::ranges::minmax(boards_A);
  if (most_A <= *ceilings.current_A) return {};
  const CeilingRow& row = rowOf(&ServoCeilings::current_A);
  const bool is_boards = least_A < *ceilings.current_A;
  const double given_A = is_boards ? least_A : *ceilings.current_A;
  tellClipping({.asked = most_A,
                .given = given_A,
                .unit = row.unit,
                .what = kCurrent,
                .why = is_boards ? whyOfBoards(least_A) : std::string(row.flag)},
               tell);
  return given_A;
}

double forceWithin(const ServoCeilings& ceilings, const Scene& scene, double limit_N, const TellClipped& tell) {
  const double scale = isHeld(scene) ? scene.force_scale : 1;
  return clipped(rowOf(&ServoCeilings::force_N), ceilings, limit_N * scale, "force limit at the handle", tell) / scale;
}

double longestFade_s(double force_N, double fade_s, double slew_N_per_s) {
  const double least_slew_N_per_s = std::min(slew_N_per_s, rowOf(&ServoCeilings::slew_N_per_s).lowest);
  const double longest_s = std::max(fade_s, rowOf(&ServoCeilings::least_fade_s).highest) + force_N / least_slew_N_per_s;
  return std::min(longest_s, kMostFade_s);
}

double longestFade_s(const DeviceLimits& limits, double force_scale, const SafetyParameters& safety) {
  const double force_N = limits.is_held ? limits.force_limit_N * force_scale : 0;
  return longestFade_s(force_N, safety.fade_s, safety.slew_limit_N_per_s * force_scale);
}

double longestFade_s(const Scene& scene) {
  const DeviceKind* const kind = deviceKindNamed(scene.device);
  if (kind == nullptr) return longestFade_s(0, scene.fade_s, scene.slew_limit_N_per_s);
  double force_N = 0;
  for (const double limit_N : kind->eachValueOf("force_limit_N")) force_N = std::max(force_N, limit_N);
  return longestFade_s(force_N, scene.fade_s, scene.slew_limit_N_per_s * scene.force_scale);
}

}  // namespace palpate
