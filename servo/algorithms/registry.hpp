// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/registry.hpp: the haptic algorithms by name. A new one is a file here and a row in registry.cpp.
//
// Set-up only: allocates and throws.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/plane_age.hpp"
#include "servo/algorithms/transfer_function.hpp"
#include "servo/contact/contact_effect.hpp"
#include "servo/objects/object_contacts.hpp"

namespace palpate {

// What an algorithm is made from. Each algorithm takes what it needs and refuses what it cannot use.
struct AlgorithmSetup {
  AlgorithmParameters parameters = {};
  ContactEffects effects = {};
  TransferTables haptization = {};  // without density rows: standard tables from isovalue and `scale`
  DensityScale scale = {};
  ContactObjects objects = {};                                // solids beside the volume
  std::shared_ptr<const ContactObject> isosurface = nullptr;  // as a mesh, for an algorithm that needs it
};

// What the caller must provide before the algorithm is made.
struct AlgorithmNeeds {
  bool gradient_everywhere = false;  // it reads gradients away from the isosurface too
  bool isosurface_mesh = false;      // AlgorithmSetup::isosurface
};

// Properties for comparing algorithms.
struct AlgorithmTraits {
  bool renews_planes = false;  // plane_renewal_ticks has an effect
  bool takes_tables = false;   // AlgorithmSetup::haptization
  bool shows_surface = true;   // its VHIP is an estimate of the surface point; false: its VHIP is the HIP
  double stiffening = 1;       // how many times as stiff as asked a contact may be felt, beside what effects do
};

// How far the plane may be off at most, when the tick that uses it last ends [m]; 0: it keeps no plane.
using PlaneAgeError = double (*)(const PlaneAge& age) noexcept;
[[nodiscard]] constexpr double keepsNoPlane(const PlaneAge& /*age*/) noexcept {
  return 0;
}

struct AlgorithmEntry {
  std::string_view name;
  std::string_view description;  // one line
  std::unique_ptr<Algorithm> (*make)(AlgorithmSetup&& setup);
  AlgorithmNeeds needs = {};
  AlgorithmTraits traits = {};
  PlaneAgeError plane_age_error = keepsNoPlane;
};

// The first is the default.
[[nodiscard]] std::span<const AlgorithmEntry> algorithms() noexcept;

// Throws Error(kBadInput) on an unknown name (the message names the known ones).
[[nodiscard]] const AlgorithmEntry& algorithmEntry(std::string_view name);

// Throws Error(kBadInput) on
// - an unknown name;
// - a renewal below 1 tick, a negative or non-finite stiffness or damping, a non-finite isovalue, a rate that is not
//   above 0;
// - effects or objects for an algorithm that takes none;
// - tables that TransferFunction refuses, for an algorithm that uses them;
// - a missing mesh of the isosurface, for an algorithm that needs one.
[[nodiscard]] std::unique_ptr<Algorithm> makeAlgorithm(std::string_view name, AlgorithmSetup setup);

}  // namespace palpate
