// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/remote_servo.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "apps/scene/scene_text.hpp"
#include "apps/servo_side/attachments.hpp"
#include "apps/servo_side/servo_ceilings.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/other_version.hpp"
#include "base/thread_names.hpp"
#include "servo/meshes/mesh_object.hpp"

namespace palpate {
namespace {

constexpr int kStopLook_ms = 50;  // how long a request to stop may go unseen
constexpr int kTickLook_ms = 4;   // between two looks at ticks that are told
constexpr int kGive_ms = 50;      // with a servo that does not read: somebody else is served meanwhile
constexpr int kTick_ms = 60'000;  // between two ticks of the simulated clock, which a debugger may hold up

// What the servo needs of it: not where the volume, its edits and the results lie.
std::string servosScene(Scene scene) {
  for (std::string* const name :
       {&scene.volume, &scene.path_file, &scene.save, &scene.journal, &scene.record, &scene.out})
    name->clear();
  scene.out = Scene{}.out;
  scene.edit = Scene{}.edit;
  std::error_code ignored;
  return sceneText(scene, std::filesystem::current_path(ignored));
}

}  // namespace

// What is known here of a device over there.
class RemoteServo::Proxy final : public Device {
 public:
  explicit Proxy(const wire::DeviceMadeT& made)
      : name_(made.name), limits_(limitsOf(made)), hands_(handsOf(made)), force_off_(forceOffOf(made.force_off)) {}
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return limits_; }
  [[nodiscard]] std::vector<HandParameters> hands() const override { return hands_; }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return force_off_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool read(Vec3&) noexcept override { return false; }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return false; }
  void set(ForceOff why) noexcept { force_off_.store(why, std::memory_order_relaxed); }

 private:
  std::string name_;
  DeviceLimits limits_;
  std::vector<HandParameters> hands_;
  std::atomic<ForceOff> force_off_;
};

namespace {

// A tick has 93 bytes at most, and the header a name and some hands (servo/devices/recording.cpp).
std::uint64_t mostRecordingBytes(std::size_t reads) {
  return 160 * static_cast<std::uint64_t>(reads) + (1U << 20U);
}

}  // namespace

RemoteServo::RemoteServo(Channel channel, const Request& request)
    : channel_(std::move(channel), "the servo"),
      loop_patience_ms_(request.loop_patience_ms),
      end_patience_ms_(request.end_patience_ms),
      memory_({.samples = request.window_samples, .ticks = request.told_ticks}),
      tool_(memory_.tool()),
      aims_(memory_.aims()) {
  const wire::HelloT hello =
      request.hello != nullptr ? *request.hello : channel_.expect<wire::HelloT>(request.patience_ms).first;
  if (hello.layout != kLinkLayout) refuseVersion("it knows another layout of the memory that both share");
  if (hello.commit != request.commit)
    refuseVersion(fmt::format("it was built from {}, this program from {}", hello.commit, request.commit));
  first_version_ = std::max<std::uint64_t>(1, hello.first_version);
  stays_ = hello.stays;
  wire::MakeDeviceT make;
  make.scene = servosScene(request.scene);
  make.middle = wireOf(request.box.middle_W);
  make.half = wireOf(request.box.half_W);
  make.recorded_reads = request.recorded_reads;
  make.pointer_leads = request.pointer != nullptr;
  if (request.pointer != nullptr) make.pointer_start = wireOf(*request.pointer);
  SealedMemory way;
  if (request.way != nullptr) {
    way = wayMemory(*request.way);
    make.way_points = request.way->times_s().size();
    make.way_is_linear = request.way->interpolation() == SampledPath::Interpolation::kLinear;
  }
  if (request.recorded_reads > 0) most_recording_bytes_ = mostRecordingBytes(request.recorded_reads);
  channel_.send(std::move(make), way.descriptor());
  const auto made = channel_.expect<wire::DeviceMadeT>(request.patience_ms).first;
  process_ = channel_.lastSender();
  device_ = std::make_unique<Proxy>(made);
  if (made.is_placed) placed_ = {made.place_scale, made.force_scale};
  if (made.session_stiffness_N_per_m > 0) session_ = {made.session_stiffness_N_per_m, made.session_damping_Ns_per_m};
}

// It is told too: one that stays would take it for an engine that died, and come again at once.
void RemoteServo::refuseVersion(const std::string& reason) {
  const Error error(Error::Code::kBadInput, "the servo", reason, "build all programs from one version");
  try {
    channel_.send(refusalMessage(error));
  } catch (const Error&) {  // it is gone
  }
  throw error;
}

const Device& RemoteServo::device() const noexcept {
  return *device_;
}

// A servo that still runs is waited for, but not without an end (listen()).
RemoteServo::~RemoteServo() {
  requestStop();
}

void RemoteServo::sendMesh(const ContactObject& mesh) {
  const auto* const object = dynamic_cast<const MeshObject*>(&mesh);
  if (object == nullptr) return;
  const SealedMemory memory = meshMemory(object->mesh());
  wire::MeshT words;
  words.vertices = object->mesh().vertices_W.size();
  words.triangles = object->mesh().triangles.size();
  channel_.send(words, memory.descriptor());
}

// The algorithm is made over there; here it has shown that the settings make one.
void RemoteServo::makeLoop(const LoopParameters& loop, const RigSettings& settings, const RigVolume& volume,
                           std::unique_ptr<Algorithm>) {
  if (volume.isosurface) sendMesh(*volume.isosurface);
  wire::MakeLoopT make;
  make.settings = wireOf(settings);
  make.contrast = volume.scale.contrast;
  make.voxel_m = volume.scale.voxel_m;
  make.ticks = loop.ticks;
  make.record_ticks = loop.record_ticks;
  most_records_ =
      static_cast<std::uint64_t>(std::max<std::int64_t>(0, loop.record_ticks < 0 ? loop.ticks : loop.record_ticks));
  make.doubtful = loop.instability.doubtful;
  end_patience_ns_ = endPatience_ns(loop.safety);
  make.window_samples = memory_.capacity();
  make.told_ticks = memory_.tickCapacity();
  channel_.send(std::move(make), memory_.descriptor());
  static_cast<void>(channel_.expect<wire::LoopMadeT>(loop_patience_ms_));
}

// The force fades first. How long that may take by ceilings of the servo's own is not known here.
std::int64_t RemoteServo::endPatience_ns(const SafetyParameters& safety) const {
  constexpr std::int64_t kNanosecondsPerMs = 1'000'000;
  if (end_patience_ms_) return *end_patience_ms_ * kNanosecondsPerMs;
  const double fade_s = longestFade_s(device_->limits(), placed_ ? placed_->force_scale : 1, safety);
  return MessageChannel::kPatience_ms * kNanosecondsPerMs + std::llround(fade_s * 1e9);
}

std::uint64_t RemoteServo::give(ServoChange change, const RigSettings& settings) {
  wire::ChangeT words;
  words.number = given_.load() + 1;
  if (change.algorithm) words.settings = wireOf(settings);
  words.force_limit_N = change.force_limit_N.value_or(0);
  words.doubtful = change.doubtful;
  const std::uint64_t number = words.number;
  const bool is_deaf = is_deaf_.load(std::memory_order_relaxed);
  try {
    channel_.send(std::move(words), -1, is_deaf ? 0 : kGive_ms);
  } catch (const Error&) {
    is_deaf_.store(true, std::memory_order_relaxed);  // a run that goes on ends with it (listen())
    throw;
  }
  given_.store(number);  // one that did not get there is never taken, and so not waited for
  return number;
}

LoopResult RemoteServo::runSimulated(const ServoLoop::Hook& before_tick) {
  channel_.send(wire::StartT{});
  while (true) {
    std::optional<MessageChannel::Received> received = channel_.receive(kTick_ms);
    if (!received)
      throw Error(Error::Code::kDevice, "the servo", "its process does not answer", "end it, and start again");
    if (const auto* const ended = contentOf<wire::EndedT>(received->body)) {
      take(*ended, std::move(received->attached));
      return std::move(result_);
    }
    if (const auto* const step = contentOf<wire::StepT>(received->body)) {
      ended_.store(std::min(step->ended_change, given_.load()), std::memory_order_release);
      if (before_tick) before_tick(step->tick, step->time_ns);
      channel_.send(wire::GoT{});
    }
  }
}

void RemoteServo::start() {
  channel_.send(wire::StartT{});
  running_.store(true, std::memory_order_release);
  listener_ = std::jthread([this] { listen(); });
  nameThread(listener_.native_handle(), "servo link");
}

void RemoteServo::listen() {
  try {
    const int look_ms = ticks_ != nullptr ? kTickLook_ms : kStopLook_ms;
    std::optional<std::int64_t> stopping_since_ns;
    while (running()) {
      std::optional<MessageChannel::Received> received = channel_.receive(look_ms);
      passTicksOn();
      if (is_deaf_.load(std::memory_order_relaxed))
        throw Error(Error::Code::kDevice, "the servo", "it does not take what it is told", "end it, and start again");
      // One that hangs, or talks on, is not waited for without an end.
      const std::int64_t now_ns = monotonicNow_ns();
      if (stop_.load() && !stopping_since_ns) stopping_since_ns = now_ns;
      if (stopping_since_ns && now_ns - *stopping_since_ns > end_patience_ns_)
        throw Error(Error::Code::kDevice, "the servo", "its process does not end", "end it, and start again");
      if (!received) continue;
      if (const auto* const change = contentOf<wire::ChangeEndedT>(received->body)) {
        ended_.store(std::min(change->number, given_.load()), std::memory_order_release);
      } else if (const auto* const state = contentOf<wire::DeviceStateT>(received->body)) {
        device_->set(forceOffOf(state->force_off));
      } else if (const auto* const ended = contentOf<wire::EndedT>(received->body)) {
        take(*ended, std::move(received->attached));
        passTicksOn();
        running_.store(false, std::memory_order_release);
      } else {
        refuseOtherVersion("the servo", fmt::format("it sent a message {} where none may be", kindOf(received->body)));
      }
    }
  } catch (...) {
    failure_ = std::current_exception();
    is_gone_.store(true, std::memory_order_release);
    running_.store(false, std::memory_order_release);
  }
}

LoopResult RemoteServo::wait() {
  if (listener_.joinable()) listener_.join();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::move(result_);
}

void RemoteServo::requestStop() noexcept {
  if (stop_.exchange(true)) return;
  try {
    channel_.send(wire::StopT{}, -1, is_deaf_.load(std::memory_order_relaxed) ? 0 : MessageChannel::kPatience_ms);
  } catch (...) {  // it is gone, and does not run
  }
}

void RemoteServo::leave() noexcept {
  requestStop();
  if (listener_.joinable()) listener_.join();
  channel_.close();
}

void RemoteServo::tellTicksTo(LiveTicks& live) {
  if (memory_.tickCapacity() == 0)
    refuse("the servo", "it was not asked to tell its ticks", "ask for that when it is made");
  told_ticks_.emplace(memory_.ticks(), memory_.tickRing(), memory_.tickCapacity());
  ticks_ = &live;
}

void RemoteServo::passTicksOn() {
  if (ticks_ == nullptr) return;
  taken_.clear();
  told_ticks_->take(taken_);
  for (TickRecord& record : taken_) {
    if (record.tick <= last_told_ || !makeSound(record)) continue;
    last_told_ = record.tick;
    ticks_->add(record);
  }
}

void RemoteServo::take(const wire::EndedT& ended, Descriptor attached) {
  if (ended.records > most_records_) refuseOtherVersion("the servo", "it sends more records than were asked for");
  if (ended.recording_bytes > most_recording_bytes_) {
    refuseOtherVersion("the servo", "it sends a longer recording than was asked for");
  }
  RunRecords records = recordsOf(std::move(attached), ended.records, ended.recording_bytes);
  result_ = {.records = std::move(records.ticks),
             .ticks_run = ended.ticks_run,
             .ticks_skipped = ended.ticks_skipped,
             .released = ended.released,
             .real_time = {.asked = ended.real_time_asked,
                           .fifo = ended.fifo,
                           .memory_locked = ended.memory_locked,
                           .notes = ended.notes},
             .device = device_->limits(),
             .first_due_ns = ended.first_due_ns};
  if (!records.recording.empty()) recording_ = readRecording(records.recording, "the servo's recording");
  if (recording_ && !recording_->damage.empty())
    throw Error(Error::Code::kDevice, "the servo", "it sends a recording that is damaged: " + recording_->damage,
                "run it again; if that goes on, run it without --service");
  for (const auto& figure : ended.figures)
    if (figure) figures_.emplace_back(figure->key, figure->value);
  device_->set(forceOffOf(ended.force_off));
}

}  // namespace palpate
