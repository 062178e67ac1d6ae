// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/service_run.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <sys/mman.h>

#include "apps/bench/asked_edits.hpp"
#include "apps/bench/contact_path.hpp"
#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/held/placement_choice.hpp"
#include "apps/touch/touch_servo.hpp"
#include "base/error.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/phantoms/phantom.hpp"

namespace palpate {
namespace {

constexpr const char* kServiceRun = "palpate bench service";
constexpr double kServiceSpeed_m_per_s = 0.1;
constexpr double kUnasked_s = 0.2;  // at the end, so that the last edits still come into a window
constexpr std::array kAskedKinds = {EditKind::kAdd, EditKind::kRemove};

SampledPath wayOver(const Phantom& phantom, double seconds, double rate_hz, std::uint64_t seed) {
  ContactPath path = contactPath(phantom, {.speed_m_per_s = kServiceSpeed_m_per_s,
                                           .rate_hz = rate_hz,
                                           .ticks = static_cast<std::size_t>(std::lround(seconds * rate_hz)),
                                           .seed = seed});
  std::vector<double> times_s;
  for (std::size_t k = 0; k < path.ticks(); ++k) times_s.push_back(static_cast<double>(k) / rate_hz);
  return {std::move(times_s), std::move(path.hip_W), SampledPath::Interpolation::kLinear};
}

}  // namespace

const char* wordFor(Processes processes) noexcept {
  return processes == Processes::kOne ? "one" : "two";
}

ServiceRuns::ServiceRuns(const std::string& volume, double seconds, std::uint64_t seed, const std::string& gpu,
                         std::string commit)
    : seed_(seed), commit_(std::move(commit)) {
  const std::unique_ptr<Phantom> phantom = makePhantom(volume);
  volume_.emplace(makeVolume(*phantom));
  isovalue_ = phantom->isovalue();
  scene_.volume = volume;
  scene_.isovalue = isovalue_;
  scene_.duration_s = seconds;
  scene_.gpu = gpu;
  scene_.picture = false;
  way_.emplace(wayOver(*phantom, seconds, scene_.rate_hz, seed));
}

ServiceRun ServiceRuns::run(Processes processes) {
  throwIfInterrupted(kServiceRun);
  munlockall();  // a servo in this process has locked what there was then, and the next run shall begin as the first
  Scene scene = scene_;
  scene.service = processes == Processes::kTwo;
  TouchServo servo;  // outlives the engine, which may write to its memory
  Engine engine(*volume_, makePlan({.edits = true, .gradients_as_needed = true}), isovalue_, scene.gpu);
  vulkan_device_ = fmt::format("{}, {}", engine.gpu().name, engine.gpu().driver);
  EditSession session(engine, brushProfile(*volume_, isovalue_), kAskedKinds, 0);
  RigEdits edits(session, volume_->size(), volume_->lattice(), tellUser);
  servo.make(scene,
             {.path = *way_,
              .box = boxOf(volume_->lattice(), volume_->size()),
              .isovalue = isovalue_,
              .asked = scene_,
              .commit = commit_},
             engine);
  const RigVolume touched = {.scale = densityScaleOf(*volume_, engine.isovalue())};
  Progress silent(nullptr);
  std::optional<AskedEdits> asked;
  ServiceRun run;
  run.loop = servo
                 .run(scene, touched, engine, &edits, silent,
                      [&](const std::vector<std::string>&) {
                        asked.emplace(edits, *way_,
                                      AskedEdits::Plan{.end_s = scene.duration_s - kUnasked_s,
                                                       .voxel_m = volume_->lattice().smallestSpacing(),
                                                       .before = engine.editVersion(),
                                                       .seed = seed_});
                      })
                 .loop;
  run.asked = asked->take();
  static_cast<void>(servo.letGo());
  throwIfInterrupted(kServiceRun);
  if (edits.counts().refused == 0 && edits.counts().editing) return run;
  throw Error(Error::Code::kDevice, kServiceRun, "an edit was refused in the run", "see the message above");
}

}  // namespace palpate
