// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_geometry.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/field/raw_values.hpp"

namespace palpate {
namespace {

constexpr double kGapTolerance = 0.02;      // of the gap between slices [-]
constexpr double kLateralTolerance = 0.05;  // of the pixel spacing, from slice to slice [-]

// The slices' first axis, second axis and this are right-handed.
Vec3 normalOf(const DicomSeries& series) {
  return series[0].axes[0].cross(series[0].axes[1]).normalized();
}

void sortAlongNormal(DicomSeries& series) {
  const Vec3 normal = normalOf(series);
  for (DicomSlice& slice : series) slice.along_mm = slice.position_mm.dot(normal);
  std::sort(series.begin(), series.end(),
            [](const DicomSlice& a, const DicomSlice& b) { return a.along_mm < b.along_mm; });
}

void checkAlike(const DicomSeries& series, const std::string& source) {
  const ItkHeader& first = series[0].file.header;
  for (const DicomSlice& slice : series) {
    const ItkHeader& header = slice.file.header;
    const bool same_size = header.dimensions[0] == first.dimensions[0] && header.dimensions[1] == first.dimensions[1];
    const auto differ = [&](std::size_t n) {
      return std::abs(slice.spacing_mm[n] - series[0].spacing_mm[n]) > 1e-4 * series[0].spacing_mm[n];
    };
    const bool same_spacing = !differ(0) && !differ(1);
    const bool same_axes =
        (slice.axes[0] - series[0].axes[0]).norm() < 1e-3 && (slice.axes[1] - series[0].axes[1]).norm() < 1e-3;
    if (same_size && same_spacing && same_axes) continue;
    refuse(source,
           fmt::format("slices {} and {} differ in size, spacing or orientation", series[0].name(), slice.name()),
           "keep one scan in a folder");
  }
}

// The median; of two values in the middle, the upper one. For of two gaps one may be 0, and two slices at the same
// place have a message of their own.
double medianGap_mm(const DicomSeries& series) {
  std::vector<double> gaps;
  for (std::size_t n = 1; n < series.size(); ++n) gaps.push_back(series[n].along_mm - series[n - 1].along_mm);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

// The distance between slices [mm]; refuses gaps that differ, and slices that drift sideways as under a tilted gantry.
double checkGaps(const DicomSeries& series, const std::string& source) {
  if (series.size() < 2) refuse(source, "the series has one slice", "give the whole series");
  const double usual = medianGap_mm(series);
  const Vec3 normal = normalOf(series);
  for (std::size_t n = 1; n < series.size(); ++n) {
    const double gap = series[n].along_mm - series[n - 1].along_mm;
    const std::string pair = series[n - 1].name() + " and " + series[n].name();
    if (gap < 1e-3) refuse(source, "slices " + pair + " lie at one place", "keep one time point or echo in a folder");
    if (gap > 1.5 * usual) {
      const double missing = std::round(gap / usual) - 1;
      refuse(source,
             fmt::format("{:.0f} {} missing between {}", missing, missing == 1 ? "slice is" : "slices are", pair),
             "add what is missing");
    }
    if (std::abs(gap - usual) > kGapTolerance * usual) {
      refuse(source, fmt::format("slices {} are {:g} mm apart, others {:g} mm", pair, gap, usual),
             "resample the series evenly");
    }
    const Vec3 step = series[n].position_mm - series[n - 1].position_mm;
    if ((step - gap * normal).norm() > kLateralTolerance * series[0].spacing_mm[0]) {
      refuse(source, fmt::format("slices {} are shifted sideways, as under a tilted gantry", pair),
             "resample the series upright");
    }
  }
  return (series.back().along_mm - series.front().along_mm) / static_cast<double>(series.size() - 1);
}

Lattice latticeOf(const DicomSlice& first, double gap_mm, const std::string& source) {
  Lattice lattice;
  lattice.origin_W = first.position_mm * kMetresPerMillimetre;
  lattice.spacing_m = Vec3(first.spacing_mm[0], first.spacing_mm[1], gap_mm) * kMetresPerMillimetre;
  lattice.R_WL << first.axes[0], first.axes[1], first.axes[0].cross(first.axes[1]);
  return orthonormalised(lattice, source);
}

}  // namespace

Lattice placeSlices(DicomSeries& series, const std::string& source) {
  for (DicomSlice& slice : series) checkDicomSlice(slice, source);
  sortAlongNormal(series);
  checkAlike(series, source);
  const double gap_mm = checkGaps(series, source);
  return latticeOf(series[0], gap_mm, source);
}

}  // namespace palpate
