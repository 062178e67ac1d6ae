// SPDX-License-Identifier: Apache-2.0
// Must not build: the servo knows no engine.
#include "engine/service/engine.hpp"
#include "servo/loop/servo_loop.hpp"
