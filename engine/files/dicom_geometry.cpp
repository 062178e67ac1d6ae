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
constexpr double kDrift = 0.5;              // of the gap, from where evenly spaced slices lie [-]
constexpr double kLateralTolerance = 0.05;  // of the pixel spacing, from slice to slice [-]
constexpr double kLateralDrift = 0.5;       // of the pixel spacing, from the first slice [-]

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
  for (const DicomSlice& slice : series) {
    const bool same_size = slice.columns() == series[0].columns() && slice.rows() == series[0].rows();
    const auto differ = [&](std::size_t n) {
      return std::abs(slice.spacing_mm[n] - series[0].spacing_mm[n]) > 1e-4 * series[0].spacing_mm[n];
    };
    const bool same_spacing = !differ(0) && !differ(1);
    const bool same_axes =
        (slice.axes[0] - series[0].axes[0]).norm() < 1e-3 && (slice.axes[1] - series[0].axes[1]).norm() < 1e-3;
    if (same_size && same_spacing && same_axes) continue;
    refuse(source,
           fmt::format("slices {} and {} differ in size, spacing or orientation", series[0].shortName(),
                       slice.shortName()),
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

std::string pairOf(const DicomSeries& series, std::size_t second) {
  return fmt::format("slices {} and {}", series[second - 1].shortName(), series[second].shortName());
}

// The distance between slices [mm]; refuses gaps that differ.
double checkGaps(const DicomSeries& series, const std::string& source) {
  if (series.size() < 2) refuse(source, "the series has one slice", "give the whole series");
  const double usual = medianGap_mm(series);
  for (std::size_t n = 1; n < series.size(); ++n) {
    const double gap = series[n].along_mm - series[n - 1].along_mm;
    const std::string pair = pairOf(series, n);
    if (gap < 1e-3) {
      refuse(source, pair + " lie at one place",
             series[n].path == series[n - 1].path
                 ? "write each time point or echo into files of its own, in another program"
                 : "keep one time point or echo in a folder");
    }
    if (gap > 1.5 * usual) {
      const double missing = std::round(gap / usual) - 1;
      refuse(source,
             fmt::format("{:.0f} {} missing between {} and {}", missing, missing == 1 ? "slice is" : "slices are",
                         series[n - 1].shortName(), series[n].shortName()),
             "add what is missing");
    }
    if (std::abs(gap - usual) > kGapTolerance * usual) {
      refuse(source, fmt::format("{} are {:g} mm apart, others {:g} mm", pair, gap, usual),
             "resample the series evenly");
    }
  }
  const double gap = (series.back().along_mm - series.front().along_mm) / static_cast<double>(series.size() - 1);
  for (std::size_t n = 1; n < series.size(); ++n) {  // gaps that differ by less than one sees add up
    const double off = series[n].along_mm - series[0].along_mm - static_cast<double>(n) * gap;
    if (std::abs(off) <= kDrift * gap) continue;
    refuse(
        source,
        fmt::format("{} lies {:g} mm from where evenly spaced slices would have it", series[n].name(), std::abs(off)),
        "resample the series evenly");
  }
  return gap;
}

// The sideways part of the way from one slice to another [mm].
Vec3 asideOf(const DicomSlice& from, const DicomSlice& to, const Vec3& normal) {
  const Vec3 step = to.position_mm - from.position_mm;
  return step - step.dot(normal) * normal;
}

// The step aside from slice to slice [mm], 0 of an upright block. Steps that are too small to see add up.
Vec3 stepAside(const DicomSeries& series, const std::string& source, bool tilted_too) {
  const Vec3 normal = normalOf(series);
  const double pixel_mm = series[0].spacing_mm[0];
  std::size_t shifted = 0;
  for (std::size_t n = 1; n < series.size() && shifted == 0; ++n) {
    if (asideOf(series[n - 1], series[n], normal).norm() > kLateralTolerance * pixel_mm ||
        asideOf(series[0], series[n], normal).norm() > kLateralDrift * pixel_mm)
      shifted = n;
  }
  if (shifted == 0) return Vec3::Zero();
  if (!tilted_too) {
    refuse(source, pairOf(series, shifted) + " are shifted sideways, as under a tilted gantry",
           "give --resample, or resample the series upright");
  }
  Vec3 step = asideOf(series.front(), series.back(), normal) / static_cast<double>(series.size() - 1);
  for (std::size_t n = 1; n < series.size(); ++n) {
    if ((asideOf(series[n - 1], series[n], normal) - step).norm() <= kLateralTolerance * pixel_mm) continue;
    refuse(source, pairOf(series, n) + " are shifted sideways by another step than the others",
           "resample the series upright in another program");
  }
  return step;
}

Lattice latticeOf(const DicomSlice& first, double gap_mm, const std::string& source) {
  Lattice lattice;
  lattice.origin_W = first.position_mm * kMetresPerMillimetre;
  lattice.spacing_m = Vec3(first.spacing_mm[0], first.spacing_mm[1], gap_mm) * kMetresPerMillimetre;
  lattice.R_WL << first.axes[0], first.axes[1], first.axes[0].cross(first.axes[1]);
  return orthonormalised(lattice, source);
}

}  // namespace

DicomBlock placeSlices(DicomSeries& series, const std::string& source, bool tilted_too) {
  for (DicomSlice& slice : series) placeSlice(slice, source);
  sortAlongNormal(series);
  checkAlike(series, source);
  const double gap_mm = checkGaps(series, source);
  const Vec3 aside_mm = stepAside(series, source, tilted_too);
  DicomBlock block = {latticeOf(series[0], gap_mm, source), std::atan2(aside_mm.norm(), gap_mm)};
  for (DicomSlice& slice : series) {
    const Vec3 from_first_mm = slice.position_mm - series[0].position_mm;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const Vec3 along = block.lattice.R_WL.col(static_cast<int>(axis));
      slice.aside_px[axis] = from_first_mm.dot(along) / series[0].spacing_mm[axis];
    }
  }
  return block;
}

}  // namespace palpate
