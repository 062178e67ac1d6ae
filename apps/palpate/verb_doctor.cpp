// SPDX-License-Identifier: Apache-2.0
// palpate doctor: what is here, what is missing for forces, and what to do about it.
#include <memory>

#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/devices/device_table.hpp"
#include "apps/doctor/doctor_report.hpp"
#include "apps/doctor/udev_rules.hpp"
#include "base/atomic_file.hpp"
#include "device_arguments.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

constexpr int kForcesOff = 1;

struct DoctorArguments {
  DoctorRequest request;
  std::string json;
  bool installs_udev = false, shows_udev = false;
};

void examine(const DoctorArguments& arguments) {
  if (arguments.shows_udev) {
    printText(udevRules(knownDeviceKinds()));
    return;
  }
  if (arguments.installs_udev) {
    installUdevRules(kUdevRulesFile, udevRules(knownDeviceKinds()));
    printResult("wrote {}; plug the devices in again\n", kUdevRulesFile);
    return;
  }
  std::unique_ptr<AtomicFile> file;
  if (!arguments.json.empty()) file = std::make_unique<AtomicFile>(arguments.json);
  Progress progress;
  const Diagnosis diagnosis = diagnose(arguments.request, progress);
  printText(diagnosisWords(diagnosis));
  if (file) {
    file->write(diagnosisJson(diagnosis));
    file->commit();
  }
  if (!diagnosis.forces_on) throw CLI::RuntimeError(kForcesOff);
}

}  // namespace

void addDoctorVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("doctor", "find out why a device is not found, or exerts no force");
  verb->footer(
      "Ends with \"forces are on\" (exit status 0) or \"forces are off because ...\" (1).\n"
      "Example: palpate doctor --device polhem-v1 --current-limit 3");
  auto arguments = std::make_shared<DoctorArguments>();
  DoctorRequest& r = arguments->request;
  addDeviceFlags(*verb, {.device = r.device, .path = r.device_path, .by_libusb = r.by_libusb});
  verb->get_option("--device-path")->needs("--device");
  verb->add_option("--current-limit", r.current_limit_A, "what the amplifiers of its firmware bear [A]")
      ->check(numberFrom(0.01, 20));
  verb->add_flag("--calibrated", r.calibrated, "it was calibrated since it was switched on, by another program");
  verb->add_option("--rate", r.rate_hz, "of the servo in the trial [Hz] (default 1000)")->check(numberFrom(10, 20000));
  verb->add_option("--seconds", r.trial_s, "how long the trial takes [s] (default 5)")->check(numberFrom(0.1, 600));
  verb->add_flag("--install-udev", arguments->installs_udev,
                 fmt::format("write {}, which lets users at the machine use the devices", kUdevRulesFile));
  verb->add_flag("--udev-rules", arguments->shows_udev, "print what it would write, and do nothing else");
  verb->add_option("--json", arguments->json, "write it into this file too")->type_name("FILE")->check(notEmpty);
  verb->callback([arguments] { examine(*arguments); });
}

}  // namespace palpate
