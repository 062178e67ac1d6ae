// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scene_plan.hpp"

#include <fmt/format.h>

#include "apps/servo_setup/scene_settings.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

PlanLine meshLine(const Scene& scene, std::size_t triangles) {
  if (!algorithmEntry(scene.algorithm).needs.isosurface_mesh)
    return {false, "mesh of the isosurface", "the algorithm touches the volume itself", 0};
  const std::string size = triangles > 0 ? fmt::format(", {} triangles", triangles) : "";
  return {true, "mesh of the isosurface" + size, "the algorithm touches a mesh", 0};
}

PlanLine objectsLine(const Scene& scene) {
  const std::size_t count = scene.objects.size();
  if (count == 0) return {false, "objects beside the volume", "the scene names none", 0};
  return {true, fmt::format("{} object{} beside the volume", count, count == 1 ? "" : "s"), "as the scene says", 0};
}

PlanLine effectsLine(const Scene& scene) {
  const std::string names = contactEffectNames(effectParameters(scene));
  if (names.empty()) return {false, "contact effects", "the scene names none", 0};
  return {true, "contact effects: " + names, "as the scene says", 0};
}

}  // namespace

Plan planFor(const Scene& scene) {
  const AlgorithmNeeds& needs = algorithmEntry(scene.algorithm).needs;
  return makePlan({.filter = scene.filter,
                   .distance = scene.field == "distance",
                   .gradient_all = scene.gradient_all || needs.gradient_everywhere,
                   .gradient_operator = scene.gradient_operator,
                   .half_samples = scene.samples == "half",
                   .window_edge = scene.window_edge,
                   .edits = !scene.edit.empty(),
                   .draws = scene.picture,
                   .gradients_as_needed = true});
}

std::vector<PlanLine> scenePlanLines(const Scene& scene, const Plan& plan, const PlanFacts& facts,
                                     std::size_t mesh_triangles) {
  std::vector<PlanLine> lines = planLines(plan, facts);
  lines.insert(lines.end(), {meshLine(scene, mesh_triangles), objectsLine(scene), effectsLine(scene)});
  return lines;
}

}  // namespace palpate
