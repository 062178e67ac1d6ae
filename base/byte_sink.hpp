// SPDX-License-Identifier: Apache-2.0
// base/byte_sink.hpp: takes the bytes of a file, in order, from the code that writes its format.
//
// A writer knows a format; a sink knows what a file is (temporary, flushed, renamed). So no writer can leave half a
// file. A sink may throw anything.
#pragma once

#include <functional>
#include <string_view>

namespace palpate {

using ByteSink = std::function<void(std::string_view)>;

}  // namespace palpate
