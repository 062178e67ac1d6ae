// SPDX-License-Identifier: Apache-2.0
#include "engine/gradient/gradient_operator.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {
namespace {

constexpr GradientKind kOperators[] = {
    {"central", "", GRADIENT_CENTRAL, 1, "central difference"},
    {"sobel", "", GRADIENT_SOBEL, 1, "central difference, averaged over the 3x3 rows beside it"},
    {"central4", "", GRADIENT_CENTRAL4, 2, "fourth-order central difference; within two voxels of the border central"},
    {"gaussian", "sigma", GRADIENT_CENTRAL, 1, "central difference of the Gaussian-smoothed field"},
};

[[noreturn]] void refuseOperator(const std::string& text, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, fmt::format("gradient operator '{}'", text), reason, remedy);
}
[[noreturn]] void refuseOperator(const std::string& text, const std::string& reason) {
  refuseOperator(text, reason, "use " + gradientNames());
}

[[noreturn]] void refuseName(const std::string& text, std::string_view name) {
  std::vector<std::string> known;
  for (const GradientKind& row : kOperators) known.emplace_back(row.name);
  refuseOperator(text, "there is none of this name", withDidYouMean(name, known, "use " + gradientNames()));
}

}  // namespace

GradientOperator::GradientOperator() : GradientOperator(kOperators[0]) {}

std::span<const GradientKind> gradientKinds() noexcept {
  return kOperators;
}

GradientOperator gradientOperator(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view name = std::string_view(text).substr(0, colon);
  const auto* found = std::find_if(std::begin(kOperators), std::end(kOperators),
                                   [&](const GradientKind& row) { return row.name == name; });
  if (found == std::end(kOperators)) refuseName(text, name);
  GradientOperator made(*found);
  if (found->parameter.empty()) {
    if (colon != text.size()) refuseOperator(text, fmt::format("{} takes nothing behind its name", name));
    return made;
  }
  if (text.find_first_of(" \t") != std::string::npos) refuseOperator(text, "it is more than one word");
  made.smoothing = filterChain(text);  // the filter of the same name parses its parameters and refuses wrong ones
  return made;
}

std::string gradientNames() {
  std::string text;
  for (const GradientKind& row : kOperators) {
    text += fmt::format("{}{}", text.empty() ? "" : ", ", row.name);
    if (!row.parameter.empty()) text += ":0.8mm";
  }
  return text;
}

}  // namespace palpate
