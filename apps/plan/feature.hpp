// SPDX-License-Identifier: Apache-2.0
// apps/plan/feature.hpp: what a scene may have beside the bare touch of a volume, as a table: filters, effects,
// objects, edits, pictures. So that the cost of each can be counted, each can be switched on or off in any scene. Any
// thread.
//
// The bare touch is the density of a volume, gradients where its isosurface is, an algorithm that feels samples, a
// simulated device, and a summary.
#pragma once

#include <filesystem>
#include <span>

#include "apps/scene/scene.hpp"

namespace palpate {

struct Feature {
  const char* name;     // "friction"
  const char* example;  // what is switched on where a scene has none: "gaussian:1"
  const char* why_not;  // why a scene lacks it: "the scene names none"
  const char* why;      // why a scene has it
  bool (*is_in)(const Scene& scene);
  void (*add)(Scene& scene, const std::filesystem::path& folder);  // files that it needs go into the folder
  void (*remove)(Scene& scene);
  bool adds = true;  // to what is there; false: something else takes its place (another algorithm, another field)
};

// In the order of a ladder: each can be added to those before it.
[[nodiscard]] std::span<const Feature> features();

// The scene without any feature.
[[nodiscard]] Scene bareScene(const Scene& scene);

}  // namespace palpate
