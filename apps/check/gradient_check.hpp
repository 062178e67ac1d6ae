// SPDX-License-Identifier: Apache-2.0
// apps/check/gradient_check.hpp: every gradient of the GPU against the CPU twin. Thread: one. Cost: a pass over the
// volume on both sides, and 24 bytes a voxel of host memory; an operator that smooths: 16 more.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "engine/gpu/gpu.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/gradient/sample_format.hpp"
#include "engine/reference/dense_field.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

struct GradientCheckRequest {
  std::string gpu = {};            // part of the device's name
  GradientOperator gradient = {};  // how it is taken
  SampleFormat format = {};        // in which form it is stored and compared
};

struct GradientCheck {
  std::uint64_t compared = 0;   // floats: three gradient components and the density of each voxel
  std::uint64_t differing = 0;  // whose bits differ
  std::uint32_t largest_ulp = 0;
  Vec3i voxel = Vec3i::Zero();  // where that is
  std::string component;        // "gradient_i" ... "density"
  float gpu_value = 0;          // there
  float cpu_value = 0;
  std::string device;
  double gpu_seconds = 0;  // of the kernel, first run and smoothing excluded
  double cpu_seconds = 0;  // of the twin
};

// `progress` gets the fraction done, and may throw to cancel.
[[nodiscard]] GradientCheck checkGradient(const Volume& volume, const GradientCheckRequest& request,
                                          const std::function<void(double)>& progress);

// The same with the field that the twin reads given apart, so that a test can make the two sides differ.
[[nodiscard]] GradientCheck checkGradient(const Volume& volume, const reference::DenseField& field,
                                          const GradientCheckRequest& request,
                                          const std::function<void(double)>& progress);

}  // namespace palpate
