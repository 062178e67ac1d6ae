// SPDX-License-Identifier: Apache-2.0
// apps/scene/scene.hpp: everything that a user can ask of a run of `palpate touch`, with its defaults.
//
// Values are in SI units. The table in apps/scene/ gives each its flag, TOML key, screen unit and help text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/scene/object_spec.hpp"
#include "base/vec.hpp"

namespace palpate {

using NumberTable = std::vector<std::vector<double>>;  // rows of equal length

[[nodiscard]] std::string defaultAlgorithm();  // servo/algorithms/registry.hpp
// Of the default device (servo/devices/registry.hpp): its name, and the usual value of one of its parameters, in the
// unit that the key ends with. Throws std::logic_error for a key that it does not have.
[[nodiscard]] std::string defaultDevice();
[[nodiscard]] double usualOfDevice(std::string_view key);

// What the servo's parameters are where nobody sets them. Their owners are LoopParameters, AlgorithmParameters and
// EffectParameters, which have the same members.
struct ServoDefaults {
  double rate_hz, stiffness_N_per_m, damping_Ns_per_m;
  int plane_renewal_ticks;
  std::string_view velocity;
  double velocity_cutoff_hz;
  double force_limit_N, slew_limit_N_per_s, fade_s, stale_window_s, stall_s, report_timeout_s;
  double recovery_s, texture_amplitude_m, texture_wavelength_m, texture_gain;
  double friction_static, friction_dynamic, friction_viscous_Ns_per_m;
};
[[nodiscard]] const ServoDefaults& servoDefaults() noexcept;

struct Scene {
  // volume
  std::string volume;  // file, folder or phantom:NAME?...
  std::string nan;  // density of voxels that are NaN or infinite, as text; empty: NIfTI's become 0, others are refused
  bool resample = false;            // slices of a tilted gantry are resampled upright; otherwise they are refused
  std::string series;               // of a DICOM folder: number or UID; empty: the only one, or volume names it
  std::optional<double> isovalue;   // tau; empty: suggested from the histogram [density]
  std::vector<ObjectSpec> objects;  // beside the volume
  // compute
  std::string gpu;                            // part of the Vulkan device's name; empty: the best one
  std::uint64_t gpu_memory_bytes = 0;         // limit for densities and samples on the GPU; 0: the device's own [byte]
  std::string filter;                         // chain that makes the field that is felt: "gaussian:0.8mm"; empty: none
  std::string field = "density";              // the field that is felt: "density", or "distance" from the isosurface
  bool gradient_all = false;                  // gradients of every brick, not only of those that the isosurface needs
  std::string gradient_operator = "central";  // engine/gradient/gradient_operator.hpp
  std::string samples = "float";              // or "half": how the GPU stores samples (gradient, density)
  int window_edge = 32;                       // samples along an edge of the window that the servo reads [voxel]
  // servo
  std::string algorithm = defaultAlgorithm();
  int plane_renewal_ticks = servoDefaults().plane_renewal_ticks;  // n: the plane is found anew every n ticks
  std::optional<double> stiffness_N_per_m;                        // empty: usual, or what a device that is held bears
  std::optional<double> damping_Ns_per_m;                         // likewise
  double rate_hz = servoDefaults().rate_hz;
  double duration_s = 5;
  bool simulated_clock = false;
  bool service = false;            // the servo runs in a process of its own
  bool require_real_time = false;  // refuse to run without real-time priority and locked memory
  std::string velocity = std::string(servoDefaults().velocity);    // name of the HIP's velocity estimator
  double velocity_cutoff_hz = servoDefaults().velocity_cutoff_hz;  // of "filter"; 0: none
  std::optional<double> velocity_noise_m;                          // of "foaw"; empty: the encoders' resolution
  // haptization's transfer function; a table without rows: chosen from the isovalue and the volume
  NumberTable haptization_density;   // rows: density, force [N], viscosity [N s/m]
  NumberTable haptization_gradient;  // rows: gradient [density/m], weight [-]
  // safety
  double force_limit_N = servoDefaults().force_limit_N;            // of the simulated device
  double slew_limit_N_per_s = servoDefaults().slew_limit_N_per_s;  // servo/safety/safety_gate.hpp says why
  double fade_s = servoDefaults().fade_s;                          // time in which a faulty force fades to zero
  double stale_window_s = servoDefaults().stale_window_s;          // a window unconfirmed for so long is a fault
  double stall_s = servoDefaults().stall_s;                        // a tick later than this ends a stall
  double report_timeout_s = servoDefaults().report_timeout_s;      // a device position older than this is a fault
  bool passivity_control = false;                                  // false: observe only
  bool leave_shaking = false;                                      // false: an unstable contact loses its force
  // contact effects; all off
  bool force_shading = false;
  double recovery_s = servoDefaults().recovery_s;                      // 0: none
  std::string texture = "none";                                        // none, procedural or density
  double texture_amplitude_m = servoDefaults().texture_amplitude_m;    // limit on how far a texture moves the VHIP
  double texture_wavelength_m = servoDefaults().texture_wavelength_m;  // of the procedural texture
  double texture_gain = servoDefaults().texture_gain;                  // of the density texture [-]
  double friction_static = servoDefaults().friction_static;            // mu_s [-]
  double friction_dynamic = servoDefaults().friction_dynamic;          // mu_d, at most mu_s [-]
  double friction_viscous_Ns_per_m = servoDefaults().friction_viscous_Ns_per_m;
  NumberTable stiffness_density;  // rows of density, factor [-]; empty: none
  // device, and the hand of a simulated one; apps/servo_setup/scene_settings.cpp hands them to the registry
  std::string device = defaultDevice();
  bool spring_hand = usualOfDevice("spring_hand") > 0;  // false: the HIP is exactly the path
  double hand_mass_kg = usualOfDevice("hand_mass_kg");
  double hand_damping_Ns_per_m = usualOfDevice("hand_damping_Ns_per_m");
  double hand_stiffness_N_per_m = usualOfDevice("hand_stiffness_N_per_m");
  double device_mass_kg = usualOfDevice("mass_kg");
  double device_damping_Ns_per_m = usualOfDevice("damping_Ns_per_m");
  double encoder_resolution_m = usualOfDevice("encoder_resolution_m");  // 0: none
  double device_friction_N = usualOfDevice("friction_N");
  double device_dropped_share = usualOfDevice("dropped_share");
  int device_delay_ticks = static_cast<int>(usualOfDevice("delay_ticks"));
  std::string recording;  // file that "recorded" plays back
  std::string record;     // file for what the device says; empty: none
  // a real device, and its place in the scene (servo/devices/placed_device.hpp)
  std::string device_path;                // "/dev/hidraw0"; empty: the only one of its kind
  bool device_by_libusb = false;          // false: by the kernel's hidraw
  bool device_calibrated = false;         // since it was switched on, by another program
  std::optional<double> current_limit_A;  // of its firmware's amplifiers; empty: not known, and forces stay off
  std::optional<Vec3> place_at_W;         // where the middle of its workspace lies; empty: the middle of the volume [m]
  std::optional<Vec3> place_turn_rad;     // about the world's x, then y, then z; empty: the user faces the patient
  std::optional<double> place_scale;      // scene's metres for one of the device; empty: its workspace holds the volume
  double force_scale = 1;                 // device's newtons for one of the scene
  bool no_clutch = false;                 // false: the handle's switch is a clutch
  double edge_stiffness_N_per_m = 300;    // with which the end of its workspace pushes back, 0: not
  // path: a CSV file, or built from the surface
  std::string path_file;
  std::optional<Vec3> path_toward;      // direction in which the tool approaches (world); empty: chosen
  std::optional<Vec3> path_start_W;     // a point near the surface, where the press begins [m]; empty: chosen
  std::optional<Vec3> path_slide;       // direction of the slide (world); empty: chosen
  bool straight_over_edges = false;     // false: the slide follows the surface around every edge
  std::optional<double> press_depth_m;  // of a built path, as the next two; empty: chosen to fit the object [m]
  std::optional<double> slide_length_m;
  std::optional<double> approach_m;
  // edits
  std::string edit;         // brush that the tool drives: "remove:radius=2mm"; empty: none
  std::string journal;      // folder of the journal, which keeps edits as they are made; empty: none
  std::string save;         // file for the edited volume; empty: none
  double save_every_s = 0;  // interval between saves; 0: only at the end of the run [s]
  // service; of `palpate serve` alone
  std::string service_socket;          // where servo and clients connect; empty: the usual place
  std::string service_metrics_socket;  // where metrics are read by HTTP; empty: nowhere
  std::string service_log = "text";    // or "json": how messages look
  // output
  std::string out = "out";
  bool trace = true;                  // write trace.csv
  int stopped_trace_ticks = 500'000;  // a run that is stopped writes it up to so many ticks
  bool picture = true;                // draw view.png
  int image_width = 1280;
  int image_height = 720;
};

[[nodiscard]] inline double stiffnessOf(const Scene& scene) noexcept {
  return scene.stiffness_N_per_m ? *scene.stiffness_N_per_m : servoDefaults().stiffness_N_per_m;
}
[[nodiscard]] inline double dampingOf(const Scene& scene) noexcept {
  return scene.damping_Ns_per_m ? *scene.damping_Ns_per_m : servoDefaults().damping_Ns_per_m;
}

}  // namespace palpate
