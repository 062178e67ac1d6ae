// SPDX-License-Identifier: Apache-2.0
// apps/bench/filter_bench.hpp: `palpate bench filters`: every filter of the table (engine/filter/filter_spec.hpp) on a
// dense volume, beside ITK, VTK, SciPy and OpenVDB. Rows and rules: field_bench.hpp. One thread. Throws Error as
// FilterChain does, and Error(kCancelled) on Ctrl-C. Memory: 512^3 takes some 6 GiB.
#pragma once

#include <string>
#include <vector>

#include "apps/bench/field_bench.hpp"

namespace palpate {

[[nodiscard]] BenchResult runFilterBench(const FieldBenchRequest& request, Progress& progress);

// What is measured: one job for each filter of the table, with parameters where a size of 1 is not enough.
[[nodiscard]] std::vector<std::string> filterJobs();

[[nodiscard]] std::string filterChart(const BenchResult& result);

}  // namespace palpate
