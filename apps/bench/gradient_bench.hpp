// SPDX-License-Identifier: Apache-2.0
// apps/bench/gradient_bench.hpp: `palpate bench gradient`: every operator of the table
// (engine/gradient/gradient_operator.hpp) on every brick of a dense volume, and of the bricks that the isosurface of a
// CT head needs, beside ITK, VTK, SciPy and OpenVDB, which know no such bricks. Rows and rules: field_bench.hpp. One
// thread. Throws Error as GradientPass does, and Error(kCancelled) on Ctrl-C. Memory: 512^3 takes some 9 GiB.
#pragma once

#include <string>

#include "apps/bench/field_bench.hpp"

namespace palpate {

// The head: the demo's scan or one of PALPATE_DATA where either is, else a phantom. Left out where sizes are small
// (below 64^3), for tests.
[[nodiscard]] BenchResult runGradientBench(const FieldBenchRequest& request, Progress& progress);

[[nodiscard]] std::string headVolume();  // its name, as loadVolume takes it

[[nodiscard]] std::string gradientChart(const BenchResult& result);

}  // namespace palpate
