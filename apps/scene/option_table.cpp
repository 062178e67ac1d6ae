// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/option_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/devices/device_table.hpp"
#include "apps/scene/object_table.hpp"
#include "base/error.hpp"
#include "base/units.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/devices/registry.hpp"
#include "servo/loop/velocity.hpp"

namespace palpate {
namespace {

constexpr double kMm = kMetresPerMillimetre;

NumberOption number(double Scene::*member, double scale, double lowest, double highest) {
  return {member, scale, lowest, highest};
}
NumberOption numberAbove(double Scene::*member, double scale, double lowest, double highest) {
  return {member, scale, lowest, highest, true};
}
// The words of a WordOption, from the table that defines them.
class Names {
 public:
  template <typename Entries>
  explicit Names(const Entries& entries) {
    for (const auto& entry : entries) names_.emplace_back(entry.name);
    for (const std::string& name : names_) words_.push_back(name.c_str());
  }
  [[nodiscard]] std::span<const char* const> words() const { return words_; }

 private:
  std::vector<std::string> names_;
  std::vector<const char*> words_;
};
std::span<const char* const> algorithmNames() {
  static const Names kNames(algorithms());
  return kNames.words();
}
std::span<const char* const> velocityNames() {
  static const Names kNames(velocityEstimates());
  return kNames.words();
}
std::span<const char* const> deviceNames() {
  static const std::vector<const char*> kWords = [] {
    std::vector<const char*> words;
    for (const std::string& name : deviceNamesForUsers()) words.push_back(name.c_str());
    return words;
  }();
  return kWords;
}
// An option for a parameter of the default device, with that parameter's range and help.
SceneOption ofDevice(const char* flag, const char* key, const char* unit, double Scene::*member, double scale,
                     std::string_view parameter) {
  const DeviceParameter& p = deviceParameter(devices().front().name, parameter);
  return {flag, key, unit, p.help.data(), NumberOption{member, scale, p.lowest / scale, p.highest / scale}};
}
IntegerOption integer(int Scene::*member, long long lowest, long long highest) {
  return {member, lowest, highest};
}

constexpr const char* kFields[] = {"density", "distance"};
constexpr const char* kLogs[] = {"text", "json"};
constexpr const char* kSampleForms[] = {"float", "half"};
constexpr const char* kTextures[] = {"none", "procedural", "density"};

const std::string kStiffnessHelp =
    fmt::format("stiffness of the contact, K; if not given {:g}, or what a device that is held bears",
                servoDefaults().stiffness_N_per_m);

const std::string kDampingHelp =
    fmt::format("damping of the contact along the normal, B; if not given {:g}, or what a device that is held bears",
                servoDefaults().damping_Ns_per_m);

// clang-format off
const SceneOption kOptions[] = {
    {"--volume", "volume", "", "file, DICOM folder or 'phantom:NAME?size=64&noise=0.05'", TextOption{&Scene::volume}},
    {"--series", "series", "", "of a DICOM folder of several: its number in the list that is printed without it, or its UID", TextOption{&Scene::series, false}},
    {"--nan", "nan", "density", "what voxels become that are NaN, infinite or beyond the range of a float in the file, or padding in DICOM slices; if not given 0 in NIfTI files, for padding its own density or the lowest, and other files are refused", TextOption{&Scene::nan, false}},
    {"--resample", "resample", "", "DICOM slices of a tilted gantry are resampled onto upright axes; they are refused otherwise", SwitchOption{&Scene::resample, "no", "yes", true}},
    {"--iso", "isovalue", "density", "isovalue: above it is object; if not given what a sculpted .vdb keeps, or chosen from the histogram",
     NumberOption{&Scene::isovalue, 1, -3.4e38, 3.4e38}},
    {"--gpu", "gpu", "", "part of the Vulkan device's name; the best one if not given", TextOption{&Scene::gpu}},
    {"--gpu-memory", "gpu_memory", "", "the most that densities and gradients may take on the Vulkan device; what it has if not given",
     BytesOption{&Scene::gpu_memory_bytes}},
    {"--gradient", "gradient", "", "gradients of the bricks that the isosurface needs, or of all",
     SwitchOption{&Scene::gradient_all, "active", "all"}},
    {"--filter", "filter", "", "filters that the field goes through before it is felt, one after another: \"gaussian:0.8mm\"; docs/filters.md",
     ListOption{&Scene::filter}},
    {"--field", "field", "", "what is felt: the density, or (after the filters) the signed distance from its isosurface, 4 voxels deep", WordOption{&Scene::field, kFields}},
    {"--gradient-operator", "gradient_operator", "", "how gradients are taken: central, sobel, central4, gaussian:SIGMA (gaussian:0.8mm); docs/gradients.md",
     TextOption{&Scene::gradient_operator}},
    {"--samples", "samples", "", "gradients and densities for the tool are kept as floats, or as halves in half the memory; docs/gradients.md",
     WordOption{&Scene::samples, kSampleForms}},
    {"--window", "window", "voxel", "edge of the box of samples around the tool that the servo reads: smaller ones are gathered sooner and more often", integer(&Scene::window_edge, 8, 32)},
    {"--algorithm", "servo.algorithm", "", "haptic algorithm", WordOption{&Scene::algorithm, algorithmNames()}},
    {"--n", "servo.n", "ticks", "the virtual plane is found again every n ticks", integer(&Scene::plane_renewal_ticks, 1, 100000)},
    {"--stiffness", "servo.stiffness_N_per_m", "N/m", kStiffnessHelp.c_str(), NumberOption{&Scene::stiffness_N_per_m, 1, 0, 1e5}},
    {"--damping", "servo.damping_Ns_per_m", "N s/m", kDampingHelp.c_str(), NumberOption{&Scene::damping_Ns_per_m, 1, 0, 1000}},
    {"--rate", "servo.rate_hz", "Hz", "servo rate", number(&Scene::rate_hz, 1, 10, 20000)},
    {"--seconds", "servo.seconds", "s", "how long the servo runs; with --path as long as the path", number(&Scene::duration_s, 1, 0.01, 3600)},
    {"--clock", "servo.clock", "", "real: keeps time; simulated: as fast as it can, the same trace on every run",
     SwitchOption{&Scene::simulated_clock, "real", "simulated"}},
    {"--service", "servo.service", "", "the servo runs in a process of its own, which outlives a fault of the engine's by as long as it takes to bring the force to zero (docs/service.md)", SwitchOption{&Scene::service, "no", "yes", true}},
    {"--require-real-time", "servo.require_real_time", "", "refuse to start where the system gives no real-time priority or locks no memory",
     SwitchOption{&Scene::require_real_time, "off", "on", true}},
    {"--haptization-density", "haptization.density", "density, N, N s/m",
     "force out of the dense and viscosity by density, linear between rows; from the isovalue and the volume if not given",
     TableOption{&Scene::haptization_density, 1, "density:force:viscosity"}},
    {"--haptization-gradient", "haptization.gradient", "density/mm, -",
     "weight of that force by the gradient's magnitude; from the volume if not given",
     TableOption{&Scene::haptization_gradient, kMillimetresPerMetre, "gradient:weight"}},
    {"--force-limit", "safety.force_limit_N", "N", "no larger force leaves the safety gate", numberAbove(&Scene::force_limit_N, 1, 0, 1000)},
    {"--slew-limit", "safety.slew_limit_N_per_s", "N/s", "no faster change of force leaves the safety gate: it is for jumps; much below stiffness times hand speed, contacts lag and shake", number(&Scene::slew_limit_N_per_s, 1, 1, 1e7)},
    {"--fade", "safety.fade_s", "s", "time in which the force fades to zero after a fault", number(&Scene::fade_s, 1, 0, 10)},
    {"--stale", "safety.stale_window_s", "s", "a window not confirmed for so long is a fault", number(&Scene::stale_window_s, 1, 0.001, 60)},
    {"--velocity", "servo.velocity", "", "velocity estimate: filter (low-pass) or foaw (first-order adaptive windowing)", WordOption{&Scene::velocity, velocityNames()}},
    {"--velocity-cutoff", "servo.velocity_cutoff_hz", "Hz", "cutoff of the velocity filter, 0: none", number(&Scene::velocity_cutoff_hz, 1, 0, 1e5)},
    {"--velocity-noise", "servo.velocity_noise_mm", "mm", "noise of the position that foaw overlooks; the encoders' resolution if not given",
     NumberOption{&Scene::velocity_noise_m, kMm, 0, 10}},
    {"--stall", "safety.stall_s", "s", "a tick later than this is a stall: the force starts again from nothing", number(&Scene::stall_s, 1, 0.0001, 60)},
    {"--report-timeout", "safety.report_timeout_s", "s", "a device position older than this is a fault", number(&Scene::report_timeout_s, 1, 0.0001, 60)},
    {"--passivity", "safety.passivity", "", "observe: the energy given to the hand is only counted; control: a damper takes back what was given too much",
     SwitchOption{&Scene::passivity_control, "observe", "control"}},
    {"--shaking", "safety.shaking", "", "end: an unstable contact loses its force until the tool has left it; leave: it goes on",
     SwitchOption{&Scene::leave_shaking, "end", "leave"}},
    {"--force-shading", "contact.force_shading", "", "between plane renewals the force turns with the surface", SwitchOption{&Scene::force_shading, "off", "on"}},
    {"--recovery", "contact.recovery_ms", "ms", "time over which a new plane takes effect, 0: at once", number(&Scene::recovery_s, 1e-3, 0, 1000)},
    {"--texture", "contact.texture", "", "fine relief: procedural, or from the density's fine structure", WordOption{&Scene::texture, kTextures}},
    {"--texture-amplitude", "contact.texture_amplitude_mm", "mm", "the texture moves the surface by no more", number(&Scene::texture_amplitude_m, kMm, 0, 10)},
    {"--texture-wavelength", "contact.texture_wavelength_mm", "mm", "shortest wavelength of the procedural texture", number(&Scene::texture_wavelength_m, kMm, 0.01, 1000)},
    {"--texture-gain", "contact.texture_gain", "", "times the density's departure from its trend, for the density texture", number(&Scene::texture_gain, 1, 0, 1000)},
    {"--friction-static", "contact.friction_static", "", "tangential to normal force at which the contact begins to slip", number(&Scene::friction_static, 1, 0, 10)},
    {"--friction-dynamic", "contact.friction_dynamic", "", "the same while it slips, at most the static friction", number(&Scene::friction_dynamic, 1, 0, 10)},
    {"--friction-viscous", "contact.friction_viscous_Ns_per_m", "N s/m", "force per speed while it slips", number(&Scene::friction_viscous_Ns_per_m, 1, 0, 1000)},
    {"--stiffness-density", "contact.stiffness_density", "", "stiffness by the density under the surface: factors of K, densities rising, linear between", TableOption{&Scene::stiffness_density, 1, "density:factor"}},
    {"--hand", "hand.kind", "", "rigid: the device is exactly on the path; spring: a hand pulls it and feels the force",
     SwitchOption{&Scene::spring_hand, "rigid", "spring"}},
    ofDevice("--hand-mass", "hand.mass_kg", "kg", &Scene::hand_mass_kg, 1, "hand_mass_kg"),
    ofDevice("--hand-damping", "hand.damping_Ns_per_m", "N s/m", &Scene::hand_damping_Ns_per_m, 1, "hand_damping_Ns_per_m"),
    ofDevice("--hand-stiffness", "hand.stiffness_N_per_m", "N/m", &Scene::hand_stiffness_N_per_m, 1, "hand_stiffness_N_per_m"),
    {"--device", "device.name", "", "haptic device; 'palpate devices' lists them", WordOption{&Scene::device, deviceNames()}},
    ofDevice("--device-mass", "device.mass_kg", "kg", &Scene::device_mass_kg, 1, "mass_kg"),
    ofDevice("--device-damping", "device.damping_Ns_per_m", "N s/m", &Scene::device_damping_Ns_per_m, 1, "damping_Ns_per_m"),
    ofDevice("--encoder", "device.encoder_resolution_mm", "mm", &Scene::encoder_resolution_m, kMm, "encoder_resolution_m"),
    ofDevice("--device-friction", "device.friction_N", "N", &Scene::device_friction_N, 1, "friction_N"),
    ofDevice("--dropped", "device.dropped_share", "", &Scene::device_dropped_share, 1, "dropped_share"),
    {"--delay", "device.delay_ticks", "ticks", "delay of the simulated device's force", integer(&Scene::device_delay_ticks, 0, 1000)},
    {"--recording", "device.recording", "", "the recorded session that --device recorded plays back", TextOption{&Scene::recording, false}},
    {"--record", "device.record", "", "file for all that the device says in this run, to be played back (docs/recording.md)", TextOption{&Scene::record, false}},
    {"--device-path", "device.path", "", "of several devices of a kind, the one there, as /dev/hidraw0", TextOption{&Scene::device_path, false}},
    {"--hid", "device.hid", "", "how a real device is reached: by the kernel, or by libusb, which takes it from the kernel",
     SwitchOption{&Scene::device_by_libusb, "hidraw", "libusb"}},
    {"--calibrated", "device.calibrated", "", "the device was calibrated since it was switched on, by another program", SwitchOption{&Scene::device_calibrated, "no", "yes", true}},
    {"--current-limit", "device.current_limit_A", "A", "what the amplifiers of the device's firmware bear; without it a Polhem exerts no force", NumberOption{&Scene::current_limit_A, 1, 0, 20, true}},
    {"--place-at", "device.place_at_mm", "mm", "world point of the middle of the device's workspace; the middle of the volume if not given", VectorOption{&Scene::place_at_W, kMm, false}},
    {"--place-turn", "device.place_turn_deg", "deg", "turns of the device about the world's x, then y, then z; if not given the user faces the patient: right is +x, up +z, towards the user -y", VectorOption{&Scene::place_turn_rad, 1 / kDegreesPerRadian, false}},
    {"--place-scale", "device.place_scale", "", "millimetres of the scene for one of the device; if not given 1, or as much more as the volume is larger than its workspace", NumberOption{&Scene::place_scale, 1, 0.001, 1000}},
    {"--force-scale", "device.force_scale", "", "newtons of the device for one of the scene", number(&Scene::force_scale, 1, 0.001, 1000)},
    {"--clutch", "device.clutch", "", "switch: while the handle's switch is pressed the tool stays where it is, without force",
     SwitchOption{&Scene::no_clutch, "switch", "off"}},
    {"--edge", "device.edge_stiffness_N_per_m", "N/m", "stiffness with which the end of the device's workspace pushes back, 0: not", number(&Scene::edge_stiffness_N_per_m, 1, 0, 2000)},
    {"--path", "path.file", "", "CSV file with header time_s,x_m,y_m,z_m, instead of a path built from the surface; a fifth column brush says where the tool edits, and how (--edit)", TextOption{&Scene::path_file, false}},
    {"--toward", "path.toward", "", "world direction in which the tool approaches; chosen if not given", VectorOption{&Scene::path_toward, 1, true}},
    {"--start", "path.start_mm", "mm", "world point near the surface where the press begins; chosen if not given", VectorOption{&Scene::path_start_W, kMm, false}},
    {"--slide-toward", "path.slide_toward", "", "world direction of the slide; chosen if not given", VectorOption{&Scene::path_slide, 1, true}},
    {"--edges", "path.edges", "", "follow: the slide goes around every edge; straight: where the surface falls away it goes straight on",
     SwitchOption{&Scene::straight_over_edges, "follow", "straight"}},
    {"--depth", "path.depth_mm", "mm", "how deep the path presses below the surface; if not given as fits the object, at most 1 on what a finger feels", NumberOption{&Scene::press_depth_m, kMm, 0, 100}},
    {"--slide", "path.slide_mm", "mm", "how far the path slides along the surface; if not given as fits the object, mostly 20", NumberOption{&Scene::slide_length_m, kMm, 0, 1000}},
    {"--approach", "path.approach_mm", "mm", "how far outside the path begins and ends; if not given as fits the object, mostly 10", NumberOption{&Scene::approach_m, kMm, 0.01, 1000}},
    {"--edit", "edit.brush", "", "the tool edits what it touches: remove, add, paint, flatten, smooth, inflate or deflate, with radius, strength, falloff, mirror ...: remove:radius=2mm",
     TextOption{&Scene::edit, false}},
    {"--journal", "edit.journal", "", "folder in which every edit is kept on disk as it goes, for 'palpate recover'", TextOption{&Scene::journal, false}},
    {"--save", "edit.save", "", "file in which the edited volume is saved beside the run, in a format that `palpate convert` writes", TextOption{&Scene::save, false}},
    {"--save-every", "edit.save_every_s", "s", "time between two saves, 0: one at the end of the run", number(&Scene::save_every_s, 1, 0, 86400)},
    {"--socket", "service.socket", "", "where servo and clients connect to 'palpate serve'; if not given service.sock in the runtime folder", TextOption{&Scene::service_socket, false}},
    {"--metrics-socket", "service.metrics_socket", "", "a socket at which the metrics of 'palpate serve' are read by HTTP, in Prometheus' form; none if not given", TextOption{&Scene::service_metrics_socket, false}},
    {"--log", "service.log", "", "messages of 'palpate serve' as text, or each as an object of JSON on a line of its own",
     WordOption{&Scene::service_log, kLogs}},
    {"--out", "output.folder", "", "folder for trace.csv, summary.json, report.html, view.png", TextOption{&Scene::out}},
    {"--trace", "output.trace", "", "write trace.csv", SwitchOption{&Scene::trace, "off", "on"}},
    {"--stopped-trace", "output.stopped_trace_ticks", "ticks", "a run that is stopped leaves trace.csv out above so many", integer(&Scene::stopped_trace_ticks, 0, 1'000'000'000)},
    {"--picture", "output.picture", "", "draw view.png", SwitchOption{&Scene::picture, "off", "on"}},
    {"--width", "output.width", "pixel", "width of view.png", integer(&Scene::image_width, 480, 3840)},
    {"--height", "output.height", "pixel", "height of view.png", integer(&Scene::image_height, 270, 3840)},
};
// clang-format on

}  // namespace

std::span<const SceneOption> sceneOptions() {
  return kOptions;
}

const SceneOption* optionOfKey(std::string_view key) {
  const auto* found =
      std::find_if(std::begin(kOptions), std::end(kOptions), [&](const auto& o) { return key == o.key; });
  return found == std::end(kOptions) ? nullptr : found;
}

bool isOfService(const SceneOption& option) {
  return std::string_view(option.key).starts_with("service.");
}

const char* optionGroup(const SceneOption& option) {
  struct Group {
    const char* table;  // of the TOML file
    const char* title;
  };
  static constexpr Group kGroups[] = {{"servo", "Servo"},
                                      {"haptization", "Force from the density (--algorithm haptization)"},
                                      {"safety", "Safety"},
                                      {"contact", "What the contact feels like"},
                                      {"hand", "Hand"},
                                      {"device", "Device"},
                                      {"path", "The tool's path"},
                                      {"edit", "Edits"},
                                      {"service", "Service"},
                                      {"output", "Output"}};
  const std::string_view key = option.key;
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) return "Volume and what is computed of it";
  const auto* found = std::find_if(std::begin(kGroups), std::end(kGroups),
                                   [&](const Group& g) { return key.substr(0, dot) == g.table; });
  return found->title;
}

std::string optionHelp(const SceneOption& option, const Scene& usual) {
  const std::string standard = optionText(option.value, usual);
  std::string text = option.help;
  if (*option.unit != '\0') text += fmt::format(" [{}]", option.unit);
  if (isBare(option.value))
    return text + fmt::format(" (no value; key {}: {}; default {})", option.key, optionForm(option.value), standard);
  text += " (";
  if (!std::holds_alternative<TextOption>(option.value)) text += optionForm(option.value) + "; ";
  if (!standard.empty()) text += fmt::format("default {}; ", standard);
  return text + fmt::format("key {})", option.key);
}

std::string sceneDocument() {
  std::string text =
      R"(# Scene files

A scene is a TOML file: `palpate touch scene.toml`. Every flag overrides its key. A dot in a key is a TOML table:
`servo.n` stands for `n` under `[servo]`. `x,y,z` is written `[x, y, z]`, rows `a:b,c:d` `[[a, b], [c, d]]`. Relative paths of `volume`
and `path.file` start at the scene's folder, that of `output.folder` where the program is started. This page is printed by
`palpate scene`.

| key | flag | unit | takes | default | meaning |
|---|---|---|---|---|---|
)";
  for (const SceneOption& option : kOptions) {
    text += fmt::format("| `{}` | `{}` | {} | {} | {} | {} |\n", option.key, option.flag, option.unit,
                        optionForm(option.value), optionText(option.value, Scene{}), option.help);
  }
  text +=
      "\n## Algorithms\n\nMore on each: [algorithms.md](algorithms.md).\n\n| `--algorithm` | what it is |\n|---|---|\n";
  for (const AlgorithmEntry& entry : algorithms())
    text += fmt::format("| `{}` | {} |\n", entry.name, entry.description);
  return text + objectDocument();
}

}  // namespace palpate
