// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/filter_spec.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

struct FilterRow {
  FilterKind kind;
  FilterWords words;
  bool has_border = false;  // a choice of what it reads beyond the border
};

constexpr FilterRow kFilters[] = {
    {FilterKind::kGaussian,
     {"gaussian", "sigma", "truncate=3 (in sigmas), border=nearest|mirror",
      "low-pass; separable, sampled, its taps sum to one"},
     true},
    {FilterKind::kBilateral,
     {"bilateral", "sigma", "range (sigma in density; needed), truncate=2 (in sigmas), border=nearest|mirror",
      "low-pass that keeps steps much higher than the range"},
     true},
    {FilterKind::kDiffuse,
     {"diffuse", "steps", "kappa (in density per mm; needed), dt (in mm^2; half of what is stable), g=rational|exp",
      "anisotropic diffusion (Perona and Malik): smooths where the slope is below kappa, keeps the mean"}},
    {FilterKind::kDistance,
     {"distance", "band in voxels", "none",
      "signed distance from the isosurface in metres, positive in the object, cut off at the band"}},
    {FilterKind::kMedian,
     {"median", "radius", "border=nearest|mirror", "middle value of the box that reaches so far; exact"},
     true},
    {FilterKind::kDilate,
     {"dilate", "radius", "shape=box|ball, border=nearest|mirror", "highest value of the box or ball"},
     true},
    {FilterKind::kErode,
     {"erode", "radius", "shape=box|ball, border=nearest|mirror", "lowest value of the box or ball"},
     true},
    {FilterKind::kOpen,
     {"open", "radius", "shape=box|ball, border=nearest|mirror", "erode, then dilate: what is thinner goes"},
     true},
    {FilterKind::kClose,
     {"close", "radius", "shape=box|ball, border=nearest|mirror",
      "dilate, then erode: gaps that are thinner are filled"},
     true},
};

[[noreturn]] void refuseFilter(std::string_view filter, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, fmt::format("filter {}", filter), reason, remedy);
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const FilterRow& row : kFilters) all.emplace_back(row.words.name);
  return all;
}

// Every kind has a row.
const FilterRow& rowOf(FilterKind kind) {
  return *std::ranges::find(kFilters, kind, &FilterRow::kind);
}

std::string namesInWords() {
  return fmt::format("{}", fmt::join(names(), ", "));
}

// A number and the text after it.
std::pair<double, std::string_view> numberOf(std::string_view filter, std::string_view what, std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || !std::isfinite(number)) {
    refuseFilter(filter, fmt::format("its {} '{}' is no number", what, text),
                 "give for example gaussian:0.8mm or median:1");
  }
  return {number, text.substr(static_cast<std::size_t>(end - text.data()))};
}

Extent extentOf(std::string_view filter, std::string_view what, std::string_view text) {
  constexpr std::pair<std::string_view, double> kUnits[] = {
      {"mm", kMetresPerMillimetre}, {"um", 1e-6}, {"cm", 1e-2}, {"m", 1}};
  const auto [number, unit] = numberOf(filter, what, text);
  Extent extent{number, false};
  for (const auto& [name, metres] : kUnits) {
    if (unit == name) extent = {number * metres, true};
  }
  if (!unit.empty() && !extent.in_metres) {
    refuseFilter(filter, fmt::format("there is no unit '{}'", unit), "give voxels without a unit, or mm, um, cm, m");
  }
  // Checks the converted length: a number above 0 may underflow in metres.
  if (!(extent.value > 0)) refuseFilter(filter, fmt::format("its {} is {:g}", what, number), "give a number above 0");
  return extent;
}

double plain(std::string_view filter, std::string_view key, std::string_view text, double lowest, double highest) {
  const auto [number, rest] = numberOf(filter, key, text);
  if (!rest.empty() || number < lowest || number > highest) {
    refuseFilter(filter, fmt::format("its {} is '{}'", key, text), fmt::format("give {:g} to {:g}", lowest, highest));
  }
  return number;
}

// Reads the keys whose values are plain numbers above 0.
double positive(std::string_view filter, std::string_view key, std::string_view text) {
  return plain(filter, key, text, 1e-30, 1e30);
}

// Reads the keys of one kind of filter. False: it has no key of that name.
bool setOwnKey(std::string_view filter, std::string_view key, std::string_view value, FilterSpec& spec) {
  switch (spec.kind) {
    case FilterKind::kGaussian:
    case FilterKind::kBilateral:
      if (key == "truncate") {
        spec.truncate = plain(filter, key, value, 1, 8);
        return true;
      }
      if (key != "range" || spec.kind != FilterKind::kBilateral) return false;
      spec.range = positive(filter, key, value);
      return true;
    case FilterKind::kDiffuse:
      if (key == "kappa") {
        spec.kappa = positive(filter, key, value);
      } else if (key == "dt") {
        spec.dt_mm2 = positive(filter, key, value);
      } else if (key == "g") {
        if (value != "rational" && value != "exp") {
          refuseFilter(filter, fmt::format("there is no conductance '{}'", value), "use g=rational or g=exp");
        }
        spec.conductance = value == "exp" ? Conductance::kExp : Conductance::kRational;
      } else {
        return false;
      }
      return true;
    case FilterKind::kDilate:
    case FilterKind::kErode:
    case FilterKind::kOpen:
    case FilterKind::kClose:
      if (key != "shape") return false;
      if (value != "box" && value != "ball") {
        refuseFilter(filter, fmt::format("there is no shape '{}'", value), "use shape=box or shape=ball");
      }
      spec.shape = value == "ball" ? WindowShape::kBall : WindowShape::kBox;
      return true;
    case FilterKind::kMedian:
    case FilterKind::kDistance:
      break;
  }
  return false;
}

void checkWhole(std::string_view filter, const FilterSpec& spec, int most, std::string_view what) {
  const double size = spec.size.value;
  if (!spec.size.in_metres && size == std::floor(size) && size <= most) return;
  refuseFilter(filter, fmt::format("its {} must be a whole number from 1 to {}, without a unit", what, most),
               "give such a number");
}

// Checks that a filter has the keys that it needs beyond its size.
void checkComplete(std::string_view filter, const FilterSpec& spec) {
  if (spec.kind == FilterKind::kBilateral && spec.range == 0) {
    refuseFilter(filter, "it has no range", "give the densities that it may mix, for example range=50");
  }
  if (spec.kind == FilterKind::kDiffuse) {
    checkWhole(filter, spec, kMostDiffusionSteps, "number of steps");
    if (spec.kappa == 0) refuseFilter(filter, "it has no kappa", "give the slope to keep, for example kappa=100");
  }
  if (spec.kind == FilterKind::kDistance) checkWhole(filter, spec, kWidestBand, "band in voxels");
}

void setKey(std::string_view filter, std::string_view key, std::string_view value, FilterSpec& spec) {
  if (key == "border" && rowOf(spec.kind).has_border) {
    if (value != "nearest" && value != "mirror") {
      refuseFilter(filter, fmt::format("there is no border '{}'", value), "use border=nearest or border=mirror");
    }
    spec.border = value == "mirror" ? Border::kMirror : Border::kNearest;
  } else if (!setOwnKey(filter, key, value, spec)) {
    refuseFilter(filter, fmt::format("it has no '{}'", key), fmt::format("its keys: {}", rowOf(spec.kind).words.keys));
  }
}

FilterSpec filterOf(std::string_view text) {
  std::string_view rest = text;
  const auto next = [&] {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return word;
  };
  FilterSpec spec;
  const std::string_view name = next();
  const FilterRow* found = nullptr;
  for (const FilterRow& row : kFilters) found = row.words.name == name ? &row : found;
  if (found == nullptr && (name == "mm" || name == "um" || name == "cm" || name == "m")) {
    refuseFilter(text, "there is a blank before this unit", "write it without: gaussian:1mm");
  }
  if (found == nullptr) {
    refuseFilter(text, fmt::format("there is no filter '{}'", name),
                 withDidYouMean(name, names(), "use " + namesInWords()));
  }
  if (text.ends_with(':')) refuseFilter(text, "nothing follows its last colon", "leave that out, or give a key");
  spec.kind = found->kind;
  if (spec.kind == FilterKind::kBilateral) spec.truncate = 2;
  if (rest.empty())
    refuseFilter(text, fmt::format("it has no {}", found->words.size), fmt::format("give for example {}:1", name));
  spec.size = extentOf(text, found->words.size, next());
  std::vector<std::string_view> seen;
  while (!rest.empty()) {
    const std::string_view word = next();
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) {
      refuseFilter(text, fmt::format("'{}' has no value", word), fmt::format("its keys: {}", found->words.keys));
    }
    const std::string_view key = word.substr(0, equals);
    if (std::find(seen.begin(), seen.end(), key) != seen.end())
      refuseFilter(text, fmt::format("'{}' stands there twice", key), "give it once");
    seen.push_back(key);
    setKey(text, key, word.substr(equals + 1), spec);
  }
  checkComplete(text, spec);
  return spec;
}

}  // namespace

std::span<const FilterWords> filterTable() noexcept {
  static const std::vector<FilterWords> kWords = [] {
    std::vector<FilterWords> words;
    for (const FilterRow& row : kFilters) words.push_back(row.words);
    return words;
  }();
  return kWords;
}

std::vector<FilterSpec> filterChain(const std::string& text) {
  if (text.find(',') != std::string::npos) {
    refuseFilter(text, "it has a comma",
                 "part filters by blanks, and decimals by a point: \"gaussian:0.8mm median:1\"");
  }
  std::vector<FilterSpec> chain;
  std::istringstream words(text);
  for (std::string word; words >> word;) chain.push_back(filterOf(word));
  if (chain.empty())
    refuseFilter(text, "it names no filter", "use " + namesInWords() + ", for example \"gaussian:0.8mm\"");
  return chain;
}

std::string_view filterName(FilterKind kind) noexcept {
  return rowOf(kind).words.name;
}

bool hasDistance(std::span<const FilterSpec> chain) noexcept {
  return std::any_of(chain.begin(), chain.end(),
                     [](const FilterSpec& filter) { return filter.kind == FilterKind::kDistance; });
}

float isovalueAfter(std::span<const FilterSpec> chain, float isovalue) noexcept {
  for (const FilterSpec& filter : chain) isovalue = filter.kind == FilterKind::kDistance ? 0.0F : isovalue;
  return isovalue;
}

}  // namespace palpate
