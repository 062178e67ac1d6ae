// SPDX-License-Identifier: Apache-2.0
#include "apps/extreme/extreme_case.hpp"

#include "base/error.hpp"

namespace palpate {

const std::vector<ExtremeCase>& extremeCases() {
  static const std::vector<ExtremeCase> kCases = [] {
    std::vector<ExtremeCase> cases;
    for (const auto add :
         {addValueCases, addLatticeCases, addShapeCases, addMotionCases, addClockCases, addDeviceCases, addWindowCases,
          addRenewalCases, addObjectCases, addEffectCases, addEditCases, addAlgorithmCases})
      add(cases);
    return cases;
  }();
  return kCases;
}

ExtremeOutcome outcomeOf(const ExtremeCase& one) {
  try {
    return one.run();
  } catch (const Error& error) {
    return {false, std::string("it was refused: ") + error.what()};
  }
}

}  // namespace palpate
