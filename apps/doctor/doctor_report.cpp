// SPDX-License-Identifier: Apache-2.0
#include "apps/doctor/doctor_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/devices/device_table.hpp"
#include "base/json_text.hpp"
#include "servo/devices/force_off.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

const char* wordOf(Finding::State state) {
  switch (state) {
    case Finding::State::kGood:
      return "ok";
    case Finding::State::kNote:
      return "note";
    case Finding::State::kBad:
      return "OFF";
  }
  return "?";
}

Json trialJson(const TrialFigures& trial, bool has_device) {
  Json figures = Json::object();
  for (const DeviceFigure& figure : trial.figures) figures[std::string(figure.key)] = figure.value;
  return {{"rate_hz", trial.rate_hz},
          {"seconds", trial.seconds},
          {"late_p50_us", trial.late_p50_us},
          {"late_p99_us", trial.late_p99_us},
          {"late_max_us", trial.late_max_us},
          {"skipped_share", trial.skipped_share},
          {"fifo", trial.fifo},
          {"memory_locked", trial.memory_locked},
          {"reports_per_s", trial.reports_per_s},
          {"failed_share", trial.failed_share},
          {"motion_m", trial.motion_m},
          {"force_off", has_device ? Json(wordsOf(trial.force_off).name) : Json(nullptr)},
          {"device", figures}};
}

}  // namespace

std::string diagnosisWords(const Diagnosis& diagnosis) {
  std::string text;
  for (const Finding& finding : diagnosis.findings) {
    text += fmt::format("{:<5} {:<14} {}{}{}\n", wordOf(finding.state), finding.topic, finding.text,
                        finding.remedy.empty() ? "" : "; ", finding.remedy);
  }
  return text + fmt::format("\n{}\n", diagnosis.verdict);
}

std::string diagnosisJson(const Diagnosis& diagnosis) {
  Json json = {{"schema", "palpate.doctor/1"},
               {"forces_on", diagnosis.forces_on},
               {"verdict", diagnosis.verdict},
               {"device", diagnosis.device.empty() ? Json(nullptr) : Json(diagnosis.device)},
               {"hid", Json::array()},
               {"findings", Json::array()},
               {"trial", diagnosis.trial ? trialJson(*diagnosis.trial, !diagnosis.device.empty()) : Json(nullptr)}};
  for (const FoundHid& found : diagnosis.hid) {
    json["hid"].push_back({{"path", found.device.path},
                           {"usb", usbText(found.device.vendor, found.device.product)},
                           {"usage", usbText(found.device.usage_page, found.device.usage)},
                           {"name", found.device.name},
                           {"serial", found.device.serial},
                           {"can_be", found.kinds},
                           {"may_use", found.may_use}});
  }
  for (const Finding& finding : diagnosis.findings) {
    json["findings"].push_back({{"state", wordOf(finding.state)},
                                {"topic", finding.topic},
                                {"text", finding.text},
                                {"remedy", finding.remedy}});
  }
  return jsonFileText(json);
}

}  // namespace palpate
