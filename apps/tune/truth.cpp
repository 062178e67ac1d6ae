// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/truth.hpp"

#include <algorithm>
#include <limits>

#include "base/quantile.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

class ExactTruth final : public Truth {
 public:
  explicit ExactTruth(const std::string& phantom) : phantom_(makePhantom(phantom)) {}

 private:
  std::vector<std::optional<TruePoint>> find(const std::vector<TickRecord>& records) override {
    std::vector<std::optional<TruePoint>> points;
    for (const TickRecord& record : records) points.push_back(exactSurfacePoint(*phantom_, asVec3(record.hip_W)));
    return points;
  }
  std::unique_ptr<Phantom> phantom_;
};

class FeltTruth final : public Truth {
 public:
  explicit FeltTruth(FeelAlong felt) : felt_(std::move(felt)) {}

 private:
  std::vector<std::optional<TruePoint>> find(const std::vector<TickRecord>& records) override {
    std::vector<std::optional<TruePoint>> points;
    for (const TickRecord& record : felt_(records)) {
      std::optional<TruePoint>& point = points.emplace_back();
      if (record.in_contact) point = TruePoint{surfacePointOf(record), asVec3(record.normal_W)};
    }
    points.resize(records.size());
    return points;
  }
  FeelAlong felt_;
};

}  // namespace

const std::vector<std::optional<TruePoint>>& Truth::pointsOf(const std::vector<TickRecord>& records) {
  const auto same = [](const Vec3& place_W, const TickRecord& record) { return place_W == asVec3(record.hip_W); };
  if (!std::ranges::equal(places_W_, records, same)) {
    points_ = find(records);
    places_W_.clear();
    for (const TickRecord& record : records) places_W_.push_back(asVec3(record.hip_W));
  }
  return points_;
}

std::unique_ptr<Truth> exactTruth(const std::string& phantom) {
  return std::make_unique<ExactTruth>(phantom);
}

std::unique_ptr<Truth> feltTruth(FeelAlong felt) {
  return std::make_unique<FeltTruth>(std::move(felt));
}

RunErrors runErrors(Truth& truth, const std::vector<TickRecord>& records, const std::vector<PathPhase>& phases,
                    double stiffness_N_per_m) {
  const auto& points = truth.pointsOf(records);
  const CountedTicks counted = countedTicks(records, phases);
  std::vector<double> errors_N;
  for (const TickRecord* record : counted.ticks) {
    const auto& point = points[static_cast<std::size_t>(record - records.data())];
    const auto error_N = point ? forceError_N(stiffness_N_per_m, *record, *point) : std::nullopt;
    if (error_N) errors_N.push_back(*error_N);
  }
  if (errors_N.empty()) return {std::numeric_limits<double>::quiet_NaN(), 0};
  const auto sliding = std::ranges::count_if(records, [&](const TickRecord& r) { return inSlide(r.time_s, phases); });
  const auto all = counted.slide_only ? static_cast<double>(sliding) : static_cast<double>(records.size());
  const auto known = static_cast<double>(errors_N.size());
  return {percentiles(std::move(errors_N)).p99, known / all};
}

std::string whyNotExact(const Scene& scene, double isovalue) {
  if (!scene.volume.starts_with("phantom:")) return "the volume is no phantom";
  if (!scene.objects.empty()) return "the scene has objects";
  if (!scene.edit.empty()) return "the tool edits";
  const std::unique_ptr<Phantom> phantom = makePhantom(scene.volume);
  if (!phantom->hasSurface()) return "this phantom has no surface of its own";
  if (phantom->isovalue() != isovalue) return "the isovalue is not that of the phantom's surface";
  return "";
}

}  // namespace palpate
