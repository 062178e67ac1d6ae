// SPDX-License-Identifier: Apache-2.0
// palpate check gradient|filters|edits VOLUME, palpate check all [VOLUME]: every value of the GPU against the CPU twin;
// the exit status says whether every promise held.
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/bench/bench_result.hpp"
#include "apps/check/check_all.hpp"
#include "apps/check/check_page.hpp"
#include "apps/check/edit_check.hpp"
#include "apps/check/filter_check.hpp"
#include "apps/check/gradient_check.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/filter/filter_job.hpp"
#include "apps/load/load_and_tell.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/json_text.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "verbs.hpp"
#include "version.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

constexpr int kBoundBroken = 1;
constexpr const char* kVolumeHelp = "file, DICOM folder or 'phantom:NAME?size=64'";

struct CheckArguments {
  std::string volume;
  std::string gpu;
  std::string gradient_operator = "central";
  std::string samples = "float";
  std::uint32_t bound_ulp = 0;
  std::string json;
};

// Results go into files of their own: not into the volume, nor both into one. (That they can be written is known by
// now: checkWritable.)
void checkOutputs(const std::string& volume, const std::string& json, const std::string& page = {}) {
  for (const std::string& file : {json, page}) {
    if (!file.empty() && !volume.empty()) checkNotInput(volume, file);
  }
  checkOutputsDiffer({json, page});
}

void printCheck(const CheckArguments& arguments, const Check& check) {
  printResult("gradient of {} on {}: {}, stored as {}\n", arguments.volume, check.device, arguments.gradient_operator,
              arguments.samples);
  printResult("  values compared   {:>14}\n", check.compared);
  printResult("  differing values  {:>14}\n", check.differing);
  printResult("  largest           {:>14} ULP", check.largest_ulp);
  if (check.differing > 0) {
    printResult(" at voxel {},{},{} {}: GPU {:.9g}, CPU {:.9g}", check.voxel.x(), check.voxel.y(), check.voxel.z(),
                check.component, check.gpu_value, check.cpu_value);
  }
  printResult("\n  bound             {:>14} ULP: {}\n", arguments.bound_ulp, check.holds() ? "holds" : "BROKEN");
  printResult("  time              {:>14.3f} s GPU, {:.3f} s CPU twin\n", check.gpu_seconds, check.cpu_seconds);
}

void writeJson(const CheckArguments& arguments, const Check& check) {
  const nlohmann::ordered_json json = {{"check", "gradient"},
                                       {"commit", programCommit()},
                                       {"volume", arguments.volume},
                                       {"vulkan_device", check.device},
                                       {"operator", arguments.gradient_operator},
                                       {"samples", arguments.samples},
                                       {"compared", check.compared},
                                       {"differing", check.differing},
                                       {"largest_ulp", check.largest_ulp},
                                       {"largest_at_voxel", {check.voxel.x(), check.voxel.y(), check.voxel.z()}},
                                       {"largest_component", check.component},
                                       {"bound_ulp", arguments.bound_ulp},
                                       {"holds", check.holds()},
                                       {"gpu_s", check.gpu_seconds},
                                       {"cpu_s", check.cpu_seconds}};
  writeFileAtomically(arguments.json, jsonFileText(json));
}

void checkGradientVerb(const CheckArguments& arguments) {
  checkOutputs(arguments.volume, arguments.json);
  GradientCheckRequest request{arguments.gpu, gradientOperator(arguments.gradient_operator), {}, arguments.bound_ulp};
  Progress progress;
  progress.stage("loading " + arguments.volume);
  const Volume volume = loadAndTell(arguments.volume, progress);
  if (arguments.samples == "half") {
    const auto isovalue = static_cast<float>(defaultIsovalue(volume));
    request.format = halfSamples(isovalue, volume.minimum(), volume.maximum(), volume.lattice().spacing_m);
  }
  progress.stage("comparing");
  const Check check = checkGradient(volume, request, [&](double done) {
    progress.fraction(done);
    throwIfInterrupted("palpate check");
  });
  progress.done();
  if (!arguments.json.empty()) writeJson(arguments, check);
  printCheck(arguments, check);
  if (!check.holds()) throw CLI::RuntimeError(kBoundBroken);
}

// Arguments of the checks that print a table.
struct TableArguments {
  std::string volume;
  std::string gpu;
  std::string filter;
  std::optional<double> isovalue;
  int crop = 0;
  int edits = 100;
  unsigned seed = 1;
  bool quick = false;
  std::string json;
  std::string page;
};

void tell(const TableArguments& arguments, const std::string& name, const std::vector<Check>& checks) {
  if (!arguments.json.empty()) writeFileAtomically(arguments.json, checkJson(checks, name, programCommit()));
  if (!checks.empty()) printResult("{} on {}\n", name, checks[0].device);
  printText(checkTable(checks));
  if (!allHold(checks)) throw CLI::RuntimeError(kBoundBroken);
}

std::function<void(double)> shownIn(Progress& progress) {
  return [&progress](double done) {
    progress.fraction(done);
    throwIfInterrupted("palpate check");
  };
}

Volume loaded(const TableArguments& arguments, Progress& progress) {
  progress.stage("loading " + arguments.volume);
  Volume volume = loadAndTell(arguments.volume, progress);
  throwIfInterrupted("palpate check");
  return arguments.crop > 0 ? cropped(std::move(volume), arguments.crop) : std::move(volume);
}

void checkFiltersVerb(const TableArguments& arguments) {
  checkOutputs(arguments.volume, arguments.json);
  if (arguments.isovalue && !arguments.filter.empty()) {
    checkIsovalueIsUsed(filterChain(arguments.filter), arguments.filter);
  }
  Progress progress;
  const Volume volume = loaded(arguments, progress);
  FilterCheckRequest request;
  request.gpu = arguments.gpu;
  if (!arguments.filter.empty()) request.chains = {arguments.filter};
  if (arguments.isovalue) {
    checkIsovalue(volume, *arguments.isovalue);
    request.isovalue = static_cast<float>(*arguments.isovalue);
  }
  if (request.chains.empty() && volume.minimum() == volume.maximum()) {
    request.chains = checkedFilters(volume);
    dropDistances(request.chains);
    tellUser(arguments.volume + ": distances are left out, since a volume of one density has no surface");
  }
  progress.stage("comparing");
  const std::vector<Check> checks = checkFilters(volume, request, shownIn(progress));
  progress.done();
  tell(arguments, "filters", checks);
}

void checkEditsVerb(const TableArguments& arguments) {
  checkOutputs(arguments.volume, arguments.json);
  Progress progress;
  const Volume volume = loaded(arguments, progress);
  progress.stage("comparing");
  const std::vector<Check> checks = {
      checkEdits(volume, {arguments.gpu, arguments.edits, arguments.seed, arguments.isovalue}, shownIn(progress))};
  progress.done();
  tell(arguments, "edits", checks);
}

// The volume as given; a file without its folder.
std::string allCommand(const TableArguments& arguments) {
  std::string command = "palpate check all";
  if (!arguments.volume.empty()) {
    const bool is_phantom = arguments.volume.starts_with("phantom:");
    command += " " + (is_phantom ? arguments.volume : std::filesystem::path(arguments.volume).filename().string());
  }
  if (arguments.quick) command += " --quick";
  if (arguments.crop > 0) command += fmt::format(" --crop {}", arguments.crop);
  return command + fmt::format(" --seed {}", arguments.seed);
}

void checkAllVerb(const TableArguments& arguments) {
  checkOutputs(arguments.volume, arguments.json, arguments.page);
  Progress progress;
  const CheckAll all = checkAll(
      {arguments.gpu, arguments.volume, arguments.quick, arguments.crop, arguments.seed},
      [&](const std::string& stage) {
        throwIfInterrupted("palpate check");
        progress.stage(stage);
      },
      shownIn(progress), [&](const std::string& name) { return loadAndTell(name, progress); });
  progress.done();
  if (!arguments.page.empty()) {
    const CheckRun run{allCommand(arguments), programCommit(), machineInWords(), all.left_out};
    writeFileAtomically(arguments.page, checkPage(all.checks, run));
  }
  for (const std::string& what : all.left_out) printResult("left out: {}\n", what);
  tell(arguments, "all", all.checks);
}

void addCommonOptions(CLI::App& verb, TableArguments& arguments, const char* crop_default) {
  verb.add_option("--gpu", arguments.gpu, "part of the Vulkan device's name; the best one if not given");
  verb.add_option("--crop", arguments.crop,
                  fmt::format("check only the middle of the volume, "
                              "so many voxels along each side, since twins are slow (default {})",
                              crop_default))
      ->check(CLI::Range(2, 1 << 20));
  verb.add_option("--json", arguments.json, "write the results into this file too")->each(checkWritable);
}

void addGradientCheck(CLI::App& check) {
  CLI::App* gradient = check.add_subcommand("gradient", "every gradient, bit for bit");
  auto arguments = std::make_shared<CheckArguments>();
  gradient->add_option("volume", arguments->volume, kVolumeHelp)->required();
  gradient->add_option("--gpu", arguments->gpu, "part of the Vulkan device's name; the best one if not given");
  gradient->add_option("--operator", arguments->gradient_operator, gradientNames() + " (default central)");
  gradient
      ->add_option("--samples", arguments->samples,
                   "stored as float or half, about the volume's own isovalue (default float)")
      ->check(CLI::IsMember({"float", "half"}));
  gradient->add_option("--bound", arguments->bound_ulp, "largest difference that is accepted [ULP] (default 0)");
  gradient->add_option("--json", arguments->json, "write the result into this file too")->each(checkWritable);
  addVolumeOptions(*gradient, arguments->volume);
  gradient->callback([arguments] { checkGradientVerb(*arguments); });
}

void addFilterCheck(CLI::App& check) {
  CLI::App* filters = check.add_subcommand(
      "filters", "every step of every filter: bit for bit, within derived roundings where there are exponentials");
  auto arguments = std::make_shared<TableArguments>();
  filters->add_option("volume", arguments->volume, kVolumeHelp)->required();
  filters->add_option("--filter", arguments->filter,
                      "this chain instead of a list in which each filter comes twice: \"gaussian:0.8mm median:1\"");
  filters->add_option("--iso", arguments->isovalue, "of distances (default: the volume's own) [density]");
  addCommonOptions(*filters, *arguments, "the whole volume");
  addVolumeOptions(*filters, arguments->volume);
  filters->callback([arguments] { checkFiltersVerb(*arguments); });
}

void addEditCheck(CLI::App& check) {
  CLI::App* edits = check.add_subcommand("edits", "the volume after random edits of every kind, bit for bit");
  auto arguments = std::make_shared<TableArguments>();
  edits->add_option("volume", arguments->volume, kVolumeHelp)->required();
  edits->add_option("--edits", arguments->edits, "how many (default 100)")->check(CLI::Range(1, 100000));
  edits->add_option("--seed", arguments->seed, "of their kinds, places and strengths (default 1)");
  edits->add_option("--iso", arguments->isovalue, "where the object begins (default: the volume's own) [density]");
  addCommonOptions(*edits, *arguments, "the whole volume");
  addVolumeOptions(*edits, arguments->volume);
  edits->callback([arguments] { checkEditsVerb(*arguments); });
}

void addAllChecks(CLI::App& check) {
  CLI::App* all = check.add_subcommand("all", "gradients, filters and edits, on a volume or on a list of them");
  auto arguments = std::make_shared<TableArguments>();
  all->add_option("volume", arguments->volume,
                  fmt::format("{}; "
                              "without it every phantom, random bits, thin volumes, "
                              "and the scans in the folder that PALPATE_DATA names",
                              kVolumeHelp));
  all->add_flag("--quick", arguments->quick, "three small volumes, each filter once");
  all->add_option("--seed", arguments->seed, "of edits (default 1)");
  all->add_option("--page", arguments->page, "write a page (Markdown) too, a row for each filter over all volumes")
      ->each(checkWritable);
  addCommonOptions(*all, *arguments, fmt::format("the whole volume; {} for scans of the list", kScanCrop).c_str());
  addVolumeOptions(*all, arguments->volume);
  all->callback([arguments] { checkAllVerb(*arguments); });
}

}  // namespace

void addCheckVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("check", "compare the GPU with the CPU reference");
  verb->require_subcommand(1);
  addGradientCheck(*verb);
  addFilterCheck(*verb);
  addEditCheck(*verb);
  addAllChecks(*verb);
}

}  // namespace palpate
