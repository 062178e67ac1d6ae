// SPDX-License-Identifier: Apache-2.0
// apps/check/gradient_check.hpp: compares the gradients of the GPU with the CPU twin: three components and the density
// of each voxel. The GPU's time is that of the kernel, without its first run and without smoothing. Thread: one. Cost:
// a pass over the volume on both sides, and 24 bytes a voxel of host memory, 16 more for an operator that smooths.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "apps/check/check.hpp"
#include "engine/field/volume.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/gradient/sample_format.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

struct GradientCheckRequest {
  std::string gpu = {};            // part of the device's name
  GradientOperator gradient = {};  // the operator to check
  SampleFormat format = {};        // how samples are stored and compared
  std::uint32_t bound_ulp = 0;     // largest difference that is promised [ULP]
};

// `progress` gets the fraction done, and may throw to cancel.
[[nodiscard]] Check checkGradient(const Volume& volume, const GradientCheckRequest& request,
                                  const std::function<void(double)>& progress);

// The same, with a separate field for the twin, so that a test can make the two sides differ.
[[nodiscard]] Check checkGradient(const Volume& volume, const reference::DenseField& field,
                                  const GradientCheckRequest& request, const std::function<void(double)>& progress);

}  // namespace palpate
