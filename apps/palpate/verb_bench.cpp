// SPDX-License-Identifier: Apache-2.0
// palpate bench servo|loop|edit|load|filters|gradient: measures, and holds the figures against what the program
// promises.
#include <filesystem>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/bench_page.hpp"
#include "apps/bench/edit_bench.hpp"
#include "apps/bench/filter_bench.hpp"
#include "apps/bench/gradient_bench.hpp"
#include "apps/bench/load_bench.hpp"
#include "apps/bench/loop_bench.hpp"
#include "apps/bench/servo_bench.hpp"
#include "apps/bench/table_one.hpp"
#include "apps/console/message.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

constexpr int kTargetBroken = 1;

struct BenchArguments {
  bool quick = false, strict = false;
  std::string json, csv, chart, page;
  std::uint64_t seed = 1;
  std::optional<double> seconds;  // loop only
  std::string gpu;                // all but servo and load
  std::vector<int> sizes;         // filters, gradient
};

void addCommon(CLI::App& verb, BenchArguments& arguments) {
  verb.add_flag("--quick", arguments.quick, "fewer repetitions, for a first look");
  verb.add_flag("--strict", arguments.strict, "exit status 1 when a target does not hold");
  verb.add_option("--json", arguments.json, "write rows and targets into this file too")->type_name("FILE");
  verb.add_option("--csv", arguments.csv, "write the rows into this file too")->type_name("FILE");
  verb.add_option("--chart", arguments.chart, "draw the figures into this SVG file")->type_name("FILE.svg");
  verb.add_option("--page", arguments.page, "write a page to read into this Markdown file")->type_name("FILE.md");
  verb.add_option("--seed", arguments.seed, "of everything that is left to chance (default 1)")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9007199254740992}));
}

void addSizes(CLI::App& verb, BenchArguments& arguments) {
  verb.add_option("--sizes", arguments.sizes, "along every edge, with commas [voxel] (default 128,256,512; quick 64)")
      ->delimiter(',')
      ->check(CLI::Range(16, 640));
}

// CLI::Range lets NaN through.
std::string checkSeconds(const std::string& text) {
  constexpr double kLeast_s = 0.1, kMost_s = 3600;
  double value = 0;
  const bool number = CLI::detail::lexical_cast(text, value);
  if (number && value >= kLeast_s && value <= kMost_s) return {};
  return fmt::format("'{}' is no number from {:g} to {:g}", text, kLeast_s, kMost_s);
}

std::string commandLine(const std::string& bench, const BenchArguments& arguments) {
  std::string line = "palpate bench " + bench;
  if (arguments.quick) line += " --quick";
  if (arguments.seconds) line += fmt::format(" --seconds {:g}", *arguments.seconds);
  if (!arguments.sizes.empty()) line += fmt::format(" --sizes {}", fmt::join(arguments.sizes, ","));
  if (!arguments.gpu.empty()) line += " --gpu " + shellWord(arguments.gpu);
  return line + fmt::format(" --seed {}", arguments.seed);
}

// Opened before the bench runs, so that a name that cannot be written is refused in the first second.
class Outputs {
 public:
  explicit Outputs(const BenchArguments& arguments) {
    open(json_, arguments.json);
    open(csv_, arguments.csv);
    open(chart_, arguments.chart);
    open(page_, arguments.page);
  }

  void write(const BenchResult& result, const std::string& chart, const PageWords& words) {
    write(json_, jsonText(result));
    write(csv_, csvText(result));
    write(chart_, chart);
    write(page_, benchPage(result, words));
  }

 private:
  void open(std::optional<AtomicFile>& file, const std::string& name) {
    if (name.empty()) return;
    if (!names_.insert(std::filesystem::absolute(name).lexically_normal()).second) {
      throw Error(Error::Code::kBadInput, name, "it is named for two of the outputs, and the last would be all",
                  "give each a file of its own");
    }
    file.emplace(name);
  }
  static void write(std::optional<AtomicFile>& file, const std::string& text) {
    if (!file) return;
    file->write(text);
    file->commit();
  }
  std::set<std::filesystem::path> names_;
  std::optional<AtomicFile> json_, csv_, chart_, page_;
};

// The chart as seen from the page: by its way from the page's folder.
std::string chartFromPage(const BenchArguments& arguments) {
  if (arguments.chart.empty() || arguments.page.empty()) return {};
  const auto folder = std::filesystem::absolute(arguments.page).parent_path();
  return std::filesystem::absolute(arguments.chart).lexically_relative(folder).generic_string();
}

void conclude(BenchResult& result, const BenchArguments& arguments, PageWords words, const std::string& chart,
              Outputs& outputs) {
  result.commit = programCommit();
  result.command = commandLine(result.bench, arguments);
  words.chart = chartFromPage(arguments);
  outputs.write(result, chart, words);
  printResult("{}\n{}\n{}, commit {}\n{}", words.tables, result.command, result.machine, result.commit,
              targetTable(result));
  if (arguments.strict && !result.allHold()) throw CLI::RuntimeError(kTargetBroken);
}

void servoVerb(const BenchArguments& arguments) {
  Outputs outputs(arguments);
  Progress progress;
  ServoBenchRequest request = arguments.quick ? ServoBenchRequest::quick() : ServoBenchRequest{};
  request.seed = arguments.seed;
  BenchResult result = runServoBench(request, progress);
  progress.done();
  conclude(result, arguments,
           {.title = "What a tick costs and how true it is",
            .introduction = servoIntroduction(),
            .tables = servoTable(result) + "\n" + tableOne(result) + "\n" + tableTrial(result),
            .chart = {}},
           servoChart(result), outputs);
}

void loopVerb(const BenchArguments& arguments) {
  Outputs outputs(arguments);
  Progress progress;
  LoopBenchRequest request = arguments.quick ? LoopBenchRequest::quick() : LoopBenchRequest{};
  request.seed = arguments.seed;
  request.gpu = arguments.gpu;
  if (arguments.seconds) request.seconds = *arguments.seconds;
  BenchResult result = runLoopBench(request, progress);
  progress.done();
  conclude(result, arguments,
           {.title = "How well the loop keeps its times",
            .introduction = loopIntroduction(),
            .tables = loopTable(result),
            .chart = {}},
           loopChart(result), outputs);
}

void editVerb(const BenchArguments& arguments) {
  Outputs outputs(arguments);
  Progress progress;
  EditBenchRequest request = arguments.quick ? EditBenchRequest::quick() : EditBenchRequest{};
  request.seed = arguments.seed;
  request.gpu = arguments.gpu;
  BenchResult result = runEditBench(request, progress);
  progress.done();
  conclude(
      result, arguments,
      {.title = "What an edit costs", .introduction = editIntroduction(), .tables = editTable(result), .chart = {}},
      editChart(result), outputs);
}

void loadVerb(const BenchArguments& arguments) {
  Outputs outputs(arguments);
  Progress progress;
  LoadBenchRequest request = arguments.quick ? LoadBenchRequest::quick() : LoadBenchRequest{};
  request.seed = arguments.seed;
  BenchResult result = runLoadBench(request, progress);
  progress.done();
  conclude(
      result, arguments,
      {.title = "What loading costs", .introduction = loadIntroduction(), .tables = loadTable(result), .chart = {}},
      loadChart(result), outputs);
}

FieldBenchRequest fieldRequest(const BenchArguments& arguments) {
  FieldBenchRequest request = arguments.quick ? FieldBenchRequest::quick() : FieldBenchRequest{};
  request.seed = arguments.seed;
  request.gpu = arguments.gpu;
  if (!arguments.sizes.empty()) request.sizes = arguments.sizes;
  return request;
}

void filtersVerb(const BenchArguments& arguments) {
  Outputs outputs(arguments);
  Progress progress;
  BenchResult result = runFilterBench(fieldRequest(arguments), progress);
  progress.done();
  conclude(
      result, arguments,
      {.title = "What filters cost", .introduction = fieldIntroduction(), .tables = fieldTable(result), .chart = {}},
      filterChart(result), outputs);
}

void gradientVerb(const BenchArguments& arguments) {
  Outputs outputs(arguments);
  Progress progress;
  BenchResult result = runGradientBench(fieldRequest(arguments), progress);
  progress.done();
  conclude(
      result, arguments,
      {.title = "What gradients cost", .introduction = fieldIntroduction(), .tables = fieldTable(result), .chart = {}},
      gradientChart(result), outputs);
}

}  // namespace

void addBenchVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("bench", "measure, and hold the figures against what the program promises");
  verb->require_subcommand(1);
  auto arguments = std::make_shared<BenchArguments>();
  CLI::App* servo =
      verb->add_subcommand("servo", "cost and error of every haptic algorithm (some minutes; --quick: half a minute)");
  addCommon(*servo, *arguments);
  servo->callback([arguments] { servoVerb(*arguments); });
  CLI::App* loop = verb->add_subcommand(
      "loop", "lateness of the real-time loop beside cyclictest's (four minutes; --quick: seconds)");
  addCommon(*loop, *arguments);
  loop->add_option("--seconds", arguments->seconds, "how long each side runs at each rate [s] (default 30; quick 2)")
      ->check(checkSeconds);
  loop->add_option("--gpu", arguments->gpu, "part of the Vulkan device's name; the best one if not given");
  loop->callback([arguments] { loopVerb(*arguments); });
  CLI::App* edit = verb->add_subcommand(
      "edit", "what an edit costs, by stage, brush and volume (a few minutes and 4 GiB; --quick: seconds)");
  addCommon(*edit, *arguments);
  edit->add_option("--gpu", arguments->gpu, "part of the Vulkan device's name; the best one if not given");
  edit->callback([arguments] { editVerb(*arguments); });
  CLI::App* load = verb->add_subcommand(
      "load", "loading beside the format's library alone (minutes, 3 GiB of memory and 0.5 of disk; --quick: seconds)");
  addCommon(*load, *arguments);
  load->callback([arguments] { loadVerb(*arguments); });
  CLI::App* filters = verb->add_subcommand(
      "filters", "every filter beside ITK, VTK, SciPy and OpenVDB (some ten minutes and 6 GiB; --quick: seconds)");
  addCommon(*filters, *arguments);
  filters->add_option("--gpu", arguments->gpu, "part of the Vulkan device's name; the best one if not given");
  addSizes(*filters, *arguments);
  filters->callback([arguments] { filtersVerb(*arguments); });
  CLI::App* gradient = verb->add_subcommand(
      "gradient",
      "every gradient operator beside them, and a CT head's needed bricks (minutes, 9 GiB; --quick: seconds)");
  addCommon(*gradient, *arguments);
  gradient->add_option("--gpu", arguments->gpu, "part of the Vulkan device's name; the best one if not given");
  addSizes(*gradient, *arguments);
  gradient->callback([arguments] { gradientVerb(*arguments); });
}

}  // namespace palpate
