// SPDX-License-Identifier: Apache-2.0
// apps/check/gradient_check.hpp: every gradient of the GPU against the CPU twin. Thread: one. Cost: a pass over the
// volume on both sides, and 24 bytes a voxel of host memory; an operator that smooths: 16 more. Compared are three
// gradient components and the density of each voxel; the GPU's time is the kernel's, first run and smoothing excluded.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "apps/check/check.hpp"
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
  std::uint32_t bound_ulp = 0;     // largest difference that is promised [ULP]
};

// `progress` gets the fraction done, and may throw to cancel.
[[nodiscard]] Check checkGradient(const Volume& volume, const GradientCheckRequest& request,
                                  const std::function<void(double)>& progress);

// The same with the field that the twin reads given apart, so that a test can make the two sides differ.
[[nodiscard]] Check checkGradient(const Volume& volume, const reference::DenseField& field,
                                  const GradientCheckRequest& request, const std::function<void(double)>& progress);

}  // namespace palpate
