// SPDX-License-Identifier: Apache-2.0
// apps/bench/result_file.hpp: reads the result of a bench as jsonText() writes it. Set-up code; any thread.
#pragma once

#include <filesystem>
#include <string>

#include "apps/bench/bench_result.hpp"

namespace palpate {

// A figure that was not finite is NaN; whether a target holds is found anew. Throws Error: kNotFound, kIo; kBadInput
// for a text that is not of this form, with the place in it.
[[nodiscard]] BenchResult readBenchResult(const std::filesystem::path& file);

// The same from the text of a file, which messages name so.
[[nodiscard]] BenchResult benchResultFrom(const std::string& text, const std::string& name);

}  // namespace palpate
