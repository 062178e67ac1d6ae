// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <iterator>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/error.hpp"
#include "engine/files/magic.hpp"
#include "engine/files/text_header.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

void checkIsDicom(const fs::path& path, const std::string& source) {
  if (lowerCase(path.extension().string()) != ".dcm") return;  // any other file may lie beside the slices
  refuseEmpty(path.string(), source, fmt::format("slice {}", path.filename().string()));
  refuse(source, fmt::format("{} is no DICOM slice, or it is damaged", path.filename().string()),
         "copy the series again or take the file away");
}

// A file that cannot be opened is not a damaged one.
void checkOpens(const fs::path& path, const std::string& source) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    throw cannotRead(source, fmt::format("slice {}", path.filename().string()), {errno, std::generic_category()});
  }
  close(descriptor);
}

std::vector<fs::path> slicesOf(const std::string& folder, const std::string& source) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    checkOpens(entry.path(), source);
    if (formatByContent(entry.path().string(), source) == "DICOM") {
      if (isDicomSlice(entry.path(), source)) files.push_back(entry.path());
    } else {
      checkIsDicom(entry.path(), source);
    }
  }
  if (files.empty()) refuse(source, "the folder holds no DICOM slices", "give the folder in which the slices are");
  std::sort(files.begin(), files.end());
  return files;
}

// The numbered list of series for messages.
std::string listOf(const DicomFolder& all) {
  std::string list;
  for (const auto& [uid, series] : all) {
    const std::string description = series[0].tag("0008|103e");
    list += fmt::format(
        "{}{}: {}{} ({} slice{})", list.empty() ? "" : ", ", std::distance(all.begin(), all.find(uid)) + 1,
        description.empty() ? "" : "\"" + description + "\" ", uid, series.size(), series.size() == 1 ? "" : "s");
  }
  return list;
}

}  // namespace

DicomFolder readDicomFolder(const std::string& folder, const std::string& source) {
  const std::vector<fs::path> files = slicesOf(folder, source);
  std::vector<ItkFacts> facts =
      readItkSeries(ItkReader::kDicomSlice, {files.begin(), files.end()}, source, refuseSlice(files, source));
  DicomFolder all;
  for (std::size_t n = 0; n < files.size(); ++n) {
    DicomSlice slice;
    slice.path = files[n];
    slice.file = std::move(facts[n]);
    const std::string uid = slice.tag("0020|000e");
    all[uid].push_back(std::move(slice));
  }
  return all;
}

std::string chooseSeries(const DicomFolder& all, const std::string& wanted, const std::string& source) {
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

}  // namespace palpate
