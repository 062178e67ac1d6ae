// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/run_notes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/held/held_device.hpp"
#include "apps/report/words.hpp"
#include "base/units.hpp"
#include "engine/session/tool_brush.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/texture.hpp"

namespace palpate {
namespace {

bool isSilent(const TickRecord& record, double isovalue) {
  return !record.in_contact && record.faults == 0 && static_cast<double>(record.density) > isovalue;
}

// What makes a force of such a depth that is felt well. A spring hand gives way to a stiffer surface.
std::string moreForceWords(const Scene& scene, double depth_m) {
  constexpr double kClear_N = 0.5;
  constexpr double kStiffest_N_per_m = 1e5;  // that --stiffness takes
  if (!scene.edit.empty()) return "the brush changes the object under the tool";
  if (isHeld(scene)) return "raise --stiffness as far as the device can render it";
  if (scene.spring_hand) return "raise --depth or --hand-stiffness, or give --hand rigid";
  const double needed_N_per_m = kClear_N / depth_m;
  if (needed_N_per_m <= kStiffest_N_per_m) {
    const double step = std::pow(10.0, std::floor(std::log10(needed_N_per_m)) - 1);
    return fmt::format("--stiffness {:.0f} would make {} N of it, and a larger --depth more",
                       std::ceil(needed_N_per_m / step) * step, shortNumber(kClear_N));
  }
  return fmt::format(
      "--stiffness {:.0f}, the most that it takes, would make {} N of it: "
      "raise --depth too for more, or write a larger voxel size into the file",
      kStiffest_N_per_m, shortNumber(kStiffest_N_per_m * depth_m));
}

}  // namespace

std::optional<std::string> noteOnSilence(std::span<const TickRecord> records, double isovalue, double rate_hz,
                                         const std::string& algorithm) {
  std::size_t all = 0;
  double from_s = 0;
  for (auto begin = records.begin(); begin != records.end();) {
    begin = std::find_if(begin, records.end(), [&](const TickRecord& r) { return isSilent(r, isovalue); });
    const auto end = std::find_if(begin, records.end(), [&](const TickRecord& r) { return !isSilent(r, isovalue); });
    const auto ticks = static_cast<std::size_t>(end - begin);
    if (static_cast<double>(ticks) >= kShortestSilence_s * rate_hz) {
      if (all == 0) from_s = begin->time_s;
      all += ticks;
    }
    begin = end;
  }
  if (all == 0) return {};
  return fmt::format(
      "for {} s, from {} s on, the tool was in the object and {} gave neither a force nor a reason: "
      "it began there or lost the surface; hri keeps such contacts or says why not",
      shortNumber(static_cast<double>(all) / rate_hz), shortNumber(from_s), algorithm);
}

std::optional<std::string> noteOnEncoders(const Scene& scene, const DeviceLimits& device) {
  if (!algorithmEntry(scene.algorithm).traits.shows_surface) return {};
  const double step_N = stiffnessOf(scene) * device.position_resolution_m;
  if (step_N < kFeltStep_N) return {};
  return fmt::format(
      "each step of the encoders, {} mm, changes the force by {} N, which is felt as roughness; lower --stiffness",
      shortNumber(device.position_resolution_m * kMillimetresPerMetre), shortNumber(step_N));
}

std::optional<std::string> noteOnFaintForce(const Scene& scene, const RunFigures& figures) {
  const double depth_m = figures.depth_m.max;
  const double spring_N = stiffnessOf(scene) * depth_m;
  if (figures.contact_ticks == 0 || figures.force_N.max >= kFaintForce_N) return {};
  if (!(depth_m > 0) || spring_N >= kFaintForce_N) return {};  // else something other than the depth limits the force
  const bool asked = scene.press_depth_m || !scene.path_file.empty() || isHeld(scene) || !scene.edit.empty();
  const char* why = asked ? "" : ", as fits so small or thin an object";
  return fmt::format(
      "no force above {} N was reached, which is too little to feel: "
      "the tool pressed at most {} mm deep{}, and --stiffness {} makes {} N of that; {}",
      shortNumber(kFaintForce_N), shortNumber(depth_m * kMillimetresPerMetre), why, shortNumber(stiffnessOf(scene)),
      shortNumber(spring_N), moreForceWords(scene, depth_m));
}

std::optional<std::string> noteOnNoContact(const RunFigures& figures, bool ended_early, bool has_path) {
  const bool told = std::any_of(figures.faults.begin(), figures.faults.end(),
                                [](const FaultCount& count) { return count.fault == ServoFault::kInsideObject; });
  if (figures.contact_ticks > 0 || told) return {};
  if (ended_early) return "nothing was touched until the run was ended";
  if (!has_path)
    return "nothing was touched: the hand never came to the surface; see --place-at, --place-scale and --iso";
  return "nothing was touched: the path meets no surface; look at --start, --toward, --depth or --path";
}

std::optional<std::string> noteOnHand(const Scene& scene, const RunFigures& figures,
                                      std::span<const PathPhase> phases) {
  if (std::none_of(phases.begin(), phases.end(), [](const PathPhase& p) { return p.name == "slide"; })) return {};
  if (!scene.spring_hand || !scene.path_file.empty() || !scene.press_depth_m || figures.depth_m.count == 0) return {};
  if (figures.depth_m.max >= (1 - kDepthShare) * *scene.press_depth_m) return {};
  return fmt::format(
      "the hand is a spring of {} N/m and gave way to a surface of {} N/m: it pressed at most {} mm deep instead of "
      "--depth {} (a larger --hand-stiffness presses deeper, and --hand rigid all the way)",
      shortNumber(scene.hand_stiffness_N_per_m), shortNumber(stiffnessOf(scene)),
      shortNumber(figures.depth_m.max * kMillimetresPerMetre),
      shortNumber(*scene.press_depth_m * kMillimetresPerMetre));
}

std::optional<std::string> noteOnBrush(const Scene& scene, const RunFigures& figures) {
  if (scene.edit.empty() || figures.contact_ticks == 0) return {};
  const ToolBrushSpec spec = toolBrushSpec(scene.edit);
  if (spec.brush.kind != EditKind::kRemove || spec.rate_per_Ns > 0) return {};
  if (figures.contact_s >= 0.5 * (figures.time_s - figures.first_contact_s)) return {};
  return fmt::format(
      "the brush removes at once what the tool touches, so that it felt the surface for {} s only; "
      "with a rate, as in --edit {}:rate=20, it drills by force and time",
      shortNumber(figures.contact_s), scene.edit);
}

std::optional<std::string> noteOnTexture(const Scene& scene) {
  if (scene.texture != "procedural") return {};
  const double used_m = ProceduralTexture(scene.texture_amplitude_m, scene.texture_wavelength_m).amplitude();
  if (used_m >= scene.texture_amplitude_m) return {};
  return fmt::format(
      "the texture's amplitude is {} mm instead of {} mm: "
      "a wavelength of {} mm holds no more; raise --texture-wavelength",
      shortNumber(used_m * kMillimetresPerMetre), shortNumber(scene.texture_amplitude_m * kMillimetresPerMetre),
      shortNumber(scene.texture_wavelength_m * kMillimetresPerMetre));
}

}  // namespace palpate
