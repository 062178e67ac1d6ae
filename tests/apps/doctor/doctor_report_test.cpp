// SPDX-License-Identifier: Apache-2.0
#include "apps/doctor/doctor_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace palpate {
namespace doctor_report_test {

using Json = nlohmann::json;

Diagnosis sample() {
  Diagnosis d;
  d.hid.push_back({.device = {.path = "/dev/hidraw0",
                              .vendor = 0x1234,
                              .product = 6,
                              .usage_page = 0xFFAB,
                              .usage = 0x200,
                              .name = "Polhem",
                              .serial = "7"},
                   .kinds = {"polhem-v1"},
                   .may_use = true});
  d.findings = {{Finding::State::kGood, "device", "it answers", ""},
                {Finding::State::kNote, "servo", "late", "hurry"},
                {Finding::State::kBad, "HID", "forbidden", "ask"}};
  d.trial = TrialFigures{.rate_hz = 1000,
                         .seconds = 5,
                         .late_p50_us = 1,
                         .late_p99_us = 2,
                         .late_max_us = 3,
                         .skipped_share = 0.25,
                         .fifo = true,
                         .reports_per_s = 900,
                         .failed_share = 0.5,
                         .motion_m = 0.01,
                         .figures = {{"reports_lost", 4}},
                         .force_off = ForceOff::kUncalibrated};
  d.device = "polhem-v1";
  d.verdict = "forces are off because of this; do that";
  return d;
}

TEST(DoctorReport, HasALineForEachFindingAndEndsWithTheVerdict) {
  EXPECT_EQ(diagnosisWords(sample()),
            "ok    device         it answers\n"
            "note  servo          late; hurry\n"
            "OFF   HID            forbidden; ask\n"
            "\n"
            "forces are off because of this; do that\n");
}

TEST(DoctorReport, IsJsonToTheLetter) {
  EXPECT_EQ(Json::parse(diagnosisJson(sample())), Json::parse(R"({
    "schema": "palpate.doctor/1", "forces_on": false, "verdict": "forces are off because of this; do that",
    "device": "polhem-v1",
    "hid": [{"path": "/dev/hidraw0", "usb": "1234:0006", "usage": "ffab:0200", "name": "Polhem", "serial": "7",
             "can_be": ["polhem-v1"], "may_use": true}],
    "findings": [{"state": "ok", "topic": "device", "text": "it answers", "remedy": ""},
                 {"state": "note", "topic": "servo", "text": "late", "remedy": "hurry"},
                 {"state": "OFF", "topic": "HID", "text": "forbidden", "remedy": "ask"}],
    "trial": {"rate_hz": 1000, "seconds": 5, "late_p50_us": 1, "late_p99_us": 2, "late_max_us": 3, "skipped_share": 0.25,
              "fifo": true, "memory_locked": false, "reports_per_s": 900, "failed_share": 0.5, "motion_m": 0.01,
              "force_off": "uncalibrated", "device": {"reports_lost": 4}}})"));
  Diagnosis none;
  const Json json = Json::parse(diagnosisJson(none));
  EXPECT_EQ(json["device"], nullptr);
  EXPECT_EQ(json["trial"], nullptr);
}

}  // namespace doctor_report_test
}  // namespace palpate
