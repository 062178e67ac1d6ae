// SPDX-License-Identifier: Apache-2.0
// Must not build: the Vulkan room knows no volumes.
#include "engine/gpu/gpu.hpp"
#include "engine/volume/volume.hpp"
