// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/width_rows.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/stability/limit_rows.hpp"
#include "apps/stability/study_device.hpp"
#include "apps/stability/z_width.hpp"
#include "servo/devices/typical_hands.hpp"

namespace palpate {
namespace {

constexpr const char* kUsual = "usual";  // nothing varied: hri at its defaults
constexpr const char* kControl = "controller";

// One thing that differs from the program's defaults.
struct Variant {
  std::string name;
  WallContact contact = {};
  std::string velocity = VelocityParameters{}.name;
  bool control = false;
};

EffectParameters effectNamed(const std::string& name) {
  EffectParameters effects;
  if (name == "force shading") effects.force_shading = true;
  if (name == "recovery") effects.recovery_s = 20e-3;
  if (name == "texture") effects.texture = TextureKind::kProcedural;
  if (name == "density texture") effects.texture = TextureKind::kDensity;
  if (name == "friction") effects.friction = {.static_ratio = 0.6, .dynamic_ratio = 0.4, .viscous_Ns_per_m = 1};
  if (name == "stiffness by density") effects.stiffness_by_density = {{0, 1}, {2, 2}};
  return effects;
}

std::vector<Variant> variants() {
  std::vector<Variant> all = {{kUsual}, {.name = kControl, .control = true}};
  for (const AlgorithmEntry& entry : algorithms()) {
    if (!entry.traits.shows_surface) continue;  // it has no stiffness
    for (const int n : {1, 5, 20, 100}) {
      if (n != 5 && !entry.traits.renews_planes) continue;
      if (entry.name == algorithms().front().name && n == 5) continue;  // that is the usual one
      all.push_back(
          {.name = entry.traits.renews_planes ? fmt::format("{}, n {}", entry.name, n) : std::string(entry.name),
           .contact = {.algorithm = std::string(entry.name), .n = n}});
    }
  }
  for (const VelocityEntry& entry : velocityEstimates().subspan(1))
    all.push_back({.name = fmt::format("velocity {}", entry.name), .velocity = std::string(entry.name)});
  for (const char* effect :
       {"force shading", "recovery", "texture", "density texture", "friction", "stiffness by density"})
    all.push_back({.name = effect, .contact = {.effects = effectNamed(effect)}});
  return all;
}

struct WidthRow {
  std::string device, hand, variant;
  double damping_Ns_per_m = 0;
  Width width;
  double force_limit_N = 0;
  double usual_N_per_m = 0;  // the width of the usual variant
};

const Columns<WidthRow>& widthColumns() {
  using R = WidthRow;
  static const Columns<R> kColumns = {
      {"device", &R::device, {"device", ""}},
      {"hand", &R::hand, {"hand", ""}},
      {"variant", &R::variant, {"variant", ""}},
      {"damping_Ns_per_m", &R::damping_Ns_per_m, {"B", "N s/m", 1}},
      {"stiffness_N_per_m", [](const R& r) { return r.width.stiffness_N_per_m; }, {"quiet up to", "N/m", 0}},
      {"over_usual", [](const R& r) { return r.width.stiffness_N_per_m / r.usual_N_per_m; }, {"over usual", "-", 2}},
      {"usual_over_this", [](const R& r) { return r.usual_N_per_m / r.width.stiffness_N_per_m; }},
      {"force_max_N", [](const R& r) { return r.width.force_max_N; }, {"force", "N", 2}},
      {"force_over_limit", [](const R& r) { return r.width.force_max_N / r.force_limit_N; }}};
  return kColumns;
}

struct Case {
  const StudyDevice* device;
  const TypicalHand* hand;
  bool all_variants;
};

std::vector<Case> cases(const StabilityRequest& request) {
  std::vector<Case> all;
  for (const StudyDevice& device : studyDevices()) {
    for (const TypicalHand& hand : kTypicalHands) {
      const bool is_default = &device == &studyDevices().front() && std::string(hand.name) == "normal";
      all.push_back({&device, &hand, request.every_variant || is_default});
    }
  }
  return all;
}

}  // namespace

void addWidthRows(BenchResult& result, const StabilityRequest& request, const StudyProgress& progress) {
  const WallVolume ball(WallVolume::Shape::kBall);
  const std::vector<Variant> all = variants();
  const std::vector<Case> todo = cases(request);
  for (std::size_t i = 0; i < todo.size(); ++i) {
    const Case& one = todo[i];
    for (const double damping : request.width_damping) {
      progress(static_cast<double>(i) / static_cast<double>(todo.size()));
      double usual_N_per_m = 0;
      for (const Variant& variant : all) {
        if (!one.all_variants && variant.name != kUsual && variant.name != kControl) continue;
        WidthQuestion asked{.contact = variant.contact,
                            .device = held(*one.device, one.hand->holding(bare(*one.device))),
                            .rate_hz = kStudyRate_hz,
                            .velocity = variant.velocity};
        asked.contact.wall.damping_Ns_per_m = damping;
        asked.passivity.control = variant.control;
        const Width found = width(asked, ball);
        if (variant.name == kUsual) usual_N_per_m = found.stiffness_N_per_m;
        addFigures(
            result.rows.emplace_back(BenchRow{{"part", "width"}}), widthColumns(),
            {one.device->name, one.hand->name, variant.name, damping, found, one.device->force_limit_N, usual_N_per_m});
      }
    }
  }
}

void addWidthTargets(BenchResult& result) {
  promise(result, {.name = "stiffness without the controller over that with it, default device, hand and damping [-]",
                   .bound = 1.0 / 3,
                   .part = "width",
                   .like = {{"device", studyDevices().front().name},
                            {"hand", "normal"},
                            {"variant", kControl},
                            {"damping_Ns_per_m", AlgorithmParameters{}.damping_Ns_per_m}},
                   .keys = {"usual_over_this"},
                   .of = firstOf});
  promise(result, {.name = "the same, median over devices, hands and dampings [-]",
                   .bound = 1.0 / 3,
                   .part = "width",
                   .like = {{"variant", kControl}},
                   .keys = {"usual_over_this"},
                   .of = medianOf});
  promise(result, {.name = "largest force of all quiet runs over the device's limit [-]",
                   .bound = 1 + 1e-9,
                   .part = "width",
                   .keys = {"force_over_limit"},
                   .of = largestOf});
}

const Table& widthTable() {
  static const Table kTable = {.parts = {"width"}, .columns = shown(widthColumns())};
  return kTable;
}

}  // namespace palpate
