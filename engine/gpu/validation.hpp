// SPDX-License-Identifier: Apache-2.0
// engine/gpu/validation.hpp: messages of the Khronos validation layer in this process. Any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::gpu {

// Whether the environment variable PALPATE_VALIDATION is set to anything but "0". Then every Gpu is opened with the
// validation layer, whatever its request says.
[[nodiscard]] bool validationWanted();

// All warnings and errors so far, in order. Tests fail if there are any.
[[nodiscard]] std::vector<std::string> validationMessages();
void clearValidationMessages();

}  // namespace palpate::gpu
