// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/asked_edits.hpp"

#include <chrono>
#include <utility>

#include "apps/bench/random.hpp"
#include "base/thread_names.hpp"
#include "engine/edit/edit_command.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

constexpr double kLeastBetween_s = 0.015, kMostBetween_s = 0.035;
constexpr std::chrono::microseconds kLookForFirst{500};
constexpr double kEditRadius_voxel = 3, kEditStrength = 0.1;

}  // namespace

AskedEdits::AskedEdits(RigEdits& edits, const Path& way, const Plan& plan)
    : edits_(edits), way_(way), plan_(plan), thread_([this](const std::stop_token& stop) { ask(stop); }) {}

bool AskedEdits::askAt(double way_s) {
  EditCommand command;
  command.kind = asked_.size() % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
  command.from_W = command.to_W = way_.position(way_s);
  command.radius_m = kEditRadius_voxel * plan_.voxel_m;
  command.strength = kEditStrength;
  const std::int64_t now_ns = monotonicNow_ns();
  if (!edits_.edit({command})) return false;
  asked_.push_back({plan_.before + asked_.size() + 1, now_ns});
  return true;
}

void AskedEdits::ask(const std::stop_token& stop) {
  nameThisThread("bench edits");
  if (!askAt(0)) return;
  while (edits_.counts().edits == 0 && !stop.stop_requested()) std::this_thread::sleep_for(kLookForFirst);
  const auto start = std::chrono::steady_clock::now();
  Random random(plan_.seed);
  for (double next_s = plan_.begin_s; next_s < plan_.end_s && !stop.stop_requested();
       next_s += random.uniform(kLeastBetween_s, kMostBetween_s)) {
    std::this_thread::sleep_until(
        start + std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(next_s)));
    if (!askAt(next_s)) return;
  }
}

std::vector<AskedEdit> AskedEdits::take() {
  thread_.request_stop();
  thread_.join();
  if (!asked_.empty()) asked_.erase(asked_.begin());
  return std::move(asked_);
}

}  // namespace palpate
