// SPDX-License-Identifier: Apache-2.0
// A folder of DICOM slices: "folder", or "folder#2" or "folder#1.2.3" for one series by its number in the order of
// UIDs, or by its UID; of several one must be named. Source of the format: DICOM PS3.3, C.7.6.2 (Image Plane):
// positions and directions are LPS millimetres.
//
// GDCM under ITK, in a child process (itk_child.hpp), reads each slice and applies its slope and intercept.
// The order and spacing of slices come from their positions, never from file names or slice thickness.
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/shared_buffer.hpp"
#include "base/units.hpp"
#include "engine/volume/dicom_slice.hpp"
#include "engine/volume/magic.hpp"
#include "engine/volume/memory_budget.hpp"
#include "engine/volume/raw_values.hpp"
#include "engine/volume/readers.hpp"
#include "engine/volume/text_header.hpp"
#include "engine/volume/volume_name.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double kGapTolerance = 0.02;      // of the gap between slices [-]
constexpr double kLateralTolerance = 0.05;  // of the pixel spacing, from slice to slice [-]

[[noreturn]] void refuse(const std::string& source, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, source, reason, remedy);
}

using Series = std::vector<DicomSlice>;

void checkIsDicom(const fs::path& path, const std::string& source) {
  if (lowerCase(path.extension().string()) != ".dcm") return;  // any other file may lie beside the slices
  refuse(source, fmt::format("{} is no DICOM slice, or it is damaged", path.filename().string()),
         "copy the series again or take the file away");
}

// Names the file that ITK cannot read.
RefuseFile refuseSlice(const std::vector<fs::path>& files, const std::string& source) {
  return [&files, &source](std::size_t n, const std::string& words) {
    refuse(source, fmt::format("slice {} is damaged ({})", files[n].filename().string(), words),
           "copy the series again");
  };
}

// A file that cannot be opened is not a damaged one.
void checkOpens(const fs::path& path, const std::string& source) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int why = errno;
  if (descriptor >= 0) {
    close(descriptor);
    return;
  }
  throw Error(
      Error::Code::kIo, source,
      fmt::format("slice {} cannot be opened: {}", path.filename().string(), std::generic_category().message(why)),
      why == EMFILE || why == ENFILE ? "raise the limit of open files (ulimit -n), or end other programs"
                                     : "check the permissions of the file");
}

// Every series of a folder by its UID. Files that are no DICOM slices are passed over, unless their names say they are.
std::map<std::string, Series> readFolder(const std::string& folder, const std::string& source) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    checkOpens(entry.path(), source);
    if (formatByContent(entry.path().string(), source) == "DICOM") {
      files.push_back(entry.path());
    } else {
      checkIsDicom(entry.path(), source);
    }
  }
  if (files.empty()) refuse(source, "the folder holds no DICOM slices", "give the folder in which the slices are");
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) checkDicomFile(file, source);
  std::vector<ItkFacts> facts =
      readItkSeries(ItkReader::kDicomSlice, {files.begin(), files.end()}, source, refuseSlice(files, source));
  std::map<std::string, Series> all;
  for (std::size_t n = 0; n < files.size(); ++n) {
    DicomSlice slice;
    slice.path = files[n];
    slice.file = std::move(facts[n]);
    const std::string uid = slice.tag("0020|000e");
    all[uid].push_back(std::move(slice));
  }
  return all;
}

// For people: which series there are, by number.
std::string listOf(const std::map<std::string, Series>& all) {
  std::string list;
  for (const auto& [uid, series] : all) {
    const std::string description = series[0].tag("0008|103e");
    list +=
        fmt::format("{}{}: {}{} ({} slices)", list.empty() ? "" : ", ", std::distance(all.begin(), all.find(uid)) + 1,
                    description.empty() ? "" : "\"" + description + "\" ", uid, series.size());
  }
  return list;
}

// Returns the series' UID. `wanted`: its number, or its UID; empty: the only one.
std::string chooseSeries(const std::map<std::string, Series>& all, const std::string& wanted,
                         const std::string& source) {
  if (wanted.empty()) {
    if (all.size() == 1) return all.begin()->first;
    refuse(source, fmt::format("the folder holds {} series: {}", all.size(), listOf(all)),
           fmt::format("choose one: --series 1, or {}#1 as its name", source));
  }
  if (all.contains(wanted)) return wanted;
  std::size_t number = 0;
  const auto [end, failure] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  const bool is_number = failure == std::errc() && end == wanted.data() + wanted.size();
  if (is_number && number >= 1 && number <= all.size()) {
    return std::next(all.begin(), static_cast<std::ptrdiff_t>(number) - 1)->first;
  }
  refuse(source, fmt::format("the folder has no series {}", wanted), "choose one of " + listOf(all));
}

// Sorts along the normal, which is chosen so that the slices' first axis, second axis and normal are right-handed.
void sortSlices(Series& series, const std::string& source) {
  for (DicomSlice& slice : series) checkDicomSlice(slice, source);
  const Vec3 normal = series[0].axis(0).cross(series[0].axis(1)).normalized();
  for (DicomSlice& slice : series) slice.along_mm = slice.position_mm.dot(normal);
  std::sort(series.begin(), series.end(),
            [](const DicomSlice& a, const DicomSlice& b) { return a.along_mm < b.along_mm; });
}

void checkAlike(const Series& series, const std::string& source) {
  const ItkHeader& first = series[0].file.header;
  for (const DicomSlice& slice : series) {
    const ItkHeader& header = slice.file.header;
    const bool same_size = header.dimensions[0] == first.dimensions[0] && header.dimensions[1] == first.dimensions[1];
    const bool same_spacing = std::abs(header.spacing[0] - first.spacing[0]) <= 1e-4 * first.spacing[0] &&
                              std::abs(header.spacing[1] - first.spacing[1]) <= 1e-4 * first.spacing[1];
    const bool same_axes =
        (slice.axis(0) - series[0].axis(0)).norm() < 1e-3 && (slice.axis(1) - series[0].axis(1)).norm() < 1e-3;
    if (same_size && same_spacing && same_axes) continue;
    refuse(source,
           fmt::format("slices {} and {} differ in size, spacing or orientation", series[0].name(), slice.name()),
           "keep one scan in a folder");
  }
}

double medianGap_mm(const Series& series) {
  std::vector<double> gaps;
  for (std::size_t n = 1; n < series.size(); ++n) gaps.push_back(series[n].along_mm - series[n - 1].along_mm);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return gaps[gaps.size() / 2];
}

// The distance between slices [mm]; refuses gaps that differ, and slices that drift sideways as under a tilted gantry.
double checkGaps(const Series& series, const std::string& source) {
  if (series.size() < 2) refuse(source, "the series has one slice", "give the whole series");
  const double usual = medianGap_mm(series);
  const Vec3 normal = series[0].axis(0).cross(series[0].axis(1)).normalized();
  for (std::size_t n = 1; n < series.size(); ++n) {
    const double gap = series[n].along_mm - series[n - 1].along_mm;
    const std::string pair = series[n - 1].name() + " and " + series[n].name();
    if (gap < 1e-3) refuse(source, "slices " + pair + " lie at one place", "keep one time point or echo in a folder");
    if (gap > 1.5 * usual) {
      refuse(source, fmt::format("{:.0f} slices are missing between {}", std::round(gap / usual) - 1, pair),
             "add them");
    }
    if (std::abs(gap - usual) > kGapTolerance * usual) {
      refuse(source, fmt::format("slices {} are {:g} mm apart, others {:g} mm", pair, gap, usual),
             "resample the series evenly");
    }
    const Vec3 step = series[n].position_mm - series[n - 1].position_mm;
    if ((step - gap * normal).norm() > kLateralTolerance * series[0].file.header.spacing[0]) {
      refuse(source, fmt::format("slices {} are shifted sideways, as under a tilted gantry", pair),
             "resample the series upright");
    }
  }
  return (series.back().along_mm - series.front().along_mm) / static_cast<double>(series.size() - 1);
}

Lattice latticeOf(const Series& series, double gap_mm, const std::string& source) {
  const ItkHeader& first = series[0].file.header;
  Lattice lattice;
  lattice.origin_W = series[0].position_mm * kMetresPerMillimetre;
  lattice.spacing_m = Vec3(first.spacing[0], first.spacing[1], gap_mm) * kMetresPerMillimetre;
  lattice.R_WL << series[0].axis(0), series[0].axis(1), series[0].axis(0).cross(series[0].axis(1));
  return orthonormalised(lattice, source);
}

std::vector<float> readPixels(const Series& series, const std::string& source) {
  const auto& n = series[0].file.header.dimensions;
  const auto pixels = static_cast<std::size_t>(n[0] * n[1]);
  std::vector<fs::path> files;
  std::vector<std::string> paths;
  std::size_t bytes = 0;
  for (const DicomSlice& slice : series) {
    files.push_back(slice.path);
    paths.push_back(slice.path.string());
    bytes += pixels * byteSize(*slice.file.header.type);
  }
  const SharedBuffer raw(bytes);
  std::vector<std::span<char>> parts;
  std::size_t at = 0;
  for (const DicomSlice& slice : series) {
    parts.push_back(raw.bytes().subspan(at, pixels * byteSize(*slice.file.header.type)));
    at += parts.back().size();
  }
  readItkSeriesValues(ItkReader::kDicomSlice, paths, parts, source, refuseSlice(files, source));
  std::vector<float> values;
  values.reserve(pixels * series.size());
  for (std::size_t slice = 0; slice < series.size(); ++slice) {
    const std::vector<float> converted = toFloats(parts[slice], *series[slice].file.header.type);
    values.insert(values.end(), converted.begin(), converted.end());
  }
  return values;
}

VolumeFacts factsOf(const std::map<std::string, Series>& all, const std::string& uid, const std::string& source) {
  const DicomSlice& first = all.at(uid)[0];
  VolumeFacts facts;
  facts.source = source;
  facts.format = "DICOM series";
  const std::vector<double> stored_bits = dicomNumbers(first.tag("0028|0100"));
  const std::vector<double> is_signed = dicomNumbers(first.tag("0028|0103"));
  facts.value_type = fmt::format("{}int{:.0f}", is_signed == std::vector<double>{1} ? "" : "u",
                                 stored_bits.empty() ? 16 : stored_bits[0]);
  facts.orientation = "LPS, from the slices' positions";
  const std::vector<double> slope = dicomNumbers(first.tag("0028|1053"));
  const std::vector<double> intercept = dicomNumbers(first.tag("0028|1052"));
  if (!slope.empty()) facts.rescale_slope = slope[0];
  if (!intercept.empty()) facts.rescale_intercept = intercept[0];
  const std::string description = first.tag("0008|103e");
  const std::string words = description.empty() ? uid : fmt::format("{} \"{}\"", uid, description);
  facts.part = all.size() == 1 ? "series " + words
                               : fmt::format("series {} of {}: {}", std::distance(all.begin(), all.find(uid)) + 1,
                                             all.size(), words);
  return facts;
}

}  // namespace

Volume readDicom(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const VolumeName parsed = parseVolumeName(name);
  std::map<std::string, Series> all = readFolder(parsed.path, name);
  const std::string uid = chooseSeries(all, parsed.part, name);
  Series& series = all.at(uid);
  sortSlices(series, name);
  checkAlike(series, name);
  const double gap_mm = checkGaps(series, name);
  const auto& n = series[0].file.header.dimensions;
  const auto count = static_cast<std::int64_t>(series.size());
  checkMemory(name, n[0], n[1], count, 0, wanted.memory_budget_bytes);
  const Vec3i size(static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(count));
  VolumeFacts facts = factsOf(all, uid, name);
  const Lattice lattice = latticeOf(series, gap_mm, name);
  return Volume::fromDense(size, lattice, readPixels(series, name), std::move(facts));
}

}  // namespace palpate
