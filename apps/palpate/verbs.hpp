// SPDX-License-Identifier: Apache-2.0
// apps/palpate/verbs.hpp: the verbs of the command line. A new verb is one file and one line here and in main.cpp.
//
// Each function adds its verb to the program; the verb's callback does the work and throws Error, which main() turns
// into one line on stderr and an exit status.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/atomic_file.hpp"

namespace palpate {

struct SculptRequest;

// A CLI11 check for numbers from `least` to `most`. Not CLI::Range, which accepts NaN.
[[nodiscard]] inline auto numberFrom(double least, double most) {
  return [=](const std::string& text) -> std::string {
    double value = 0;
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return {};
    return fmt::format("'{}' is no number from {:g} to {:g}", text, least, most);
  };
}
// A CLI11 check for options that may not be empty: returns the message, or "" if the text is not empty.
[[nodiscard]] inline std::string notEmpty(const std::string& text) {
  return text.empty() ? "'' is empty: name something, or leave the option out" : "";
}

void addTouchVerb(CLI::App& app);
void addEditVerb(CLI::App& app);
void addRecoverVerb(CLI::App& app);
// `run` gets what was asked for, once it is known to be well-formed, and words on options that have no effect.
void addSculptVerb(CLI::App& app,
                   std::function<void(const SculptRequest& request, const std::vector<std::string>& idle)> run);
void addInfoVerb(CLI::App& app);
void addConvertVerb(CLI::App& app);
void addGradientVerb(CLI::App& app);
void addFilterVerb(CLI::App& app);
void addRenderVerb(CLI::App& app);
void addCheckVerb(CLI::App& app);
void addBenchVerb(CLI::App& app);
void addStabilityVerb(CLI::App& app);
void addDevicesVerb(CLI::App& app);
void addServeVerb(CLI::App& app);
void addServoVerb(CLI::App& app);
void addCtlVerb(CLI::App& app);
void addTopVerb(CLI::App& app);
void addDoctorVerb(CLI::App& app);
void addCalibrateVerb(CLI::App& app);
void addPlanVerb(CLI::App& app);
void addTuneVerb(CLI::App& app);
void addSceneVerb(CLI::App& app);
void addFaultsVerb(CLI::App& app);
void addHelpVerb(CLI::App& app);
void addCompletionVerb(CLI::App& app);

}  // namespace palpate
