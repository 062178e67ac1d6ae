// SPDX-License-Identifier: Apache-2.0
// apps/doctor/doctor_report.hpp: a diagnosis in words, and for programs. Any thread.
#pragma once

#include <string>

#include "apps/doctor/diagnosis.hpp"

namespace palpate {

// One line a finding: its state (ok, note, OFF), topic, what was found, what to do; the verdict last.
[[nodiscard]] std::string diagnosisWords(const Diagnosis& diagnosis);
// "palpate.doctor/1".
[[nodiscard]] std::string diagnosisJson(const Diagnosis& diagnosis);

}  // namespace palpate
