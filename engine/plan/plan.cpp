// SPDX-License-Identifier: Apache-2.0
#include "engine/plan/plan.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate {
namespace {

// A brick's 512 voxels: density 4 bytes, sample (gradient and density) 16 bytes, or 8 as halves.
constexpr std::uint64_t kDensityBytes = 512 * 4;
constexpr std::uint64_t kSampleBytes = 512 * 16;
constexpr std::uint64_t kHalfSampleBytes = 512 * 8;

std::uint64_t sampleBytes(const Plan& plan) {
  return plan.half_samples ? kHalfSampleBytes : kSampleBytes;
}

PlanLine uploadLine(const PlanFacts& facts) {
  return {true, fmt::format("{} of {} bricks of density", facts.stored_bricks, facts.bricks),
          "a brick that holds one value has a page and no storage",
          (facts.bricks - facts.stored_bricks) * kDensityBytes};
}

PlanLine gradientLine(const Plan& plan, const PlanFacts& facts) {
  PlanLine line{
      true,
      fmt::format("gradient of {} of {} bricks: {}", facts.gradient_bricks, facts.bricks, plan.gradient.words.name), "",
      0};
  if (plan.gradient_all) {
    line.why = "every brick: --gradient all, or an algorithm that feels away from the isosurface";
  } else {
    line.why = "those that the isosurface crosses, and their halo";
    line.saved_bytes = (facts.bricks - facts.gradient_bricks) * sampleBytes(plan);
  }
  return line;
}

PlanLine samplesLine(const Plan& plan, const PlanFacts& facts) {
  if (!plan.half_samples) return {true, "samples as floats, 16 bytes a voxel", "halves save half: --samples half", 0};
  return {true, "samples as halves, 8 bytes a voxel", "--samples half: true to 2^-11 of the distance from the isovalue",
          facts.gradient_bricks * (kSampleBytes - kHalfSampleBytes)};
}

PlanLine filterLine(const Plan& plan, const PlanFacts& facts) {
  if (plan.filters.empty()) {
    return {false, "filters", "the scene names none: the volume itself is felt", (facts.stored_bricks) * kDensityBytes};
  }
  return {true, fmt::format("filters: {}; {} of {} bricks", plan.filter_words, facts.filtered_bricks, facts.bricks),
          "as the scene says; a neighbourhood of one density stays one",
          (facts.bricks - facts.filtered_bricks) * kDensityBytes};
}

PlanLine meshLine(const Plan& plan, const PlanFacts& facts) {
  if (!plan.meshes) return {false, "mesh of the isosurface", "the algorithm touches the volume itself", 0};
  const std::string size = facts.mesh_triangles > 0 ? fmt::format(", {} triangles", facts.mesh_triangles) : "";
  return {true, "mesh of the isosurface" + size, "the algorithm touches a mesh", 0};
}

}  // namespace

const char* passName(Pass pass) noexcept {
  switch (pass) {
    case Pass::kUpload:
      return "upload";
    case Pass::kFilter:
      return "filter";
    case Pass::kBrickBounds:
      return "brick bounds";
    case Pass::kSmoothing:
      return "smoothing";
    case Pass::kGradient:
      return "gradient";
    case Pass::kWindow:
      return "window";
    case Pass::kIsosurface:
      return "isosurface";
  }
  return "?";
}

bool Plan::has(Pass pass) const noexcept {
  return std::find(passes.begin(), passes.end(), pass) != passes.end();
}

// In the order in which they act (servo/contact/effects.hpp).
static std::string effectNames(const Scene& scene) {
  std::string names;
  const auto add = [&](bool asked, const char* name) {
    if (asked) names += (names.empty() ? "" : ", ") + std::string(name);
  };
  add(scene.force_shading, "force shading");
  add(scene.recovery_s > 0, "recovery time");
  add(scene.texture != "none", "texture");
  add(scene.friction_static > 0 || scene.friction_viscous_Ns_per_m > 0, "friction");
  add(!scene.stiffness_density.empty(), "stiffness by density");
  return names;
}

Plan makePlan(const Scene& scene, bool needs_mesh) {
  Plan plan;
  plan.gradient_all = scene.gradient_all;
  plan.gradient = gradientOperator(scene.gradient_operator);
  plan.half_samples = scene.samples == "half";
  plan.edits = !scene.edit.empty();
  plan.draws = scene.picture;
  plan.meshes = needs_mesh;
  plan.objects = scene.objects.size();
  plan.effects = effectNames(scene);
  plan.passes = {Pass::kUpload};
  const std::string distance = scene.field == "distance" ? "distance:4" : "";
  if (!scene.filter.empty() || !distance.empty()) {
    plan.filter_words = scene.filter + (scene.filter.empty() || distance.empty() ? "" : " ") + distance;
    plan.filters = filterChain(plan.filter_words);
    plan.passes.push_back(Pass::kFilter);
  }
  // Bounds choose the bricks with gradients and let the renderer skip; without either nobody reads them.
  if (!plan.gradient_all || plan.draws) plan.passes.push_back(Pass::kBrickBounds);
  if (plan.gradient.smooths()) plan.passes.push_back(Pass::kSmoothing);
  plan.passes.insert(plan.passes.end(), {Pass::kGradient, Pass::kWindow});
  if (plan.draws) plan.passes.push_back(Pass::kIsosurface);
  return plan;
}

std::vector<PlanLine> planLines(const Plan& plan, const PlanFacts& facts) {
  std::vector<PlanLine> lines = {uploadLine(facts), filterLine(plan, facts), gradientLine(plan, facts),
                                 samplesLine(plan, facts)};
  if (plan.has(Pass::kSmoothing)) {
    const char* why = plan.edits ? "the operator takes its gradient; kept, since edits change it"
                                 : "the operator takes its gradient; freed then, since nothing is edited";
    lines.insert(lines.begin() + 2, {true, "smoothing of the whole field", why, 0});
  }
  lines.push_back({true, "window of up to 32x32x32 samples around the tool, three slots", "what the servo reads", 0});
  if (plan.draws) {
    lines.push_back({true, "isosurface picture", "view.png and report.html show it", 0});
  } else {
    lines.push_back({false, "isosurface picture", "not asked for (--picture off)", 0});
  }
  if (!plan.has(Pass::kBrickBounds))
    lines.push_back({false, "brick bounds", "every brick has gradients and nothing is drawn", 0});
  lines.push_back(meshLine(plan, facts));
  if (plan.objects > 0) {
    lines.push_back({true, fmt::format("{} object{} beside the volume", plan.objects, plan.objects == 1 ? "" : "s"),
                     "as the scene says", 0});
  } else {
    lines.push_back({false, "objects beside the volume", "the scene names none", 0});
  }
  lines.push_back(plan.effects.empty() ? PlanLine{false, "contact effects", "the scene names none", 0}
                                       : PlanLine{true, "contact effects: " + plan.effects, "as the scene says", 0});
  return lines;
}

}  // namespace palpate
