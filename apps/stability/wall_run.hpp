// SPDX-License-Identifier: Apache-2.0
// apps/stability/wall_run.hpp: a simulated hand presses the device onto a wall, with the real servo loop and
// algorithms.
//
// Simulated clock: the same run gives the same ticks, bit for
// bit. World frame W. Cost: some microsecond a tick.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/stability/wall_volume.hpp"
#include "servo/contact/effects.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/stability/sampled_loop.hpp"

namespace palpate {

struct WallContact {
  Wall wall = {};
  std::string algorithm = "hri";
  int n = AlgorithmParameters{}.plane_renewal_ticks;
  EffectParameters effects = {};
};

struct WallRun {
  WallContact contact;
  SimulatedDeviceParameters device;
  LoopParameters loop;  // its ticks are set; without record_ticks all are kept
  double seconds = 1;
  std::function<Vec3(double time_s)> hand_W;  // where the hand wants the tool [m]
  // Contacts that take over, each after so long, in the order of time.
  struct Change {
    double time_s;
    WallContact contact;
  };
  std::vector<Change> changes = {};
};

// A device with a hand that holds it, and a loop without limits that would act before instability does.
[[nodiscard]] SimulatedDeviceParameters heldDevice(const HandParameters& hand);
[[nodiscard]] LoopParameters limitlessLoop(double rate_hz);

// Throws Error as makeAlgorithm() and ServoLoop do.
[[nodiscard]] std::vector<TickRecord> play(const WallRun& run, const WallVolume& volume);

}  // namespace palpate
