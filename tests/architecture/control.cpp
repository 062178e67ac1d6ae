// SPDX-License-Identifier: Apache-2.0
// Must build: shows that the other files here fail for their one forbidden line.
#include "engine/gpu/gpu.hpp"
#include "servo/loop/servo_loop.hpp"
