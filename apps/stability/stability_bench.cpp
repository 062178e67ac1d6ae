// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/stability_bench.hpp"

#include <fmt/format.h>

#include "apps/bench/log_chart.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/stability/extreme_rows.hpp"
#include "apps/stability/limit_rows.hpp"
#include "apps/stability/stiff_rows.hpp"
#include "apps/stability/study_device.hpp"
#include "apps/stability/width_rows.hpp"

namespace palpate {
namespace {

constexpr const char* kIntroduction =
    R"(What a contact can bear until it shakes, by the real servo loop with simulated devices and hands, in simulated time: the figures
are the same on every machine. K: stiffness of the surface, B: its damping, T: a tick, here 1 ms.

- *limit*: hri on a plane, the tool in contact all the time, no encoders, no limit of the force. *Exact*: from the eigenvalues of
  the sampled loop (`servo/stability/sampled_loop.hpp`). *Servo's*: found by runs that settle or do not, without the exact one.
  *2b/T*: the stiffness up to which sampling leaves the device passive, 2 (b - B) / T (Colgate and Schenkel 1997); *2f/D*: up to
  which its Coulomb friction f covers encoder steps D (Abbott and Okamura 2005). The simulated devices have no Coulomb friction;
  f is that of the kind of device.
- *width*: a surface is quiet if a tool that was pressed onto a ball and slid along it comes to rest. With encoders, delays, force
  and slew limits, and a tool that may leave the surface. *usual*: hri with the program's defaults. Each other variant differs
  in one thing. *controller*: `--passivity control`.
- *stiff*: walls of up to 1e6 N/m, devices of 10 g to 10 kg, ticks of 50 us to 10 ms, drawn by chance. The servo watches its own contact
  (`servo/loop/instability_guard.hpp`). What grows must be noticed and end without a force; what settles must be left alone.
- *extreme*: named cases at the edge of what a user may set or meet (`apps/extreme`), each with what is expected. In every one of
  them every force that the device takes is finite, within the force limit and within the slew limit.

The devices are of kinds that laboratories have (`apps/stability/study_device.hpp`); their masses and frictions are assumed. The
hands are three of the size that was measured (`servo/devices/typical_hands.hpp`).)";

void addPoints(std::vector<ChartPanel>& panels, const BenchRow& row, const char* series, const char* key) {
  const ChartPanel panel{.title = textOf(row, "device") + ", " + textOf(row, "hand") + " hand",
                         .x_label = "damping B [N s/m]",
                         .y_label = "stiffness K [N/m]",
                         .series = {}};
  addPoint(panels, panel, series, {figureOf(row, "damping_Ns_per_m"), figureOf(row, key)});
}

}  // namespace

BenchResult runStabilityBench(const StabilityRequest& request, Progress& progress) {
  BenchResult result = beginBench("stability");
  const auto tell = [&](double done) {
    throwIfInterrupted("palpate stability");
    progress.fraction(done);
  };
  progress.stage("limits of the linear loop");
  addLimitRows(result, request, tell);
  progress.stage("how stiff a surface may be");
  addWidthRows(result, request, tell);
  progress.stage("stiff walls");
  addStiffRows(result, request, tell);
  progress.stage("extreme cases");
  addExtremeRows(result, tell);
  addLimitTargets(result);
  addWidthTargets(result);
  addStiffTargets(result);
  addExtremeTarget(result);
  return result;
}

std::string stabilityTable(const BenchResult& result) {
  return "Limits of the linear loop\n" + tableText(result, limitTable()) + "\nHow stiff a surface may be\n" +
         tableText(result, widthTable()) + "\nStiff walls\n" + stiffTable(result) + tableText(result, extremeTable());
}

LogCharts stabilityCharts(const BenchResult& result) {
  std::vector<ChartPanel> panels;
  for (const StudyDevice& device : studyDevices()) {
    const BenchRow like = {{"device", device.name}, {"hand", "normal"}};
    BenchRow own_delay = like;
    own_delay.emplace_back("delay_ticks", std::int64_t{device.delay_ticks});
    for (const BenchRow* row : rowsOf(result, "limit", own_delay)) {
      addPoints(panels, *row, "exact limit", "exact_stiffness_N_per_m");
      addPoints(panels, *row, "the servo's", "servo_stiffness_N_per_m");
      addPoints(panels, *row, "passive: 2 (b - B) / T", "passive_sampling_N_per_m");
    }
    for (const char* variant : {"usual", "controller"}) {
      BenchRow one = like;
      one.emplace_back("variant", variant);
      for (const BenchRow* row : rowsOf(result, "width", one))
        addPoints(panels, *row, fmt::format("quiet, {}", variant).c_str(), "stiffness_N_per_m");
    }
  }
  return {{"How stiff a contact may be", panels, ChartMarks::kLine}};
}

const Bench& stabilityBench() {
  static const Bench kBench = {
      .name = "stability",
      .help = "what a contact can bear until it shakes (some four minutes; --quick: half a one)",
      .title = "What a contact can bear",
      .introduction = kIntroduction,
      .run =
          [](const Bench&, const BenchArguments& arguments, Progress& progress) {
            StabilityRequest request = arguments.quick ? StabilityRequest::quick() : StabilityRequest{};
            request.seed = arguments.seed;
            return runStabilityBench(request, progress);
          },
      .table = stabilityTable,
      .charts = stabilityCharts};
  return kBench;
}

}  // namespace palpate
