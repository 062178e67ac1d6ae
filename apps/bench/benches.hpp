// SPDX-License-Identifier: Apache-2.0
// apps/bench/benches.hpp: the table of benches: the options of each `palpate bench NAME`, what it runs and how it shows
// the result. Any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/bench/bench_result.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/console/progress.hpp"

namespace palpate {

// What a user may ask of a bench.
struct BenchArguments {
  bool quick = false;
  std::uint64_t seed = 1;
  std::optional<double> seconds;     // duration, as Bench::seconds says [s]
  std::string gpu;                   // part of the Vulkan device's name; empty: the best one
  std::vector<int> sizes;            // of volumes, along every edge [voxel]; empty: the bench's own
  std::vector<std::string> studies;  // of the error bench; empty: all
  std::string commit;                // of the program, which must be that of the servo's
  std::string shard;                 // which part of a bench that is made of cells: "2/8"; empty: all of it
};

// A result that was read from a file, for joining.
struct BenchPart {
  std::string file;
  BenchResult result;
};

struct Bench {
  const char* name = "";
  const char* help = "";
  const char* title = "";                   // of the page
  std::string introduction{};               // of the page: what was measured and how, in Markdown
  std::vector<int> sizes{}, quick_sizes{};  // of volumes, along every edge [voxel]; none: the bench has its own volumes
  const char* seconds = "";                 // of what `seconds` is the duration, with its defaults [s]
  std::vector<std::string_view> takes{};    // the members of BenchArguments that it uses, beside quick and seed
  // Returns rows and targets; the caller adds command and commit. Throws Error, with kCancelled on Ctrl-C.
  BenchResult (*run)(const Bench& bench, const BenchArguments& arguments, Progress& progress) = nullptr;
  std::string (*table)(const BenchResult& result) = nullptr;  // for the terminal and the page
  LogCharts (*charts)(const BenchResult& result) = nullptr;   // the figures drawn
  // For a bench that --shard cuts; others have neither.
  std::string (*report)(const BenchResult& result) = nullptr;           // one HTML file
  BenchResult (*merge)(const std::vector<BenchPart>& parts) = nullptr;  // one result of all parts; throws Error
};

// Without those of higher rooms (apps/study/error_bench.hpp), which the verb adds.
[[nodiscard]] const std::vector<Bench>& benches();

}  // namespace palpate
