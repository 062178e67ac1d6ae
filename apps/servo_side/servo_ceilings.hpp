// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/servo_ceilings.hpp: what a servo never exceeds, whatever an engine's scene asks for.
//
// An engine may be broken, and a hand is at the servo's end. So the servo's own user says how hard and how abruptly
// that hand may be pulled, by flags of `palpate servo` and by a file of the machine's. Where both say something, the
// tighter counts. Set-up code; any thread.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

struct DeviceKind;
struct DeviceLimits;
struct SafetyParameters;
struct Scene;

// Empty: the scene's own counts.
struct ServoCeilings {
  std::optional<double> force_N = {};       // largest force at the handle [N]
  std::optional<double> current_A = {};     // largest of the device's motors [A]
  std::optional<double> slew_N_per_s = {};  // fastest change of the force at the handle [N/s]
  std::optional<double> least_fade_s = {};  // from full force to none [s]
  bool takes_calibrated = true;             // believes an engine that says that the device is calibrated already

  bool operator==(const ServoCeilings&) const = default;
};

struct CeilingRow {
  std::string_view flag;  // "--max-force"
  std::string_view key;   // in the file: "max_force_N"
  std::string_view unit;
  double lowest, highest;
  bool is_floor;  // the larger one is the tighter
  std::string_view help;
  std::optional<double> ServoCeilings::*member;
};
[[nodiscard]] std::span<const CeilingRow> ceilingRows() noexcept;

// The tighter of the two, for each.
[[nodiscard]] ServoCeilings tighter(const ServoCeilings& a, const ServoCeilings& b);

// `$XDG_CONFIG_HOME/palpate/servo.toml`, or in ~/.config; empty: neither variable is set.
[[nodiscard]] std::filesystem::path ceilingsFile();
// Of a file that is there, else none. A file of which nobody can say whether it is there may have ceilings, as one in a
// folder that may not be searched, or a link that leads nowhere. Throws Error: kBadInput as readCeilings() does, kIo or
// kNotFound if it cannot be read.
[[nodiscard]] ServoCeilings ceilingsOfFile(const std::filesystem::path& file);
// Of its text. Throws Error(kBadInput), with line: no TOML, an unknown key, a value that is no number or out of range.
[[nodiscard]] ServoCeilings readCeilings(std::string_view text, const std::string& file);
// Sets the one with this flag. False: there is none of this name. Throws Error(kBadInput): no number, or out of range.
[[nodiscard]] bool setCeiling(ServoCeilings& ceilings, std::string_view flag, const std::string& value);

// What an engine asked for and did not get, and why, in words: "the engine asks for a force limit of 8 N, and gets 2 N
// (--max-force)".
using TellClipped = std::function<void(const std::string&)>;

// The scene as it may be. Throws Error(kBadInput) for a device that nobody knows.
[[nodiscard]] Scene within(const ServoCeilings& ceilings, Scene scene, const TellClipped& tell);
// Of the current limit alone, for a device of this kind: what the scene must ask for, or empty where what the table of
// devices states may stay. Which of the kind's boards is plugged in is not known yet, and what a scene asks for takes
// the place of what the table states for each. So where the ceiling is below what one of them may have, none gets more
// than the least of them bears, nor more than the ceiling [A].
[[nodiscard]] std::optional<double> currentWithin(const ServoCeilings& ceilings, const DeviceKind& kind,
                                                  const TellClipped& tell);
// The same for a force limit that is set later [N, in the scene; the ceiling is one at the handle].
[[nodiscard]] double forceWithin(const ServoCeilings& ceilings, const Scene& scene, double limit_N,
                                 const TellClipped& tell);

// Nobody waits longer than this for a force to fade [s], whatever was asked for. It is enough for the longest fade and
// ten times the 5 N of the arms in the table, at the lowest slew that a ceiling can ask for. A scene may ask for a slew
// at which a fade takes more than an hour, and nobody could tell a servo that hangs from one that fades.
inline constexpr double kMostFade_s = 60;
// What a servo's process may take beyond its fade, from SIGTERM until it is killed [s].
inline constexpr double kServosEnd_s = 5;

// The longest that a servo may take to bring a force to zero [s], whatever its own ceilings are, which an engine does
// not know; kMostFade_s at most. `force_N` is the largest at the handle; fade [s] and slew at the handle [N/s] are
// those that were asked for. After a stall within a fade the rest goes at the slew, so the two times add up.
[[nodiscard]] double longestFade_s(double force_N, double fade_s, double slew_N_per_s);
// Of the scene's device, by the table of devices. A device that nobody holds has no hand to bring to rest.
[[nodiscard]] double longestFade_s(const Scene& scene);
// Of a device that is there. Its limits and the loop's are in the scene's newtons, of which each is `force_scale`
// newtons at the handle.
[[nodiscard]] double longestFade_s(const DeviceLimits& limits, double force_scale, const SafetyParameters& safety);

}  // namespace palpate
