// SPDX-License-Identifier: Apache-2.0
#include "engine/phantoms/phantom_spec.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/ranges.h>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "engine/field/memory_budget.hpp"
#include "engine/phantoms/kinds.hpp"
#include "engine/phantoms/phantom.hpp"

namespace palpate {
namespace {

constexpr std::string_view kPrefix = "phantom:";

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(separator); end != std::string_view::npos; end = text.find(separator, begin)) {
    parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.emplace_back(text.substr(begin));
  return parts;
}

template <class Number>
Number parseNumber(const std::string& input, const std::string& key, std::string_view text) {
  Number number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || end != text.data() + text.size()) {
    refuse(input, fmt::format("{}=\"{}\" is not a number of the kind that is needed", key, text),
           "the form is 'phantom:NAME?size=64&spacing=1mm&noise=0.05&seed=1'");
  }
  return number;
}

// "64" or "128x128x64".
template <class Number>
Eigen::Matrix<Number, 3, 1> parseTriple(const std::string& input, const std::string& key, std::string_view text) {
  const std::vector<std::string> parts = split(text, 'x');
  if (parts.size() != 1 && parts.size() != 3) {
    refuse(input, fmt::format("{}=\"{}\" has {} numbers", key, text, parts.size()),
           "give one or three: 64 or 128x128x64");
  }
  Eigen::Matrix<Number, 3, 1> triple;
  for (std::size_t n = 0; n < 3; ++n) {
    triple[static_cast<int>(n)] = parseNumber<Number>(input, key, parts[parts.size() == 1 ? 0 : n]);
  }
  return triple;
}

Vec3 parseSpacing(const std::string& input, std::string_view text) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  for (const Unit& unit : {Unit{"mm", 1e-3}, Unit{"um", 1e-6}, Unit{"m", 1.0}}) {
    if (!text.ends_with(unit.name)) continue;
    text.remove_suffix(unit.name.size());
    Vec3 spacing_m = parseTriple<double>(input, "spacing", text) * unit.metres;
    if (!spacing_m.allFinite() || spacing_m.minCoeff() <= 0) {
      refuse(input, "its spacing is not positive", "give the voxel size: spacing=1mm");
    }
    return spacing_m;
  }
  const std::size_t number_end = text.find_last_of("0123456789.");
  const std::string_view unit = number_end == std::string_view::npos ? text : text.substr(number_end + 1);
  refuse(input,
         unit.empty() ? fmt::format("spacing=\"{}\" has no unit", text) : fmt::format("there is no unit \"{}\"", unit),
         "write mm, um or m: spacing=1mm");
}

Vec3i parseSize(const std::string& input, std::string_view text) {
  Vec3i size = parseTriple<int>(input, "size", text);
  if (size.minCoeff() < 1 || size.maxCoeff() > kMaxDimension) {
    refuse(input, fmt::format("size={} is out of range", text),
           fmt::format("give 1 to {} voxels along an axis", kMaxDimension));
  }
  return size;
}

double parseWithin(const std::string& input, const std::string& key, std::string_view text, double low, double high) {
  const auto number = parseNumber<double>(input, key, text);
  if (!(number >= low && number <= high)) {
    refuse(input, fmt::format("{}={} is out of range", key, text), fmt::format("give {:g} to {:g}", low, high));
  }
  return number;
}

const PhantomKind& findKind(const std::string& input, const std::string& name) {
  const auto& kinds = phantomKinds();
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const PhantomKind& kind) { return kind.name == name; });
  if (found != kinds.end()) return *found;
  std::vector<std::string> names;
  for (const PhantomKind& kind : kinds) names.push_back(kind.name);
  refuse(input, fmt::format("there is no phantom \"{}\"", name),
         withDidYouMean(name, names, fmt::format("choose one of {}", fmt::join(names, ", "))));
}

// Sets one key; returns whether the spacing was given.
bool applyKey(PhantomSpec& spec, const PhantomKind& kind, const std::string& key, std::string_view value) {
  std::vector<std::string> known = {"size", "spacing", "noise", "seed"};
  known.insert(known.end(), kind.extra_keys.begin(), kind.extra_keys.end());
  if (std::find(known.begin(), known.end(), key) == known.end()) {
    refuse(spec.text, fmt::format("phantom {} has no key \"{}\"", kind.name, key),
           withDidYouMean(key, known, fmt::format("its keys are {}", fmt::join(known, ", "))));
  }
  if (key == "size") spec.size = parseSize(spec.text, value);
  if (key == "spacing") spec.spacing_m = parseSpacing(spec.text, value);
  if (key == "noise") spec.noise = parseWithin(spec.text, key, value, 0, 10);
  if (key == "seed") spec.seed = parseNumber<std::uint64_t>(spec.text, key, value);
  if (key == "thickness") spec.thickness_voxels = parseWithin(spec.text, key, value, 0.1, 1000);
  return key == "spacing";
}

// head and lung fill a cube of their natural extent however many voxels it is cut into.
Vec3 naturalSpacing_m(const PhantomKind& kind, const Vec3i& size) {
  if (kind.natural_extent_m <= 0) return Vec3::Constant(1e-3);
  return Vec3::Constant(kind.natural_extent_m).cwiseQuotient(size.cast<double>());
}

}  // namespace

const std::vector<PhantomKind>& phantomKinds() {
  static const std::vector<PhantomKind> kKinds = {
      {"sphere", "one sphere", Vec3i::Constant(64), 0, {}, makeSphere},
      {"box", "a box with sharp edges", Vec3i::Constant(64), 0, {}, makeBox},
      {"spheres", "three spheres of different density", Vec3i::Constant(64), 0, {}, makeSpheres},
      {"knot", "the tube of a (2,3) torus knot", Vec3i::Constant(64), 0, {}, makeKnot},
      {"shell", "a thin spherical wall", Vec3i::Constant(64), 0, {"thickness"}, makeShell},
      {"gyroid", "a triply periodic surface with many passages", Vec3i::Constant(64), 0, {}, makeGyroid},
      {"head", "CT-like head: skin, skull with a hole, brain, sinuses", Vec3i(128, 128, 64), 0.2048, {}, makeHead},
      {"lung", "CT-like chest: wall, lungs, vessel trees, spine", Vec3i(128, 128, 64), 0.336, {}, makeLung},
      {"random",
       "random values, denormal and huge ones too, for bit-exactness tests",
       Vec3i::Constant(64),
       0,
       {},
       makeRandom},
  };
  return kKinds;
}

PhantomSpec parsePhantomSpec(const std::string& text) {
  PhantomSpec spec;
  spec.text = text;
  std::string_view rest = text;
  if (rest.starts_with(kPrefix)) rest.remove_prefix(kPrefix.size());
  const std::size_t question = rest.find('?');
  spec.name = rest.substr(0, question);
  const PhantomKind& kind = findKind(text, spec.name);
  spec.size = kind.size;
  bool spacing_given = false;
  if (question != std::string_view::npos) {
    for (const std::string& pair : split(rest.substr(question + 1), '&')) {
      const std::size_t equals = pair.find('=');
      if (equals == std::string::npos) refuse(text, fmt::format("\"{}\" is not key=value", pair), "write size=64");
      spacing_given |= applyKey(spec, kind, pair.substr(0, equals), std::string_view(pair).substr(equals + 1));
    }
  }
  if (!spacing_given) spec.spacing_m = naturalSpacing_m(kind, spec.size);
  return spec;
}

}  // namespace palpate
