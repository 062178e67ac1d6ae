// SPDX-License-Identifier: Apache-2.0
// palpate: touch volumes. One file per verb.
#include "program.hpp"
#include "start_window.hpp"
#include "verbs.hpp"

namespace {

void addVerbs(CLI::App& app) {
  for (const auto& add :
       {palpate::addTouchVerb,   palpate::addEditVerb,      palpate::addRecoverVerb,   palpate::addInfoVerb,
        palpate::addConvertVerb, palpate::addGradientVerb,  palpate::addFilterVerb,    palpate::addRenderVerb,
        palpate::addCheckVerb,   palpate::addBenchVerb,     palpate::addStabilityVerb, palpate::addDevicesVerb,
        palpate::addServeVerb,   palpate::addServoVerb,     palpate::addCtlVerb,       palpate::addTopVerb,
        palpate::addDoctorVerb,  palpate::addCalibrateVerb, palpate::addPlanVerb,      palpate::addTuneVerb,
        palpate::addSceneVerb,   palpate::addFaultsVerb,    palpate::addHelpVerb,      palpate::addCompletionVerb}) {
    add(app);
  }
  palpate::addSculptVerb(app, [](const palpate::SculptRequest&, const auto&) { palpate::startWindow(); });
}

}  // namespace

int main(int argc, char** argv) {
  return palpate::runProgram(argc, argv, addVerbs);
}
