// SPDX-License-Identifier: Apache-2.0
// apps/plan/purposes.hpp: for each thing that a run can be found to have (a compute pipeline, a buffer, a thread, a
// library of Palpate) what it is for, in words. Any thread; no cost.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

// Modules that a run may load (base/module.hpp), in alphabetical order.
[[nodiscard]] std::vector<std::string> moduleNames();

// Each takes the name that is counted (docs/summary.md, `work` and `libraries`); "" for one that is not Palpate's own:
// threads of a driver, libraries of the system.
[[nodiscard]] std::string_view kernelPurpose(std::string_view name) noexcept;
[[nodiscard]] std::string_view constantPurpose(std::string_view name) noexcept;  // of a pipeline's specialisation
[[nodiscard]] std::string_view bufferPurpose(std::string_view name) noexcept;
[[nodiscard]] std::string_view threadPurpose(std::string_view name) noexcept;
[[nodiscard]] std::string_view effectPurpose(std::string_view name) noexcept;  // as contactEffectNames() has it
[[nodiscard]] std::string_view modulePurpose(std::string_view name) noexcept;  // without ".so"

}  // namespace palpate
