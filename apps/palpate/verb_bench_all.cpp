// SPDX-License-Identifier: Apache-2.0
// palpate bench all: runs every bench, each in a process of its own, and gathers their targets on one page.
#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/all_benches.hpp"
#include "apps/bench/result_file.hpp"
#include "apps/console/call_program.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/scene/scene_command.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "bench_outputs.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

constexpr int kBenchFailed = 1;
constexpr const char* kAllPage = "all.md";

struct AllFlags {
  bool quick = false, strict = false;
  std::string out = "bench";
  std::string gpu;
  std::vector<std::string> only;
};

std::string allCommand(const AllFlags& flags) {
  std::string line = "palpate bench all";
  if (flags.quick) line += " --quick";
  if (!flags.only.empty()) line += fmt::format(" --bench {}", fmt::join(flags.only, ","));
  if (!flags.gpu.empty()) line += " --gpu " + shellWord(flags.gpu);
  return line;
}

std::vector<const Bench*> wantedBenches(const AllFlags& flags) {
  for (const std::string& name : flags.only) static_cast<void>(benchNamed(name, "--bench " + name));
  std::vector<const Bench*> wanted;
  for (const Bench& bench : everyBench()) {
    if (flags.only.empty() || std::ranges::find(flags.only, bench.name) != flags.only.end()) wanted.push_back(&bench);
  }
  return wanted;
}

void makeFolder(const std::string& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (!failure) return;
  throw Error(Error::Code::kIo, folder, fmt::format("the folder cannot be created ({})", failure.message()),
              "check the name and its permissions, or give another --out");
}

std::vector<std::string> wordsFor(const Bench& bench, const AllFlags& flags, const std::filesystem::path& stem) {
  std::vector<std::string> words = {"bench", bench.name};
  const auto output = [&](const char* flag, const char* ending) {
    words.insert(words.end(), {flag, stem.string() + ending});
  };
  output("--json", ".json");
  output("--csv", ".csv");
  output("--chart", ".svg");
  output("--page", ".md");
  if (bench.report != nullptr) output("--report", ".html");
  if (flags.quick) words.emplace_back("--quick");
  const bool takes_gpu = std::ranges::find(bench.takes, "gpu") != bench.takes.end();
  if (takes_gpu && !flags.gpu.empty()) words.insert(words.end(), {"--gpu", flags.gpu});
  return words;
}

BenchOutcome outcomeOf(const Bench& bench, const AllFlags& flags) {
  const std::filesystem::path stem = std::filesystem::path(flags.out) / bench.name;
  std::filesystem::remove(stem.string() + ".json");  // an older result is none of this run
  const Stopwatch watch;
  BenchOutcome outcome{bench.name, bench.title};
  try {
    outcome.failure = callProgram({.words = wordsFor(bench, flags, stem)}).failure;
    outcome.seconds = watch.seconds();
    if (!outcome.failure.empty()) return outcome;
    outcome.result = readBenchResult(stem.string() + ".json");
    outcome.page = std::string(bench.name) + ".md";
  } catch (const Error& failure) {  // the other benches can still be run
    outcome.failure = failure.what();
  }
  return outcome;
}

void runAll(const AllFlags& flags) {
  const std::vector<const Bench*> wanted = wantedBenches(flags);
  makeFolder(flags.out);
  AtomicFile page(std::filesystem::path(flags.out) / kAllPage);
  const KeptWork kept;  // Ctrl-C ends the bench that runs, and the page holds those before it
  std::vector<BenchOutcome> outcomes;
  for (const Bench* bench : wanted) {
    if (interrupted()) break;
    outcomes.push_back(outcomeOf(*bench, flags));
    printResult("{}\n", outcomeInWords(outcomes.back()));
  }
  page.write(allBenchesPage(outcomes, allCommand(flags)));
  page.commit();
  printResult("{}\n", (std::filesystem::path(flags.out) / kAllPage).string());
  throwIfInterrupted("palpate bench all", "the page holds the benches before that");
  const auto failed = [](const BenchOutcome& outcome) { return !outcome.result.has_value(); };
  const auto broken = [](const BenchOutcome& outcome) { return !outcome.result->allHold(); };
  if (std::ranges::any_of(outcomes, failed)) throw CLI::RuntimeError(kBenchFailed);
  if (flags.strict && std::ranges::any_of(outcomes, broken)) throw CLI::RuntimeError(kBenchFailed);
}

}  // namespace

void addBenchAll(CLI::App& bench) {
  CLI::App* verb = bench.add_subcommand("all", "run every bench and gather their targets on one page");
  auto flags = std::make_shared<AllFlags>();
  verb->add_flag("--quick", flags->quick, "each with fewer repetitions, for a first look");
  verb->add_flag("--strict", flags->strict, "exit status 1 when a target does not hold");
  verb->add_option("--out", flags->out, "folder for all.md and the files of every bench (default bench)")
      ->type_name("FOLDER")
      ->check(notEmpty);
  verb->add_option("--bench", flags->only, "only these benches, with commas")->type_name("NAME")->delimiter(',');
  verb->add_option("--gpu", flags->gpu, "part of the Vulkan device's name; the best one if not given");
  verb->callback([flags] { runAll(*flags); });
}

}  // namespace palpate
