// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/idle_options.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/devices/device_table.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/devices/registry.hpp"

namespace palpate {
namespace {

struct IdleOption {
  const char* flag;
  bool (*is_used)(const Scene& scene);
  const char* why;  // the flag has no effect
};

bool isReal(const Scene& scene) {
  return deviceKindNamed(scene.device) != nullptr;
}
bool isRecorded(const Scene& scene) {
  return scene.device == "recorded";
}
bool isSimulated(const Scene& scene) {
  return !isReal(scene) && !isRecorded(scene);
}
bool hasSpringHand(const Scene& scene) {
  return scene.spring_hand || !isSimulated(scene);  // another device has a reason of its own
}
bool buildsPath(const Scene& scene) {
  return scene.path_file.empty() && !isReal(scene) && !isRecorded(scene);
}
// An unknown algorithm is refused elsewhere.
const AlgorithmEntry* entryOf(const Scene& scene) {
  const auto all = algorithms();
  const auto entry = std::find_if(all.begin(), all.end(), [&](const auto& e) { return e.name == scene.algorithm; });
  return entry == all.end() ? nullptr : &*entry;
}
bool takesTables(const Scene& scene) {
  return entryOf(scene) == nullptr || entryOf(scene)->traits.takes_tables;
}
bool hasStiffness(const Scene& scene) {
  return entryOf(scene) == nullptr || entryOf(scene)->traits.shows_surface;
}
bool renewsPlanes(const Scene& scene) {
  return entryOf(scene) == nullptr || entryOf(scene)->traits.renews_planes;
}
bool draws(const Scene& scene) {
  return scene.picture;
}

constexpr const char* kSpringOnly =
    "only a simulated hand that is a spring has it: with --hand rigid the tool is on its path whatever it feels; give "
    "--hand spring";
constexpr const char* kSimulatedOnly = "only --device simulated has it: a hand leads this one";
constexpr const char* kNoSurface = "this --algorithm has no surface to be stiff; its tables say how hard it pushes";
constexpr const char* kNoBuiltPath = "the tool's way is that of --path, or of a real --device";
constexpr const char* kNoReal = "only a real --device has it; 'palpate devices' lists them";
constexpr const char* kHaptizationOnly = "only --algorithm haptization uses it";
constexpr const char* kNoPicture = "nothing is drawn with --picture off";

const IdleOption kIdleOptions[] = {
    {"--stiffness", hasStiffness, kNoSurface},
    {"--damping", hasStiffness, kNoSurface},
    {"--n", renewsPlanes, "this --algorithm finds the surface anew in every tick"},
    {"--haptization-density", takesTables, kHaptizationOnly},
    {"--haptization-gradient", takesTables, kHaptizationOnly},
    {"--require-real-time", [](const Scene& s) { return !s.simulated_clock; }, "only --clock real is in real time"},
    {"--velocity-cutoff", [](const Scene& s) { return s.velocity == "filter"; }, "only --velocity filter uses it"},
    {"--velocity-noise", [](const Scene& s) { return s.velocity == "foaw"; }, "only --velocity foaw uses it"},
    {"--texture-amplitude", [](const Scene& s) { return s.texture != "none"; },
     "there is no texture; give --texture procedural or density"},
    {"--texture-wavelength", [](const Scene& s) { return s.texture == "procedural"; },
     "only --texture procedural uses it"},
    {"--texture-gain", [](const Scene& s) { return s.texture == "density"; }, "only --texture density uses it"},
    {"--hand", isSimulated, kSimulatedOnly},
    {"--encoder", isSimulated, kSimulatedOnly},
    {"--delay", isSimulated, kSimulatedOnly},
    {"--dropped", isSimulated, kSimulatedOnly},
    {"--hand-mass", isSimulated, kSimulatedOnly},
    {"--hand-damping", isSimulated, kSimulatedOnly},
    {"--hand-stiffness", isSimulated, kSimulatedOnly},
    {"--device-mass", isSimulated, kSimulatedOnly},
    {"--device-damping", isSimulated, kSimulatedOnly},
    {"--device-friction", isSimulated, kSimulatedOnly},
    {"--hand-mass", hasSpringHand, kSpringOnly},
    {"--hand-damping", hasSpringHand, kSpringOnly},
    {"--hand-stiffness", hasSpringHand, kSpringOnly},
    {"--device-mass", hasSpringHand, kSpringOnly},
    {"--device-damping", hasSpringHand, kSpringOnly},
    {"--device-friction", hasSpringHand, kSpringOnly},
    {"--recording", isRecorded, "only --device recorded plays one back"},
    {"--device-path", isReal, kNoReal},
    {"--hid", isReal, kNoReal},
    {"--calibrated", isReal, kNoReal},
    {"--current-limit", isReal, kNoReal},
    {"--place-at", isReal, kNoReal},
    {"--place-turn", isReal, kNoReal},
    {"--place-scale", isReal, kNoReal},
    {"--force-scale", isReal, kNoReal},
    {"--clutch", isReal, kNoReal},
    {"--edge", isReal, kNoReal},
    {"--path", [](const Scene& s) { return !isReal(s) && !isRecorded(s); },
     "a hand leads a real --device, and its recording a recorded one"},
    {"--seconds", [](const Scene& s) { return (s.path_file.empty() || isReal(s)) && !isRecorded(s); },
     "the run is as long as the path of --path, or the recording"},
    {"--toward", buildsPath, kNoBuiltPath},
    {"--start", buildsPath, kNoBuiltPath},
    {"--slide-toward", buildsPath, kNoBuiltPath},
    {"--edges", buildsPath, kNoBuiltPath},
    {"--depth", buildsPath, kNoBuiltPath},
    {"--slide", buildsPath, kNoBuiltPath},
    {"--approach", buildsPath, kNoBuiltPath},
    {"--stopped-trace", [](const Scene& s) { return s.trace; }, "no trace.csv is written with --trace off"},
    {"--width", draws, kNoPicture},
    {"--height", draws, kNoPicture},
};

}  // namespace

std::vector<std::string> idleOptions(const Scene& scene, std::span<const std::string> given_flags) {
  std::vector<std::string> words;
  for (const IdleOption& option : kIdleOptions) {
    const bool is_given = std::find(given_flags.begin(), given_flags.end(), option.flag) != given_flags.end();
    if (is_given && !option.is_used(scene))
      words.push_back(fmt::format("{} has no effect: {}", option.flag, option.why));
  }
  return words;
}

std::vector<std::string> flagsThatMayBeIdle() {
  std::vector<std::string> flags;
  for (const IdleOption& option : kIdleOptions) flags.emplace_back(option.flag);
  return flags;
}

}  // namespace palpate
