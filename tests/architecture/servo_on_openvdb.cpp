// SPDX-License-Identifier: Apache-2.0
// Must not build: the servo knows no OpenVDB.
#include <openvdb/openvdb.h>

#include "servo/loop/servo_loop.hpp"
