// SPDX-License-Identifier: Apache-2.0
#include "apps/view/force_arrows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

double wayInContact(const std::vector<TickRecord>& records) {
  double way_m = 0;
  for (std::size_t i = 1; i < records.size(); ++i) {
    if (records[i].in_contact && records[i - 1].in_contact)
      way_m += (asVec3(records[i].vhip_W) - asVec3(records[i - 1].vhip_W)).norm();
  }
  return way_m;
}

constexpr double kLeastWay_m = 1e-12;  // makes a tap have one arrow
constexpr double kPeak = 1.05;         // above this many times the middle's force the largest is shown

// Finds, in a stretch of the path, the tick nearest to its middle and the tick with the largest force.
struct Stretch {
  std::int64_t number = -1;
  const TickRecord* middle = nullptr;
  const TickRecord* largest = nullptr;
  double off_middle = 1;

  void consider(const TickRecord& now, double place) {
    const double off = std::abs(place - static_cast<double>(number) - 0.5);
    if (!middle || off < off_middle) {
      middle = &now;
      off_middle = off;
    }
    if (!largest || forceOf(now) > forceOf(*largest)) largest = &now;
  }

  void moveOn(std::int64_t next, std::vector<ForceArrow>& arrows) {
    if (middle) {
      const TickRecord& r = forceOf(*largest) > kPeak * forceOf(*middle) ? *largest : *middle;
      arrows.push_back({asVec3(r.hip_W), asVec3(r.vhip_W), asVec3(r.force_W)});
    }
    *this = {};
    number = next;
  }
};

}  // namespace

double roundDown(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  const double digit = value / decade;
  return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * decade;
}

ForceArrows chooseForceArrows(const std::vector<TickRecord>& records, int wanted) {
  ForceArrows out;
  out.every_m = roundDown(std::max(wayInContact(records) / wanted * 1.5, kLeastWay_m));
  double way_m = 0;
  Stretch stretch;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TickRecord& now = records[i];
    if (!now.in_contact) continue;
    if (i > 0 && records[i - 1].in_contact) way_m += (asVec3(now.vhip_W) - asVec3(records[i - 1].vhip_W)).norm();
    const auto number = static_cast<std::int64_t>(way_m / out.every_m);
    if (number != stretch.number) stretch.moveOn(number, out.arrows);
    stretch.consider(now, way_m / out.every_m);
    out.most_N = std::max(out.most_N, forceOf(now));
  }
  stretch.moveOn(-1, out.arrows);
  return out;
}

std::string arrowWords(const ForceArrows& forces) {
  const std::size_t count = forces.arrows.size();
  if (count < 2) return "the arrow";
  std::vector<double> apart_m;
  for (std::size_t i = 1; i < count; ++i)
    apart_m.push_back((forces.arrows[i].vhip_W - forces.arrows[i - 1].vhip_W).norm());
  // An arrow may stand at a peak, up to half a stretch off its middle, and the way bends: nearly all must be near.
  const auto near = std::count_if(apart_m.begin(), apart_m.end(),
                                  [&](double m) { return m >= 0.5 * forces.every_m && m <= 1.5 * forces.every_m; });
  if (static_cast<double>(near) < 0.75 * static_cast<double>(apart_m.size()))
    return fmt::format("{} arrows along the way", count);
  return fmt::format("an arrow every {:g} mm", forces.every_m * kMillimetresPerMetre);
}

Color forceColor(double share) {
  constexpr std::array<Color, 4> kStops = {
      {{0.98, 0.75, 0.18}, {0.94, 0.42, 0.10}, {0.80, 0.11, 0.22}, {0.42, 0.05, 0.45}}};
  const double place = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double t = place - static_cast<double>(i);
  const auto mix = [t](double a, double b) { return a + t * (b - a); };
  return {mix(kStops[i].red, kStops[i + 1].red), mix(kStops[i].green, kStops[i + 1].green),
          mix(kStops[i].blue, kStops[i + 1].blue)};
}

}  // namespace palpate
