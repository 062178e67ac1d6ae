// SPDX-License-Identifier: Apache-2.0
// A made-up run for tests: the tool presses a flat surface z = 0 by 1 mm in the middle of the time. Every field is set.
#pragma once

#include <cmath>
#include <numbers>

#include "apps/report/touch_run.hpp"

namespace palpate {

// One record: the tool at (x, 0, -depth), the surface at z = 0, a spring of 500 N/m.
inline TickRecord pressedTick(std::int64_t tick, double rate_hz, double x_m, double depth_m) {
  TickRecord r;
  r.tick = tick;
  r.time_s = static_cast<double>(tick) / rate_hz;
  r.hip_W[0] = r.vhip_W[0] = x_m;
  r.hip_W[2] = -depth_m;
  r.in_contact = depth_m > 0;
  r.vhip_W[2] = r.in_contact ? 0 : -depth_m;
  if (r.in_contact) r.normal_W[2] = 1;
  if (r.in_contact) r.depth_m = depth_m;
  if (r.in_contact) r.force_W[2] = 500 * depth_m;
  r.density = static_cast<float>(depth_m);
  r.plane_age_ticks = r.in_contact ? static_cast<std::int32_t>(tick % 5) : 0;
  r.window_version = static_cast<std::uint64_t>(tick / 20);
  r.tick_cost_ns = 2000 + static_cast<std::int32_t>(tick * 7919 % 900);
  r.lateness_ns = 30'000 + tick * 104729 % 40'000;
  r.window_age_ns = tick % 20 * 1'000'000;
  r.energy_J = 250 * depth_m * depth_m;
  return r;
}

// Approach for a fifth of the ticks, contact for three fifths, retreat.
inline std::vector<TickRecord> sampleRecords(std::int64_t ticks, double rate_hz) {
  std::vector<TickRecord> records;
  for (std::int64_t i = 0; i < ticks; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(ticks);
    const bool pressed = share >= 0.2 && share < 0.8;
    const double depth_m = pressed ? 1e-3 * std::sin((share - 0.2) / 0.6 * std::numbers::pi) + 1e-6 : -5e-3;
    records.push_back(pressedTick(i, rate_hz, 0.02 * share, depth_m));
  }
  return records;
}

inline TouchRun sampleRun() {
  TouchRun run;
  run.scene.stiffness_N_per_m = stiffnessOf(Scene{});
  run.scene.volume = "phantom:sphere?size=64";
  run.scene.path_toward = Vec3(0, 0, -1);
  run.scene.objects.resize(2);
  run.volume = {"phantom:sphere?size=64", "phantom", Vec3i(64, 64, 64), Vec3::Constant(0.5e-3), -1, 1, 0};
  run.machine = {"Example CPU", 4, 8ULL << 30, "Linux 6.1", "Debian GNU/Linux 12"};
  run.vulkan = {"llvmpipe", "Mesa 22.3", "1.3.230"};
  run.commit = "0123abc";
  run.command = "palpate touch 'phantom:sphere?size=64' --out out";
  run.stages = {{"load", 0.4}, {"gradient", 0.1}};
  run.memory = {{"bricks on the GPU", 3U << 20}};
  run.plan = {"gradient of 120 of 512 bricks: the others hold no surface; saves 3.1 MiB"};
  run.realtime = {"SCHED_FIFO not allowed: raise rtprio in /etc/security/limits.conf"};
  run.start_to_first_tick_s = 0.125;
  run.libraries = {"libc.so.6", "openvdb.so"};
  run.work = {
      .gpu = {.kernels =
                  {{.name = "gradient", .constants = {{"kHalf", 0}, {"kRun", 8}}, .made_s = 0.0125, .dispatches = 3}},
              .buffers = {{.name = "window slot", .count = 3, .bytes = 1572864}},
              .submissions = 7,
              .peak_bytes = 2000000},
      .threads = {"palpate", "engine", "servo"}};
  run.notes = {"the slide is 12 mm instead of 20 mm"};
  run.phases = {{"approach", 0, 1}, {"press", 1, 2}, {"slide", 2, 4}, {"retreat", 4, 5}};
  run.records = sampleRecords(5000, run.scene.rate_hz);
  run.stability = assessContact(run.records, {});
  run.faults = {
      {"stale_window", 12, 300, "the engine published too rarely", "falls to zero", "make the window larger"}};
  run.files = {"out/trace.csv", "out/summary.json"};
  run.edits = RunEdits{3, 2, {1.5, 2.5}, 3, 3, 500, ""};
  run.edits->saves = 2;
  run.edits->save_bytes = 2048;
  run.edits->save_version = 3;
  run.edits->save_s = {0.25, 0.5};
  run.exact = ExactErrors{0.01, 0.05, 0.3, 1.2, 2000, true, 0.02, 0.04};
  run.device = {.kind = "polhem-v1",
                .force_off = "none",
                .figures = {{"reports_written", 1},
                            {"reports_received", 2},
                            {"reports_lost", 3},
                            {"reports_superseded", 4},
                            {"reports_garbled", 5},
                            {"reports_implausible", 6},
                            {"poses_impossible", 18},
                            {"writes_refused", 7},
                            {"commands_too_old", 8},
                            {"disconnects", 9},
                            {"reconnects", 10},
                            {"calibrations", 11},
                            {"calibrations_refused_in_contact", 15},
                            {"calibrations_refused_moving", 16},
                            {"calibrations_refused_away", 17},
                            {"calibrated", 1},
                            {"report_period_us", 1000},
                            {"write_p50_us", 12},
                            {"write_p99_us", 13},
                            {"write_max_us", 14}}};
  return run;
}

// Figures that are all different, and differ from those of the sample run's records.
inline RunFigures sampleFigures() {
  RunFigures f;
  f.ticks = 4993;
  f.time_s = 5;
  f.contact_ticks = 3000;
  f.contact_s = 3;
  f.touches = 2;
  f.first_contact_s = 0;
  f.force_N = {3000, 0.25, 0.3, 0.4, 0.45, 0.5};
  f.depth_m = {2999, 0.5e-3, 0.6e-3, 0.7e-3, 0.8e-3, 1e-3};
  f.force_step_max_N = 0.125;
  f.surface_way_m = 0.02;
  f.tick_cost_us = {4992, 2, 2.5, 3.25, 3.5, 9};
  f.lateness_us = {4991, 40, 50, 60, 65, 70};
  f.window_age_ms = {4990, 10, 15, 20, 21, 22};
  f.plane_age_max_ticks = 6;
  f.late_ticks = 4;
  f.skipped_ticks = 7;
  f.faulty_ticks = 5;
  f.windows_used = 251;
  f.energy_min_J = -1e-5;
  f.energy_end_J = 1.5e-3;
  f.active_ticks = 8;
  return f;
}

// The sample run, edited and quiet, with these figures.
inline TouchRun sampleEditedRun() {
  TouchRun run = sampleRun();
  run.figures = sampleFigures();
  run.stability = {};
  run.stability.verdict = ContactVerdict::kQuiet;
  run.volume.size = Vec3i(64, 65, 66);
  run.volume.spacing_m = Vec3(0.5e-3, 0.75e-3, 1e-3);
  run.volume.isovalue = 0.25;
  run.scene.edit = "remove:radius=2mm";
  run.scene.journal = "kept";
  run.scene.save = "a.vdb";
  run.edits->journal_saved = 2;
  run.edits->journal_failure = "the disk is full";
  run.edits->refused = 1;
  run.edits->save_failures = 4;
  run.edits->save_failure = "it is full too";
  run.edits->content = 0xabc;
  run.edits->added_m3 = 2e-9;
  return run;
}

}  // namespace palpate
