// SPDX-License-Identifier: Apache-2.0
// apps/check/edit_check.hpp: applies random edits through the engine, as a session does, and compares every density of
// the volume that is read back with the CPU twin. Thread: one.
//
// Cost: the twin visits every voxel for every edit: 100 edits of 64^3 voxels take it about a second.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "apps/check/check.hpp"
#include "engine/field/volume.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

struct EditCheckRequest {
  std::string gpu = {};                           // part of the device's name
  int edits = 100;                                // of all kinds (engine/edit/random_edits.hpp)
  unsigned seed = 1;                              // of their kinds, places and strengths
  std::optional<double> isovalue = std::nullopt;  // empty: the volume's default
};

// `progress` gets the fraction done, and may throw to cancel. Throws Error as Engine does.
[[nodiscard]] Check checkEdits(const Volume& volume, const EditCheckRequest& request,
                               const std::function<void(double)>& progress);

// The same, with a separate field for the twin, so that a test can make the two sides differ.
[[nodiscard]] Check checkEdits(const Volume& volume, reference::DenseField field, const EditCheckRequest& request,
                               const std::function<void(double)>& progress);

}  // namespace palpate
