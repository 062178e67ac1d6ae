// SPDX-License-Identifier: Apache-2.0
#include "engine/files/volume_name.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kNan = "nan=";
constexpr std::string_view kResample = "resample";

bool isThere(const std::string& path) {
  std::error_code failure;
  return fs::exists(path, failure);
}

bool isPhantom(const std::string& name) {
  return name.starts_with("phantom:");
}

float nanValue(const std::string& name, std::string_view text) {
  float value = 0;
  const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code == std::errc() && stop == text.data() + text.size() && std::isfinite(value)) return value;
  refuse(name, fmt::format("\"{}\" is no density for voxels that are no numbers", text),
         "give a number, for example --nan -1024");
}

// Takes "nan=0&resample" apart. False if it begins with neither: then it belongs to the file's name.
bool readQuery(VolumeName& parsed, const std::string& name, std::string_view query) {
  while (true) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view word = query.substr(0, end);
    if (word.starts_with(kNan) && !parsed.instead_of_nan) {
      parsed.instead_of_nan = nanValue(name, word.substr(kNan.size()));
    } else if (word == kResample && !parsed.resample) {
      parsed.resample = true;
    } else if (!parsed.has_query) {
      return false;
    } else {
      refuse(name, fmt::format("\"{}\" is nothing that a volume's name may say there", word),
             "give nan=VALUE or resample, each once");
    }
    parsed.has_query = true;
    if (end == query.size()) return true;
    query.remove_prefix(end + 1);
  }
}

std::string withWord(const std::string& name, const std::string& word) {
  return name + (parseVolumeName(name).has_query ? '&' : '?') + word;
}

}  // namespace

VolumeName parseVolumeName(const std::string& name) {
  VolumeName parsed{name, "", {}};
  if (isPhantom(name) || isThere(name)) return parsed;
  const std::size_t query = name.rfind('?');
  if (query != std::string::npos && readQuery(parsed, name, std::string_view(name).substr(query + 1))) {
    parsed.path.resize(query);
    if (isThere(parsed.path)) return parsed;
  }
  if (const std::size_t at = parsed.path.rfind('#'); at != std::string::npos && at + 1 < parsed.path.size()) {
    parsed.part = parsed.path.substr(at + 1);
    parsed.path.resize(at);
  }
  return parsed;
}

std::string withSeries(const std::string& folder, const std::string& series) {
  if (series.empty()) refuse("--series", "it is empty", "give the number or the UID of a series");
  const VolumeName name = parseVolumeName(folder);
  std::error_code failure;
  if (!fs::is_directory(name.path, failure)) {
    refuse(folder, "it is no folder of DICOM slices, so it has no series", "leave --series out");
  }
  if (!name.part.empty()) refuse(folder, "it names a series, and so does --series", "leave one of them out");
  return fmt::format("{}#{}{}", name.path, series, folder.substr(name.path.size()));
}

std::string withResample(const std::string& name) {
  if (isPhantom(name)) refuse(name, "a phantom has no tilted slices", "leave --resample out");
  return parseVolumeName(name).resample ? name : withWord(name, std::string(kResample));
}

std::string withNan(const std::string& name, const std::string& value) {
  if (isPhantom(name)) refuse(name, "a phantom has no voxels that are no numbers", "leave --nan out");
  if (parseVolumeName(name).instead_of_nan) {
    refuse(name, "it says what voxels that are no numbers become, and so does --nan", "leave one of them out");
  }
  static_cast<void>(nanValue("--nan", value));
  return withWord(name, std::string(kNan) + value);
}

}  // namespace palpate
