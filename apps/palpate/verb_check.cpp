// SPDX-License-Identifier: Apache-2.0
// palpate check gradient VOLUME: every value of the GPU against the CPU twin; the exit status says whether the bound
// held.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/check/gradient_check.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/console/progress.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/volume/statistics.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

constexpr int kBoundBroken = 1;

struct CheckArguments {
  std::string volume;
  std::string gpu;
  std::string gradient_operator = "central";
  std::string samples = "float";
  std::uint32_t bound_ulp = 0;
  std::string json;
};

void printCheck(const CheckArguments& arguments, const GradientCheck& check) {
  fmt::print("gradient of {} on {}: {}, stored as {}\n", arguments.volume, check.device, arguments.gradient_operator,
             arguments.samples);
  fmt::print("  values compared   {:>14}\n", check.compared);
  fmt::print("  differing values  {:>14}\n", check.differing);
  fmt::print("  largest           {:>14} ULP", check.largest_ulp);
  if (check.differing > 0) {
    fmt::print(" at voxel {},{},{} {}: GPU {:.9g}, CPU {:.9g}", check.voxel.x(), check.voxel.y(), check.voxel.z(),
               check.component, check.gpu_value, check.cpu_value);
  }
  fmt::print("\n  bound             {:>14} ULP: {}\n", arguments.bound_ulp,
             check.largest_ulp <= arguments.bound_ulp ? "holds" : "BROKEN");
  fmt::print("  time              {:>14.3f} s GPU, {:.3f} s CPU twin\n", check.gpu_seconds, check.cpu_seconds);
}

void writeJson(const CheckArguments& arguments, const GradientCheck& check) {
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
                                       {"holds", check.largest_ulp <= arguments.bound_ulp},
                                       {"gpu_s", check.gpu_seconds},
                                       {"cpu_s", check.cpu_seconds}};
  writeFileAtomically(arguments.json, json.dump(2) + "\n");
}

void checkGradientVerb(const CheckArguments& arguments) {
  GradientCheckRequest request{arguments.gpu, gradientOperator(arguments.gradient_operator), {}};
  Progress progress;
  progress.stage("loading " + arguments.volume);
  const Volume volume = loadVolume(arguments.volume);
  if (arguments.samples == "half") {
    const auto isovalue = static_cast<float>(defaultIsovalue(volume));
    request.format = halfSamples(isovalue, volume.minimum(), volume.maximum(), volume.lattice().spacing_m);
  }
  progress.stage("comparing");
  const GradientCheck check = checkGradient(volume, request, [&](double done) {
    progress.fraction(done);
    throwIfInterrupted("palpate check");
  });
  progress.done();
  printCheck(arguments, check);
  if (!arguments.json.empty()) writeJson(arguments, check);
  if (check.largest_ulp > arguments.bound_ulp) throw CLI::RuntimeError(kBoundBroken);
}

}  // namespace

void addCheckVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("check", "compare the GPU with the CPU reference");
  verb->require_subcommand(1);
  CLI::App* gradient = verb->add_subcommand("gradient", "every gradient, bit for bit");
  auto arguments = std::make_shared<CheckArguments>();
  gradient->add_option("volume", arguments->volume, "file, DICOM folder or phantom:NAME?size=64")->required();
  gradient->add_option("--gpu", arguments->gpu, "part of the Vulkan device's name; the best one if not given");
  gradient->add_option("--operator", arguments->gradient_operator, gradientNames() + " (default central)");
  gradient
      ->add_option("--samples", arguments->samples,
                   "stored as float or half, about the volume's own isovalue (default float)")
      ->check(CLI::IsMember({"float", "half"}));
  gradient->add_option("--bound", arguments->bound_ulp, "largest difference that is accepted [ULP] (default 0)");
  gradient->add_option("--json", arguments->json, "write the result into this file too");
  gradient->callback([arguments] { checkGradientVerb(*arguments); });
}

}  // namespace palpate
