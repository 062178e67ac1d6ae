// SPDX-License-Identifier: Apache-2.0
// apps/console/one_line.hpp: the same as base/one_line.hpp, beside what it is for here.
#pragma once

#include "base/one_line.hpp"
