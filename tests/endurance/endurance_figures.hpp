// SPDX-License-Identifier: Apache-2.0
// The page and JSON of an endurance test, in the folder that PALPATE_ENDURANCE_RESULTS names; nothing without it.
#pragma once

#include <string>

#include "apps/bench/bench_result.hpp"

namespace palpate {

// A number from the environment.
[[nodiscard]] double numberOf(const char* variable, double usual);

// A result with this machine's facts and the program's commit ("palpate 0.1.0 (0123456789)" is what it says of itself).
[[nodiscard]] BenchResult beginEndurance(const std::string& name, const std::string& version, std::string command);
void writeEndurance(const BenchResult& result, const std::string& title, const std::string& introduction,
                    const std::string& table);

}  // namespace palpate
