// SPDX-License-Identifier: Apache-2.0
// Filters and gradient operators as text. An accepted text, made again from all that was understood, gives the same
// filters. Each chain can be lowered to steps or is refused with a message.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "engine/filter/filter_spec.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

std::string textOf(const FilterSpec& spec) {
  std::string text =
      fmt::format("{}:{:.17g}{}", filterName(spec.kind), spec.size.value, spec.size.in_metres ? "m" : "");
  const bool bilateral = spec.kind == FilterKind::kBilateral, diffuse = spec.kind == FilterKind::kDiffuse;
  if (spec.kind == FilterKind::kGaussian || bilateral) text += fmt::format(":truncate={:.17g}", spec.truncate);
  if (bilateral) text += fmt::format(":range={:.17g}", spec.range);
  if (diffuse)
    text += fmt::format(":kappa={:.17g}:g={}", spec.kappa, spec.conductance == Conductance::kExp ? "exp" : "rational");
  if (diffuse && spec.dt_mm2) text += fmt::format(":dt={:.17g}", *spec.dt_mm2);
  if (spec.shape == WindowShape::kBall) text += ":shape=ball";
  if (spec.border == Border::kMirror) text += ":border=mirror";
  return text;
}

std::string textOf(const std::vector<FilterSpec>& chain) {
  std::string text;
  for (const FilterSpec& spec : chain) text += (text.empty() ? "" : " ") + textOf(spec);
  return text;
}

bool same(const FilterSpec& a, const FilterSpec& b) {
  return a.kind == b.kind && a.size.value == b.size.value && a.size.in_metres == b.size.in_metres &&
         a.border == b.border && a.truncate == b.truncate && a.range == b.range && a.kappa == b.kappa &&
         a.dt_mm2 == b.dt_mm2 && a.conductance == b.conductance && a.shape == b.shape;
}

// Whatever the spacing, kernels must get finite numbers.
void checkSteps(const std::vector<FilterSpec>& chain, const Vec3& spacing_m) {
  std::vector<FilterStep> steps;
  try {
    steps = lowerFilters(chain, spacing_m, 100.0F);
  } catch (const Error& error) {  // refused for this spacing
    return fuzz::requireMessage(error, "");
  }
  for (const FilterStep& step : steps) {
    const bool finite = std::all_of(step.taps.begin(), step.taps.end(), [](float tap) { return std::isfinite(tap); });
    fuzz::require(finite && step.reach.minCoeff() >= 0, "a step is given what is no number: " + textOf(chain));
  }
}

void checkChain(const std::string& text) {
  std::vector<FilterSpec> chain;
  if (!fuzz::accepts("filter ", [&] { chain = filterChain(text); })) return;
  fuzz::mustAccept("its own words are refused", [&] {
    const std::vector<FilterSpec> again = filterChain(textOf(chain));
    fuzz::require(std::equal(chain.begin(), chain.end(), again.begin(), again.end(), same),
                  "it reads otherwise from " + textOf(chain));
  });
  for (const Vec3& spacing_m : {Vec3(1e-3, 1e-3, 1e-3), Vec3(0.3e-3, 0.5e-3, 5e-3), Vec3(1e-9, 1e-6, 1)})
    checkSteps(chain, spacing_m);
}

void checkOperator(const std::string& text) {
  GradientOperator made;
  try {
    made = gradientOperator(text);
  } catch (const Error& error) {  // one refusal more: most texts are a chain or an operator, not both
    return fuzz::requireMessage(error, "");
  }
  fuzz::verdict = fuzz::Verdict::kAccepted;
  if (!made.smooths()) return;
  fuzz::mustAccept("its own words are refused", [&] {
    const GradientOperator again = gradientOperator(textOf(made.smoothing));
    fuzz::require(again.kind.name == made.kind.name && same(again.smoothing.at(0), made.smoothing.at(0)),
                  "it reads otherwise from " + textOf(made.smoothing));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::textOf(data, size);
  checkChain(text);
  checkOperator(text);
  return 0;
}
