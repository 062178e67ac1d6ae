// SPDX-License-Identifier: Apache-2.0
// apps/bench/benches.hpp: every bench as data: what `palpate bench NAME` takes, runs and shows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

// What a user may ask of a bench.
struct BenchArguments {
  bool quick = false;
  std::uint64_t seed = 1;
  std::optional<double> seconds;  // of the loop
  std::string gpu;                // part of the Vulkan device's name
  std::vector<int> sizes;         // along every edge [voxel]; none: the bench's own
};

struct Bench {
  const char* name = "";
  const char* help = "";
  const char* title = "";                   // of the page
  const char* introduction = "";            // what was measured and how, for the page
  std::vector<int> sizes{}, quick_sizes{};  // of volumes, along every edge [voxel]; none: the bench has its own volumes
  std::vector<std::string_view> takes{};    // of BenchArguments, beside quick and seed
  // Fills rows and targets; the command and the commit are the caller's. Throws Error, kCancelled on Ctrl-C.
  BenchResult (*run)(const Bench& bench, const BenchArguments& arguments, Progress& progress) = nullptr;
  std::string (*table)(const BenchResult& result) = nullptr;  // for the terminal and the page
  std::string (*chart)(const BenchResult& result) = nullptr;  // an SVG file
};

[[nodiscard]] const std::vector<Bench>& benches();

}  // namespace palpate
