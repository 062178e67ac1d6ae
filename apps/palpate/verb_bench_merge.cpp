// SPDX-License-Identifier: Apache-2.0
// palpate bench merge PART.json...: joins the results of the shards of one bench into one.
#include <memory>

#include <fmt/format.h>

#include "apps/bench/result_file.hpp"
#include "base/error.hpp"
#include "bench_outputs.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

struct MergeFlags {
  std::vector<std::string> files;
  BenchOutputFlags outputs;
};

void mergeFiles(const MergeFlags& flags) {
  std::vector<BenchPart> parts;
  for (const std::string& file : flags.files) parts.push_back({file, readBenchResult(file)});
  const Bench& bench = benchNamed(parts.front().result.bench, parts.front().file);
  if (bench.merge == nullptr) {
    refuse(parts.front().file, fmt::format("bench {} is not made of shards", bench.name),
           "give the results of 'palpate bench error --shard I/N --json FILE'");
  }
  BenchOutputs outputs(flags.outputs);
  outputs.finish(bench, bench.merge(parts));
}

}  // namespace

void addBenchMerge(CLI::App& bench) {
  CLI::App* verb = bench.add_subcommand("merge", "join the results of all shards of a bench into one");
  auto flags = std::make_shared<MergeFlags>();
  verb->add_option("PART", flags->files, "a result that 'palpate bench error --shard I/N --json FILE' has written")
      ->required()
      ->check(notEmpty);
  addOutputFlags(*verb, flags->outputs, true);
  verb->callback([flags] { mergeFiles(*flags); });
}

}  // namespace palpate
