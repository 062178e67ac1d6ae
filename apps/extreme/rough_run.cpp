// SPDX-License-Identifier: Apache-2.0
#include "apps/extreme/rough_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/sampled/window_follower.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/meshes/mesh_object.hpp"

namespace palpate {
namespace {

class HandPath final : public Path {
 public:
  HandPath(const std::function<Vec3(double)>& at_W, double seconds) : at_W_(at_W), seconds_(seconds) {}
  [[nodiscard]] Vec3 position(double time_s) const noexcept override { return at_W_(time_s); }
  [[nodiscard]] double duration_s() const noexcept override { return seconds_; }

 private:
  const std::function<Vec3(double)>& at_W_;
  double seconds_;
};

// Hands everything on to a simulated device, but for what the run has changed.
class RoughDevice final : public Device {
 public:
  RoughDevice(const RoughRun& run, const Path& path) : run_(run), device_(run.device, path, run.loop.rate_hz) {}
  [[nodiscard]] std::string_view name() const noexcept override { return device_.name(); }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return device_.limits(); }
  [[nodiscard]] std::vector<HandParameters> hands() const override { return device_.hands(); }
  void elapse(int ticks) noexcept override { device_.elapse(ticks); }
  [[nodiscard]] bool read(Vec3& position_W) noexcept override {
    Vec3 read_W;
    bool answers = device_.read(read_W);
    if (run_.on_read) answers = run_.on_read(reads_, read_W) && answers;
    ++reads_;
    if (answers) position_W = read_W;
    return answers;
  }
  [[nodiscard]] bool write(const Vec3& force_W) noexcept override {
    const std::int64_t call = writes_++;
    if (run_.on_write && !run_.on_write(call)) return false;
    ++seen_.forces;
    if (!force_W.allFinite()) {
      ++seen_.not_finite;
      return false;
    }
    seen_.largest_N = std::max(seen_.largest_N, force_W.stableNorm());
    seen_.largest_change_N = std::max(seen_.largest_change_N, (force_W - seen_.last_W).stableNorm());
    seen_.last_W = force_W;
    return device_.write(force_W);
  }
  [[nodiscard]] Vec3 held(const Vec3& force_W) const noexcept override {
    return run_.on_held ? run_.on_held(force_W) : device_.held(force_W);
  }
  [[nodiscard]] const Referee& seen() const noexcept { return seen_; }

 private:
  const RoughRun& run_;
  SimulatedDevice device_;
  Referee seen_;
  std::int64_t reads_ = 0, writes_ = 0;
};

// The engine's part: windows around the tool, and their confirmations.
class RoughEngine {
 public:
  RoughEngine(const RoughRun& run, WindowExchange& windows, ToolPoseMailbox& tool)
      : run_(run), windows_(windows), tool_(tool), volume_(run.volume.get()) {}

  void serve(std::int64_t tick, std::int64_t now_ns) {
    places_.push_back(placeOf(tool_.latest()));
    for (; edit_ < run_.edits.size() && run_.edits[edit_].tick <= tick; ++edit_) {
      volume_ = run_.edits[edit_].volume.get();
      rule_ = {};
    }
    const WindowManner& manner = run_.windows;
    if (volume_ == nullptr || tick < manner.first_tick || tick > manner.last_tick) return;
    const std::size_t behind = std::min(places_.size() - 1, static_cast<std::size_t>(manner.late_ticks));
    const Vec3 place_W = places_[places_.size() - 1 - behind];
    auto box = rule_.follow(*volume_, place_W);
    if (box) last_ = *box;
    if (manner.whole) last_ = {Vec3i::Zero(), volume_->size()};
    const bool another = manner.whole ? windows_.nextVersion() == 1 || edit_ != published_edit_ : box.has_value();
    if (another || manner.every_tick) publish(now_ns);
    windows_.confirm(now_ns);
  }

 private:
  static Vec3 placeOf(const ToolPose& pose) { return pose.at_surface ? pose.surface_W : pose.position_W; }
  void publish(std::int64_t now_ns) {
    SampleWindow& window = windows_.back();
    volume_->gather(last_, windows_.backSamples(), window);
    window.edit_version = edit_;
    window.stamp_ns = now_ns;
    if (run_.windows.spoil) run_.windows.spoil(window, windows_.backSamples());
    windows_.publish();
    published_edit_ = edit_;
  }

  const RoughRun& run_;
  WindowExchange& windows_;
  ToolPoseMailbox& tool_;
  const SampledVolume* volume_;
  WindowRule rule_;
  WindowBox last_;
  std::vector<Vec3> places_;
  std::size_t edit_ = 0, published_edit_ = 0;
};

// A clock that wakes when the run says.
class RoughClock final : public ServoClock {
 public:
  RoughClock(const RoughRun& run, RoughEngine& engine) : run_(run), engine_(engine) {}
  [[nodiscard]] std::int64_t now_ns() noexcept override { return now_ns_; }
  void sleepUntil(std::int64_t due_ns) noexcept override {
    now_ns_ = run_.wake_ns(due_ns);
    engine_.serve(calls_++, now_ns_);
  }

 private:
  const RoughRun& run_;
  RoughEngine& engine_;
  std::int64_t now_ns_ = 0, calls_ = 0;
};

std::unique_ptr<Algorithm> algorithmOf(const RoughRun& run, const std::string& name) {
  AlgorithmSetup setup;
  setup.parameters = run.parameters;
  setup.parameters.rate_hz = run.loop.rate_hz;
  setup.effects = makeContactEffects(run.effects, run.parameters.stiffness_N_per_m, run.loop.rate_hz);
  setup.objects = run.objects;
  if (run.volume != nullptr) {
    setup.parameters.isovalue = run.volume->isovalue();
    setup.scale = run.volume->scale();
    if (algorithmEntry(name).needs.isosurface_mesh)
      setup.isosurface = std::make_shared<const MeshObject>(run.volume->isosurface(), "isosurface");
  }
  return makeAlgorithm(name, std::move(setup));
}

// Of the run and all edits, as samples.
std::size_t largestWindow(const RoughRun& run) {
  constexpr std::size_t kLeast = 8;
  const auto samples = [&](const SampledVolume& volume) {
    const Vec3i size = run.windows.whole ? volume.size() : volume.size().cwiseMin(kWindowEdge);
    return static_cast<std::size_t>(size.prod());
  };
  std::size_t largest = run.volume == nullptr ? kLeast : std::max(kLeast, samples(*run.volume));
  for (const RoughRun::Edit& edit : run.edits) largest = std::max(largest, samples(*edit.volume));
  return largest;
}

}  // namespace

std::uint32_t RoughResult::faults() const noexcept {
  std::uint32_t all = 0;
  for (const TickRecord& record : records) all |= record.faults;
  return all;
}

std::int64_t RoughResult::contactTicks() const noexcept {
  return std::ranges::count_if(records, &TickRecord::in_contact);
}

RoughResult play(const RoughRun& run) {
  const HandPath path(run.path_W, run.seconds);
  RoughDevice device(run, path);
  const std::unique_ptr<Algorithm> algorithm = algorithmOf(run, run.algorithm);
  WindowStorage storage(largestWindow(run));
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  ServoChanges changes;
  LoopParameters parameters = run.loop;
  parameters.ticks = std::llround(run.seconds * run.loop.rate_hz);
  ServoLoop loop(parameters, *algorithm, device, windows, tool);
  loop.takeChangesFrom(changes);
  RoughEngine engine(run, windows, tool);
  RoughResult result;
  LoopResult ran;
  if (run.wake_ns) {
    RoughClock clock(run, engine);
    ran = loop.runOn(clock);
  } else {
    auto next = run.changes.begin();
    ran = loop.runSimulated([&](std::int64_t tick, std::int64_t now_ns) {
      engine.serve(tick, now_ns);
      if (next == run.changes.end() || tick < next->tick) return;
      changes.give({.algorithm = algorithmOf(run, next->algorithm)});
      ++next;
    });
  }
  result.records = std::move(ran.records);
  result.referee = device.seen();
  const double device_limit_N = run.device.force_limit_N, device_slew = run.device.slew_limit_N_per_s;
  result.force_limit_N = std::min(run.loop.safety.force_limit_N, device_limit_N);
  const double slew = run.loop.safety.slew_limit_N_per_s;
  result.slew_per_tick_N = (device_slew > 0 ? std::min(slew, device_slew) : slew) / run.loop.rate_hz;
  result.released = ran.released;
  return result;
}

}  // namespace palpate
