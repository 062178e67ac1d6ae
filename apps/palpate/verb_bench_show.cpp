// SPDX-License-Identifier: Apache-2.0
// palpate bench show FILE: tables, targets, charts and pages of a result that was measured before.
#include <memory>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>

#include "apps/bench/result_file.hpp"
#include "base/error.hpp"
#include "bench_outputs.hpp"
#include "command_words.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

struct ShowFlags {
  std::string file;
  BenchOutputFlags outputs;
};

void showFile(const ShowFlags& flags) {
  const BenchResult result = readBenchResult(flags.file);
  const Bench& bench = benchNamed(result.bench, flags.file);
  if (!flags.outputs.report.empty() && bench.report == nullptr)
    refuse("--report", fmt::format("bench {} has no report", bench.name), "take --page and --chart");
  BenchOutputs outputs(flags.outputs);
  const auto refuseRows = [&] {
    refuse(flags.file, fmt::format("its rows are not those of bench {} in this version of Palpate", bench.name),
           fmt::format("measure again with 'palpate bench {} --json FILE'", bench.name));
  };
  try {
    outputs.finish(bench, result);
  } catch (const std::out_of_range&) {
    refuseRows();
  } catch (const std::bad_variant_access&) {
    refuseRows();
  }
}

}  // namespace

void addBenchShow(CLI::App& bench) {
  CLI::App* verb = bench.add_subcommand("show", "tables, targets and charts of a result that was measured before");
  auto flags = std::make_shared<ShowFlags>();
  verb->add_option("RESULT", flags->file, "a file that a bench has written with --json")->required()->check(notEmpty);
  addOutputFlags(*verb, flags->outputs, true);
  verb->callback([flags] { showFile(*flags); });
}

}  // namespace palpate
