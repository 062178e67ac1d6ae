// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_folder.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/files/dicom_parts.hpp"
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

DicomSeries slicesOf(const std::string& folder, const std::string& source) {
  DicomSeries slices;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    checkOpens(entry.path().string(), source, "slice " + entry.path().filename().string());
    if (formatByContent(entry.path().string(), source) == "DICOM") {
      for (DicomSlice& slice : slicesOfFile(entry.path(), source)) slices.push_back(std::move(slice));
    } else {
      checkIsDicom(entry.path(), source);
    }
  }
  if (slices.empty()) refuse(source, "the folder holds no DICOM slices", "give the folder in which the slices are");
  std::sort(slices.begin(), slices.end(), [](const DicomSlice& a, const DicomSlice& b) {
    return std::tie(a.path, a.frame) < std::tie(b.path, b.frame);
  });
  return slices;
}

// The numbered list for messages of the series whose keys begin with `first`.
std::string listOf(const DicomFolder& all, const std::string& first = "") {
  constexpr int kMost = 20;
  std::string list;
  int count = 0;
  for (const auto& [key, series] : all) {
    if (!key.starts_with(first) || ++count > kMost) continue;
    list +=
        fmt::format("{}{}: {} ({} slice{})", list.empty() ? "" : ", ", std::distance(all.begin(), all.find(key)) + 1,
                    wordsOfSeries(all, key, true), series.size(), series.size() == 1 ? "" : "s");
  }
  return count <= kMost ? list : fmt::format("{} and {} more", list, count - kMost);
}

}  // namespace

DicomFolder readDicomFolder(const std::string& folder, const std::string& source) {
  std::map<std::string, DicomSeries> by_uid;
  for (DicomSlice& slice : slicesOf(folder, source)) {
    const std::string uid = slice.text(DicomTag::kSeriesInstanceUid);
    by_uid[uid].push_back(std::move(slice));
  }
  DicomFolder all;
  for (auto& [uid, slices] : by_uid) {
    std::vector<DicomSeries> parts = partsOf(std::move(slices));
    for (std::size_t n = 0; n < parts.size(); ++n)
      all[parts.size() == 1 ? uid : fmt::format("{}/{:04}", uid, n + 1)] = std::move(parts[n]);
  }
  return all;
}

std::string wordsOfSeries(const DicomFolder& all, const std::string& key, bool description_first) {
  const DicomSlice& first = all.at(key)[0];
  std::string words = key;
  if (words != first.text(DicomTag::kSeriesInstanceUid)) words += first.part;
  const std::string description = first.text(DicomTag::kSeriesDescription);
  if (description.empty()) return words;
  return description_first ? fmt::format("\"{}\" {}", description, words)
                           : fmt::format("{} \"{}\"", words, description);
}

std::string chooseSeries(const DicomFolder& all, const std::string& wanted, const std::string& source) {
  if (wanted.empty()) {
    if (all.size() == 1) return all.begin()->first;
    refuse(source, fmt::format("the folder holds {} series: {}", all.size(), listOf(all)),
           fmt::format("choose one: --series 1, or {}#1 as its name", source));
  }
  if (all.contains(wanted)) return wanted;
  const std::string parts = listOf(all, wanted + "/");
  if (!parts.empty())
    refuse(source, fmt::format("the series {} holds several volumes", wanted), "choose one of " + parts);
  std::size_t number = 0;
  const auto [end, failure] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
  const bool is_number = failure == std::errc() && end == wanted.data() + wanted.size();
  if (is_number && number >= 1 && number <= all.size()) {
    return std::next(all.begin(), static_cast<std::ptrdiff_t>(number) - 1)->first;
  }
  refuse(source, fmt::format("the folder has no series {}", wanted), "choose one of " + listOf(all));
}

}  // namespace palpate
