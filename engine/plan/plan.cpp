// SPDX-License-Identifier: Apache-2.0
#include "engine/plan/plan.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

// A brick's 512 voxels: density 4 bytes, sample (gradient and density) 16 bytes, or 8 as halves.
constexpr std::uint64_t kDensityBytes = std::uint64_t{512} * 4;
constexpr std::uint64_t kSampleBytes = std::uint64_t{512} * 16;
constexpr std::uint64_t kHalfSampleBytes = std::uint64_t{512} * 8;

std::uint64_t sampleBytes(const Plan& plan) {
  return plan.request.half_samples ? kHalfSampleBytes : kSampleBytes;
}

PlanLine uploadLine(const PlanFacts& facts) {
  return {true, fmt::format("{} of {} bricks of density", facts.stored_bricks, facts.bricks),
          "a brick that holds one value has a page and no storage",
          (facts.bricks - facts.stored_bricks) * kDensityBytes};
}

PlanLine gradientLine(const Plan& plan, const PlanFacts& facts) {
  const bool as_needed = plan.gradientsAsNeeded();
  PlanLine line{true,
                fmt::format("gradient of {}{} of {} bricks: {}", as_needed ? "up to " : "", facts.gradient_bricks,
                            facts.bricks, plan.gradient.kind.name),
                "", 0};
  if (plan.request.gradient_all) {
    line.why = "every brick: --gradient all, or an algorithm that feels away from the isosurface";
  } else {
    line.why = "those that the isosurface crosses, and their halo";
    if (as_needed) line.why += ", each when the tool first comes near";
    line.saved_bytes = (facts.bricks - facts.gradient_bricks) * sampleBytes(plan);
  }
  return line;
}

PlanLine samplesLine(const Plan& plan, const PlanFacts& facts) {
  if (!plan.request.half_samples)
    return {true, "samples as floats, 16 bytes a voxel", "halves save half: --samples half", 0};
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
  }
  return "?";
}

bool Plan::has(Pass pass) const noexcept {
  return std::find(passes.begin(), passes.end(), pass) != passes.end();
}

bool Plan::gradientsAsNeeded() const noexcept {
  return request.gradients_as_needed && !request.edits && !request.other_isovalues && !request.gradient_all &&
         !gradient.smooths();
}

Plan makePlan(const EngineRequest& request) {
  if (request.window_edge < kLeastWindowEdge || request.window_edge > kMostWindowEdge) {
    throw Error(Error::Code::kBadInput, fmt::format("a window of {} voxels", request.window_edge),
                "the tool would leave it, or it has no room",
                fmt::format("give {} to {}", kLeastWindowEdge, kMostWindowEdge));
  }
  Plan plan;
  plan.request = request;
  plan.gradient = gradientOperator(request.gradient_operator);
  plan.passes = {Pass::kUpload};
  const std::string distance = request.distance ? "distance:4" : "";
  if (!request.filter.empty() || !distance.empty()) {
    plan.filter_words = request.filter + (request.filter.empty() || distance.empty() ? "" : " ") + distance;
    plan.filters = filterChain(plan.filter_words);
    plan.passes.push_back(Pass::kFilter);
  }
  // Bounds choose the bricks with gradients, and the renderer skips bricks by them. Nothing else reads them.
  if (!request.gradient_all || request.draws) plan.passes.push_back(Pass::kBrickBounds);
  if (plan.gradient.smooths()) plan.passes.push_back(Pass::kSmoothing);
  plan.passes.insert(plan.passes.end(), {Pass::kGradient, Pass::kWindow});
  return plan;
}

std::vector<PlanLine> planLines(const Plan& plan, const PlanFacts& facts) {
  std::vector<PlanLine> lines = {uploadLine(facts), filterLine(plan, facts), gradientLine(plan, facts),
                                 samplesLine(plan, facts)};
  if (plan.has(Pass::kSmoothing)) {
    const char* why = "the operator takes its gradient; freed then, since nothing is edited";
    if (plan.request.other_isovalues) why = "the operator takes its gradient; kept, since the isovalue may change";
    if (plan.request.edits) why = "the operator takes its gradient; kept, since edits change it";
    lines.insert(lines.begin() + 2, {true, "smoothing of the whole field", why, 0});
  }
  lines.push_back(
      {true, fmt::format("window of up to {0}x{0}x{0} samples around the tool, three slots", plan.request.window_edge),
       "what the servo reads", 0});
  if (plan.request.draws) {
    lines.push_back({true, "isosurface picture", "view.png and report.html show it", 0});
  } else {
    lines.push_back({false, "isosurface picture", "not asked for (--picture off)", 0});
  }
  if (!plan.has(Pass::kBrickBounds))
    lines.push_back({false, "brick bounds", "every brick has gradients and nothing is drawn", 0});
  return lines;
}

}  // namespace palpate
