// SPDX-License-Identifier: Apache-2.0
// base/byte_sink.hpp: where writers of files put their bytes, in order. A writer knows a format, a sink knows what a
// file is (temporary, flushed, renamed); so no writer can leave half a file. A sink throws what it likes.
#pragma once

#include <functional>
#include <string_view>

namespace palpate {

using ByteSink = std::function<void(std::string_view)>;

}  // namespace palpate
