// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/algorithm.hpp: what every haptic algorithm is: position, velocity, window -> VHIP, force, state.
//
// Frames: everything is in the world W [m, m/s, N]. Normals point out of the object: N = -grad / |grad|.
// Force convention, stated once: d = VHIP - HIP points out of the object, and F = K d - B v_d with v_d the part of the
// HIP's velocity along N, so that F pushes the device out and damps its motion along N. Thread: tick() is called by the
// servo thread alone; no heap, lock, system call or throw. reset() before the loop starts.
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
  int plane_renewal_ticks = 5;     // n: the plane is found again every n ticks, 1: every tick [tick]
  double rate_hz = 1000;           // of the ticks: for what lasts a set time (edit_ease.hpp) [Hz]
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
  // Of the HIP below the surface, along the normal, before effects move the VHIP; NaN for an algorithm that knows no
  // surface; 0 without contact [m].
  double depth_m = 0;
  bool in_contact = false;
  std::int32_t plane_age_ticks = 0;  // ticks since the plane was found; 0 without a plane
  std::uint32_t faults = 0;          // bits of ServoFault (servo/safety/faults.hpp)
  // Samples are needed around `surface_W` and not around the HIP: in contact, and where a contact is only remembered
  // because the window does not hold it.
  bool at_surface = false;
  Vec3 surface_W = Vec3::Zero();  // [m]
};

class Algorithm {
 public:
  virtual ~Algorithm() = default;
  // Forgets all state and puts the VHIP at `hip_W`. Not in the loop.
  virtual void reset(const Vec3& hip_W) noexcept = 0;
  virtual void tick(const TickInput& in, TickOutput& out) noexcept = 0;
};

}  // namespace palpate
