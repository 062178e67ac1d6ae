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

// `asked` as it may be; says where that is something else.
double clipped(const CeilingRow& row, const ServoCeilings& ceilings, double asked, std::string_view what,
               const TellClipped& tell) {
  const std::optional<double>& bound = ceilings.*row.member;
  if (!bound) return asked;
  const double given = row.is_floor ? std::max(asked, *bound) : std::min(asked, *bound);
  if (given != asked && tell) {
    tell(fmt::format("the engine asks for a {} of {:.4g} {}, and gets {:.4g} {} ({})", what, asked, row.unit, given,
                     row.unit, row.flag));
  }
  return given;
}

// The scene's, or the least that the table of devices states for its kind; empty: nobody has said one.
std::optional<double> currentOf(const Scene& scene) {
  if (scene.current_limit_A) return scene.current_limit_A;
  std::optional<double> least_A;
  const auto look = [&](const DeviceValues& values) {
    const auto value = values.find("current_limit_A");
    if (value != values.end()) least_A = std::min(least_A.value_or(value->second), value->second);
  };
  if (const DeviceKind* const kind = deviceKindNamed(scene.device)) {
    look(kind->values);
    for (const UsbId& usb : kind->usb) look(usb.values);
  }
  return least_A;
}

const CeilingRow& rowOf(std::optional<double> ServoCeilings::*member) {
  return *std::ranges::find_if(kRows, [&](const CeilingRow& row) { return row.member == member; });
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
  std::error_code ignored;
  if (file.empty() || !std::filesystem::exists(file, ignored)) return {};
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
  if (const std::optional<double> asked_A = currentOf(scene)) {
    const double given_A = clipped(rowOf(&ServoCeilings::current_A), ceilings, *asked_A, "current limit", tell);
    if (given_A != *asked_A) scene.current_limit_A = given_A;
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

double forceWithin(const ServoCeilings& ceilings, const Scene& scene, double limit_N, const TellClipped& tell) {
  const double scale = isHeld(scene) ? scene.force_scale : 1;
  return clipped(rowOf(&ServoCeilings::force_N), ceilings, limit_N * scale, "force limit at the handle", tell) / scale;
}

}  // namespace palpate
