// SPDX-License-Identifier: Apache-2.0
// base/mapped_libraries.hpp: which shared libraries this process has loaded, as the loader itself counts them. Any
// thread. Cost: some microseconds.
#pragma once

#include <string>
#include <vector>

namespace palpate {

// File names without folders ("libopenvdb.so.10.0", "openvdb.so"), in the order in which they were loaded. Drivers and
// what they need are among them.
[[nodiscard]] std::vector<std::string> mappedLibraries();

}  // namespace palpate
