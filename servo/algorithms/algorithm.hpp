// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/algorithm.hpp: the interface of every haptic algorithm: position, velocity and window in; VHIP,
// force and state out.
//
// Frames: everything is in the world W [m, m/s, N]. Normals point out of the object: N = -grad / |grad|.
// Force convention, stated once: d = VHIP - HIP points out of the object, and F = K d - B v_d. v_d is the part of the
// HIP's velocity along N. So F pushes the device out and damps its motion along N.
// Thread: only the servo calls these, reset() also before the loop starts; no heap, lock, system call or throw.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {

struct AlgorithmParameters {
  double isovalue = 0;             // tau: above it is object [density]
  double stiffness_N_per_m = 500;  // K [N/m]
  double damping_Ns_per_m = 0.5;   // B [N s/m]
  int plane_renewal_ticks = 5;     // n: the plane is renewed every n ticks; 1: every tick [tick]
  double rate_hz = 1000;           // ticks per second, for durations in seconds (edit_ease.hpp) [Hz]

  [[nodiscard]] bool operator==(const AlgorithmParameters&) const = default;
};

struct TickInput {
  Vec3 hip_W = Vec3::Zero();             // device position [m]
  Vec3 hip_velocity_W = Vec3::Zero();    // [m/s]
  const SampleWindow* window = nullptr;  // never null while the loop runs; may be unusable
};

struct TickOutput {
  Vec3 vhip_W = Vec3::Zero();    // virtual haptic interface point [m]
  Vec3 normal_W = Vec3::Zero();  // of the plane in contact; zero without contact [-]
  Vec3 force_W = Vec3::Zero();   // before the safety gate [N]
  // Depth of the HIP below the surface, along the normal, before effects move the VHIP [m]. 0 without contact; NaN for
  // an algorithm that knows no surface.
  double depth_m = 0;
  double stored_J = 0;  // what the contact's springs hold and can give back; NaN if the algorithm does not know [J]
  bool in_contact = false;
  std::int32_t plane_age_ticks = 0;  // ticks since the plane was found; 0 without a plane
  std::int32_t effects = 0;          // contact effects that ran in this tick
  std::uint32_t faults = 0;          // bits of ServoFault (servo/safety/faults.hpp)
  // The next window is needed around `surface_W`, not around the HIP. True in contact, and while a contact is
  // remembered whose surface point the window does not hold.
  bool at_surface = false;
  Vec3 surface_W = Vec3::Zero();  // [m]
};

class Algorithm {
 public:
  virtual ~Algorithm() = default;
  // Forgets all state and puts the VHIP at `hip_W`, as at the start of a run: a contact begins from outside.
  virtual void reset(const Vec3& hip_W) noexcept = 0;
  // Forgets all state and takes over from another algorithm in the loop. The tool was last known to be outside at
  // `free_W`. The next tick searches the line from there to the HIP, so that a contact goes on.
  virtual void resume(const Vec3& free_W, const Vec3& hip_W) noexcept {
    static_cast<void>(free_W);
    reset(hip_W);
  }
  virtual void tick(const TickInput& in, TickOutput& out) noexcept = 0;
};

}  // namespace palpate
