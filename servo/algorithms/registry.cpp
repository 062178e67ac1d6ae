// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/registry.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/algorithms/hri_paper.hpp"

namespace palpate {
namespace {

using Maker = std::unique_ptr<Algorithm> (*)(const AlgorithmParameters&, ContactEffects);

std::unique_ptr<Algorithm> makeHri(const AlgorithmParameters& parameters, ContactEffects effects) {
  return std::make_unique<Hri>(parameters, std::move(effects));
}

std::unique_ptr<Algorithm> makeHriPaper(const AlgorithmParameters& parameters, ContactEffects effects) {
  if (!effects.empty()) {
    throw Error(Error::Code::kBadInput, "hri-paper", "takes no contact effects", "use hri, or leave the effects out");
  }
  return std::make_unique<HriPaper>(parameters);
}

constexpr std::array<AlgorithmEntry, 2> kEntries = {{
    {"hri", "virtual plane at the surface point nearest to the tool, renewed every n ticks (the paper, mended)"},
    {"hri-paper", "the paper's Figure 2 to the letter, plane on the ray from VHIP to HIP, renewed every n + 1 ticks"},
}};
constexpr std::array<Maker, kEntries.size()> kMakers = {makeHri, makeHriPaper};

void check(bool good, const char* key, double value, const char* remedy) {
  if (!good) throw Error(Error::Code::kBadInput, key, fmt::format("{:g} cannot be used", value), remedy);
}

void checkParameters(const AlgorithmParameters& p) {
  check(std::isfinite(p.isovalue), "isovalue", p.isovalue, "give a finite density");
  check(std::isfinite(p.stiffness_N_per_m) && p.stiffness_N_per_m >= 0, "stiffness", p.stiffness_N_per_m,
        "give 0 N/m or more");
  check(std::isfinite(p.damping_Ns_per_m) && p.damping_Ns_per_m >= 0, "damping", p.damping_Ns_per_m,
        "give 0 N s/m or more");
  check(p.plane_renewal_ticks >= 1, "plane renewal", p.plane_renewal_ticks, "give 1 tick or more");
}

}  // namespace

std::span<const AlgorithmEntry> algorithms() noexcept {
  return kEntries;
}

std::unique_ptr<Algorithm> makeAlgorithm(std::string_view name, const AlgorithmParameters& parameters,
                                         ContactEffects effects) {
  std::string known;
  for (std::size_t i = 0; i < kEntries.size(); ++i) {
    if (kEntries[i].name == name) {
      checkParameters(parameters);
      return kMakers[i](parameters, std::move(effects));
    }
    known += (i == 0 ? "" : ", ") + std::string(kEntries[i].name);
  }
  throw Error(Error::Code::kBadInput, "algorithm", fmt::format("'{}' is not known", name), "use one of: " + known);
}

}  // namespace palpate
