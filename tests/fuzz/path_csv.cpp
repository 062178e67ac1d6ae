// SPDX-License-Identifier: Apache-2.0
// Recorded paths. An accepted path has rising times and is finite, and so is its duration. Written with all digits and
// read again, it is the same, bit for bit.
#include "apps/path/path_csv.hpp"

#include <cmath>

#include <fmt/format.h>

#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

std::string textOf(const std::vector<TimedPoint>& points) {
  std::string text = "time_s,x_m,y_m,z_m\n";
  for (const auto& [time_s, p_W] : points)
    text += fmt::format("{:.17g},{:.17g},{:.17g},{:.17g}\n", time_s, p_W.x(), p_W.y(), p_W.z());
  return text;
}

void check(const std::string& bytes) {
  static const fuzz::ScratchFile file("path.csv");
  file.write(bytes);
  PathFile path;
  if (!fuzz::accepts(file.path(), [&] { path = readPathFile(file.path()); })) return;
  const std::vector<TimedPoint>& points = path.points;
  fuzz::require(points.size() >= 2, "a path of fewer than two points");
  for (std::size_t n = 0; n < points.size(); ++n) {
    fuzz::require(std::isfinite(points[n].time_s) && points[n].p_W.allFinite(), "a point is not finite");
    fuzz::require(n == 0 || points[n - 1].time_s < points[n].time_s, "time does not rise");
  }
  for (std::size_t n = 0; n < path.brushes.size(); ++n) {
    fuzz::require(path.brushes[n].text != (n == 0 ? "" : path.brushes[n - 1].text), "a brush does not change");
    fuzz::require(n == 0 || path.brushes[n - 1].begin_s < path.brushes[n].begin_s, "time of brushes does not rise");
  }
  fuzz::require(std::isfinite(points.back().time_s - points.front().time_s), "it lasts for ever");
  file.write(textOf(points));
  fuzz::mustAccept("its own words are refused", [&] {
    const std::vector<TimedPoint> again = readPathCsv(file.path());
    bool same = again.size() == points.size();
    for (std::size_t n = 0; same && n < points.size(); ++n)
      same = again[n].time_s == points[n].time_s && again[n].p_W == points[n].p_W;
    fuzz::require(same, "it reads otherwise from its own words");
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(fuzz::textOf(data, size));
  return 0;
}
