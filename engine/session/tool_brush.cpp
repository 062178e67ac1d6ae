// SPDX-License-Identifier: Apache-2.0
#include "engine/session/tool_brush.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr const char* kForm = "give for example remove:radius=2mm:strength=0.5:falloff=0.3";
constexpr double kStandsStill = 0.05;  // of the radius: a nearer place is the same

[[noreturn]] void refuse(const std::string& text, const std::string& reason, const std::string& remedy = kForm) {
  throw Error(Error::Code::kBadInput, "--edit " + text, reason, remedy);
}

constexpr std::pair<std::string_view, EditKind> kKinds[] = {
    {"remove", EditKind::kRemove},  {"add", EditKind::kAdd},         {"paint", EditKind::kPaint},
    {"smooth", EditKind::kSmooth},  {"inflate", EditKind::kInflate}, {"deflate", EditKind::kDeflate},
    {"flatten", EditKind::kFlatten}};

EditKind kindOf(const std::string& text, std::string_view word) {
  for (const auto& [name, kind] : kKinds) {
    if (name == word) return kind;
  }
  if (word == "cut") refuse(text, "a plane is no brush of a tool", "use flatten, or remove to drill");
  if (word.starts_with("stamp")) refuse(text, "a stamp is no brush of a tool", "use add or remove");
  refuse(text, fmt::format("there is no brush '{}'", word),
         "use remove, add, paint, flatten, smooth, inflate or deflate");
}

// A number and what is behind it.
std::pair<double, std::string_view> numberOf(const std::string& text, std::string_view key, std::string_view value) {
  double number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc{} || !std::isfinite(number)) refuse(text, fmt::format("'{}' of {} is no number", value, key));
  return {number, value.substr(static_cast<std::size_t>(end - value.data()))};
}

double plain(const std::string& text, std::string_view key, std::string_view value, double lowest, double highest) {
  const auto [number, rest] = numberOf(text, key, value);
  if (!rest.empty()) refuse(text, fmt::format("'{}' of {} is no number", value, key));
  if (number < lowest || number > highest) {
    refuse(text, fmt::format("{} is {:g}", key, number), fmt::format("give {:g} to {:g}", lowest, highest));
  }
  return number;
}

double length(const std::string& text, std::string_view key, std::string_view value) {
  const auto [number, unit] = numberOf(text, key, value);
  double metres = 0;
  if (unit == "mm" || unit.empty()) metres = number * kMetresPerMillimetre;
  if (unit == "m") metres = number;
  if (unit == "cm") metres = number * 1e-2;
  if (unit == "um") metres = number * 1e-6;
  if (!(metres > 0)) {
    refuse(text, fmt::format("'{}' of {} is no length above 0", value, key), "give a number and mm, um, cm or m: 2mm");
  }
  return metres;
}

void setKey(const std::string& text, std::string_view key, std::string_view value, ToolBrushSpec& spec) {
  const auto material = [&]() -> MaterialRate& {
    if (!spec.brush.material) spec.brush.material.emplace();
    return *spec.brush.material;
  };
  constexpr double kLargest = 1e30;
  constexpr double kLeast = 1e-6;
  if (key == "radius") {
    spec.brush.radius_m = length(text, key, value);
  } else if (key == "strength") {
    spec.brush.strength = plain(text, key, value, kLeast, 1);
  } else if (key == "falloff") {
    spec.brush.falloff = plain(text, key, value, 0, 1);
  } else if (key == "value") {
    spec.brush.value = plain(text, key, value, -kLargest, kLargest);
  } else if (key == "rate") {
    spec.rate_per_Ns = plain(text, key, value, kLeast, 1e6);
  } else if (key == "soft") {
    material().low_density = plain(text, key, value, -kLargest, kLargest);
  } else if (key == "hard") {
    material().high_density = plain(text, key, value, -kLargest, kLargest);
  } else if (key == "drop") {
    material().drop = plain(text, key, value, 0, 1);
  } else if (key == "mirror") {
    if (value != "x" && value != "y" && value != "z") {
      refuse(text, fmt::format("'{}' of mirror is no axis", value), "give mirror=x, y or z, an axis of the volume");
    }
    spec.mirror_axis = value[0] - 'x';
  } else if (key == "period") {
    spec.period_s = plain(text, key, value, 0.1, 1000) * 1e-3;
  } else {
    refuse(text, fmt::format("there is no '{}'", key),
           "use radius, strength, falloff, value, rate, soft, hard, drop, period and mirror");
  }
}

}  // namespace

ToolBrushSpec toolBrushSpec(const std::string& text) {
  ToolBrushSpec spec;
  std::string_view rest = text;
  const auto next = [&] {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return word;
  };
  spec.brush.kind = kindOf(text, next());
  while (!rest.empty()) {
    const std::string_view word = next();
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) refuse(text, fmt::format("'{}' has no value", word));
    setKey(text, word.substr(0, equals), word.substr(equals + 1), spec);
  }
  if (spec.brush.radius_m == 0) refuse(text, "it has no radius");
  if (spec.brush.material && spec.brush.kind != EditKind::kRemove)
    refuse(text, "only removing knows soft and hard material", "leave soft, hard and drop out");
  if (spec.brush.material && !(spec.brush.material->low_density < spec.brush.material->high_density))
    refuse(text, "soft material is not less dense than hard", "give soft below hard");
  return spec;
}

double ToolBrush::strengthFor(double seconds) const {
  if (spec_.rate_per_Ns == 0 || !(seconds > 0)) return spec_.brush.strength;
  return spec_.brush.strength * -std::expm1(-spec_.rate_per_Ns * impulse_Ns_);
}

ToolBrush::ToolBrush(const ToolBrushSpec& spec, const Vec3i& size, const Lattice& lattice)
    : spec_(spec),
      middle_W_(lattice.toWorld(0.5 * (size - Vec3i::Ones()).cast<double>())),
      mirror_normal_W_(lattice.R_WL.col(spec.mirror_axis.value_or(0))) {}

// The pressing force is what the device was really sent, along the normal: what rubs does not drill.
void ToolBrush::touch(const ToolPose& pose, std::int64_t time_ns) {
  const bool was_touching = std::exchange(touching_, !pose.normal_W.isZero(0));
  if (!touching_) return;
  touched_ = true;
  const double force_N = std::max(0.0, pose.force_W.dot(pose.normal_W));
  impulse_Ns_ += force_N * static_cast<double>(time_ns - last_look_ns_) / kNanosecondsPerSecond;
  if (was_touching) return;
  plane_W_ = pose.at_surface ? pose.surface_W : pose.position_W;
  normal_W_ = pose.normal_W;
}

std::vector<EditCommand> ToolBrush::look(const ToolPose& pose, std::int64_t time_ns) {
  if (!from_W_) {
    from_W_ = pose.position_W;
    begin_ns_ = last_look_ns_ = time_ns;
  }
  touch(pose, time_ns);
  last_look_ns_ = time_ns;
  const double seconds = static_cast<double>(time_ns - begin_ns_) / kNanosecondsPerSecond;
  // Half a nanosecond, since ticks are rounded to whole ones.
  if (seconds < spec_.period_s - 1e-9) return {};

  EditCommand command = spec_.brush;
  command.from_W = *from_W_;
  command.to_W = pose.position_W;
  command.strength = strengthFor(seconds);
  command.plane_W = plane_W_;
  command.normal_W = normal_W_;
  const bool touched = std::exchange(touched_, false);
  from_W_ = pose.position_W;
  begin_ns_ = time_ns;
  impulse_Ns_ = 0;
  // Adding and removing at full strength, a second time in the same place, would change nothing.
  const bool at_once = (command.kind == EditKind::kAdd || command.kind == EditKind::kRemove) && command.strength >= 1 &&
                       command.falloff == 0 && !command.material;
  const bool stands = last_edit_W_ && (*last_edit_W_ - command.to_W).norm() < kStandsStill * command.radius_m &&
                      (*last_edit_W_ - command.from_W).norm() < kStandsStill * command.radius_m;
  if (!touched || !(command.strength > 0) || (at_once && stands)) return {};
  last_edit_W_ = command.to_W;
  if (!spec_.mirror_axis) return {command};
  return {command, mirrored(command, middle_W_, mirror_normal_W_)};
}

}  // namespace palpate
