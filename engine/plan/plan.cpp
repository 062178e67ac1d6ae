// SPDX-License-Identifier: Apache-2.0
#include "engine/plan/plan.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate {
namespace {

// A brick's 512 voxels: density 4 bytes, sample (gradient and density) 16 bytes.
constexpr std::uint64_t kDensityBytes = 512 * 4;
constexpr std::uint64_t kSampleBytes = 512 * 16;

PlanLine uploadLine(const PlanFacts& facts) {
  return {true, fmt::format("{} of {} bricks of density", facts.stored_bricks, facts.bricks),
          "a brick that holds one value has a page and no storage",
          (facts.bricks - facts.stored_bricks) * kDensityBytes};
}

PlanLine gradientLine(const Plan& plan, const PlanFacts& facts) {
  PlanLine line{true, fmt::format("gradient of {} of {} bricks", facts.gradient_bricks, facts.bricks), "", 0};
  if (plan.gradient_all) {
    line.why = "every brick: --gradient all, or an algorithm that feels away from the isosurface";
  } else {
    line.why = "those that the isosurface crosses, and their halo";
    line.saved_bytes = (facts.bricks - facts.gradient_bricks) * kSampleBytes;
  }
  return line;
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
    case Pass::kBrickBounds:
      return "brick bounds";
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

Plan makePlan(const Scene& scene, bool needs_mesh) {
  Plan plan;
  plan.gradient_all = scene.gradient_all;
  plan.draws = scene.picture;
  plan.meshes = needs_mesh;
  plan.objects = scene.objects.size();
  plan.passes = {Pass::kUpload};
  // Bounds choose the bricks with gradients and let the renderer skip; without either nobody reads them.
  if (!plan.gradient_all || plan.draws) plan.passes.push_back(Pass::kBrickBounds);
  plan.passes.insert(plan.passes.end(), {Pass::kGradient, Pass::kWindow});
  if (plan.draws) plan.passes.push_back(Pass::kIsosurface);
  return plan;
}

std::vector<PlanLine> planLines(const Plan& plan, const PlanFacts& facts) {
  std::vector<PlanLine> lines = {uploadLine(facts), gradientLine(plan, facts)};
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
  lines.push_back({false, "filters", "the scene names none", 0});
  lines.push_back({false, "friction, texture, recovery", "the scene names none", 0});
  return lines;
}

}  // namespace palpate
