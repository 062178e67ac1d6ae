// SPDX-License-Identifier: Apache-2.0
// engine/gpu/validation.hpp: what the validation layer said in this process. Any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::gpu {

// True where the environment variable PALPATE_VALIDATION is set to anything but "0": then every Gpu is opened with the
// validation layer, whatever its request says.
[[nodiscard]] bool validationWanted();

// Warnings and errors so far, in order. Tests fail if there is any.
[[nodiscard]] std::vector<std::string> validationMessages();
void clearValidationMessages();

}  // namespace palpate::gpu
