// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/truth.hpp"

#include <algorithm>
#include <cmath>

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
      if (!std::isnan(record.depth_m))  // without contact the depth is 0
        point = TruePoint{surfacePointOf(record), asVec3(record.normal_W), record.in_contact ? record.depth_m : 0};
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
  ForceErrors known = forceErrors(stiffness_N_per_m, records, phases, [&](const TickRecord& record) {
    return points[static_cast<std::size_t>(&record - records.data())];
  });
  if (known.errors_N.empty()) return {};
  const double share = static_cast<double>(known.felt_ticks) / static_cast<double>(known.possible_ticks);
  return {percentiles(std::move(known.errors_N)).p99, share};
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
