// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/limit_rows.hpp"

#include <cmath>

#include "apps/stability/linear_limit.hpp"
#include "apps/stability/study_device.hpp"
#include "servo/devices/typical_hands.hpp"

namespace palpate {
namespace {

struct LimitRow {
  std::string device, hand;
  std::int64_t delay_ticks = 0;
  double damping_Ns_per_m = 0;
  double exact_N_per_m = 0, servo_N_per_m = 0;
  double sampling_N_per_m = 0, quantisation_N_per_m = 0;  // passivity bounds
};

const Columns<LimitRow>& limitColumns() {
  using R = LimitRow;
  static const Columns<R> kColumns = {{"device", &R::device, {"device", ""}},
                                      {"hand", &R::hand, {"hand", ""}},
                                      {"delay_ticks", &R::delay_ticks, {"delay", "ticks"}},
                                      {"damping_Ns_per_m", &R::damping_Ns_per_m, {"B", "N s/m", 2}},
                                      {"exact_stiffness_N_per_m", &R::exact_N_per_m, {"exact K", "N/m", 0}},
                                      {"servo_stiffness_N_per_m", &R::servo_N_per_m, {"servo's K", "N/m", 0}},
                                      {"off_percent",
                                       [](const R& r) { return 100 * std::abs(r.servo_N_per_m / r.exact_N_per_m - 1); },
                                       {"off", "%", 2}},
                                      {"passive_sampling_N_per_m", &R::sampling_N_per_m, {"2b/T", "N/m", 0}},
                                      {"passive_quantisation_N_per_m", &R::quantisation_N_per_m, {"2f/D", "N/m", 0}}};
  return kColumns;
}

std::vector<SimulatedLimit> questions(const StudyDevice& device, const StabilityRequest& request,
                                      std::vector<LimitRow>& rows) {
  std::vector<SimulatedLimit> all;
  for (const TypicalHand& hand : kTypicalHands) {
    if (!request.every_hand && std::string(hand.name) != "normal") continue;
    for (const int delay : request.every_delay ? std::vector<int>{0, 1, 3} : std::vector<int>{device.delay_ticks}) {
      SimulatedLimit what;
      what.loop.hand = hand.holding(bare(device));
      what.loop.rate_hz = kStudyRate_hz;
      what.loop.delay_ticks = delay;
      const double most = dampingBound(what.loop, kSoftest_N_per_m);
      for (const double share : request.limit_damping) {
        what.damping_Ns_per_m = share * most;
        all.push_back(what);
        rows.push_back({device.name, hand.name, delay, what.damping_Ns_per_m});
      }
    }
  }
  return all;
}

}  // namespace

void addLimitRows(BenchResult& result, const StabilityRequest& request, const StudyProgress& progress) {
  const WallVolume plane(WallVolume::Shape::kPlane);
  const std::vector<StudyDevice>& devices = studyDevices();
  for (std::size_t d = 0; d < devices.size(); ++d) {
    std::vector<LimitRow> rows;
    const std::vector<SimulatedLimit> asked = questions(devices[d], request, rows);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      progress((static_cast<double>(d) + static_cast<double>(i) / static_cast<double>(asked.size())) /
               static_cast<double>(devices.size()));
      const PassiveDevice passive = passiveDevice(devices[d], kStudyRate_hz);
      rows[i].exact_N_per_m = stiffnessBound(asked[i].loop, rows[i].damping_Ns_per_m);
      rows[i].servo_N_per_m = simulatedLimit(asked[i], plane);
      rows[i].sampling_N_per_m = samplingBound(passive, rows[i].damping_Ns_per_m);
      rows[i].quantisation_N_per_m = quantisationBound(passive);
      addFigures(result.rows.emplace_back(BenchRow{{"part", "limit"}}), limitColumns(), rows[i]);
    }
  }
}

void addLimitTargets(BenchResult& result) {
  promise(result, {.name = "limit of K of the real servo against the exact one, largest difference [%]",
                   .bound = 1,
                   .part = "limit",
                   .keys = {"off_percent"},
                   .of = largestOf});
}

const Table& limitTable() {
  static const Table kTable = {.parts = {"limit"}, .columns = shown(limitColumns())};
  return kTable;
}

}  // namespace palpate
