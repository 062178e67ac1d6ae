// SPDX-License-Identifier: Apache-2.0
// Must not build: the servo knows no Vulkan.
#include <vulkan/vulkan.h>

#include "servo/loop/servo_loop.hpp"
