// SPDX-License-Identifier: Apache-2.0
// apps/extreme/extreme_case.hpp: named cases at the edge of what a user may set or meet, each with what is expected.
//
// A case is a run, or several, of the real servo (rough_run.hpp) or of what prepares it. In every run every force that
// the device takes must be finite, within the force limit, and differ from the one before by at most the slew limit;
// every VHIP must be finite, every normal a unit vector or zero. A case says beyond that what must be felt.
// Any thread; the same case gives the same outcome everywhere.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/extreme/rough_run.hpp"

namespace palpate {

struct ExtremeOutcome {
  bool as_expected = true;
  std::string seen;  // in words, with figures; what differs, if it is not as expected
};

struct ExtremeCase {
  std::string group;        // "values"
  std::string name;         // "voxels of 1e-38"
  std::string expectation;  // "the plane is felt"
  std::function<ExtremeOutcome()> run;
};

// All of them, group by group. The names differ within a group.
[[nodiscard]] const std::vector<ExtremeCase>& extremeCases();

// Runs a case. An Error that it does not expect is an outcome that is not as expected.
[[nodiscard]] ExtremeOutcome outcomeOf(const ExtremeCase& one);

// The groups, a function for each file.
using ExtremeCases = std::vector<ExtremeCase>;
void addValueCases(ExtremeCases& to);
void addLatticeCases(ExtremeCases& to);
void addShapeCases(ExtremeCases& to);
void addMotionCases(ExtremeCases& to);
void addClockCases(ExtremeCases& to);
void addDeviceCases(ExtremeCases& to);
void addWindowCases(ExtremeCases& to);
void addRenewalCases(ExtremeCases& to);
void addObjectCases(ExtremeCases& to);
void addEffectCases(ExtremeCases& to);
void addEditCases(ExtremeCases& to);
void addAlgorithmCases(ExtremeCases& to);

}  // namespace palpate
