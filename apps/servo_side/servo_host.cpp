// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/servo_host.hpp"

#include <memory>
#include <optional>
#include <utility>

#include "apps/scene/scene_file.hpp"
#include "apps/servo_setup/rig_volume.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/servo_setup/scene_objects.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/servo_side/attachments.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "base/error.hpp"
#include "service/memory/link_memory.hpp"
#include "service/messages/message_channel.hpp"
#include "servo/devices/recording_device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/meshes/mesh_object.hpp"

namespace palpate {
namespace {

constexpr int kLook_ms = 5;  // how long a change may have ended before the engine hears of it

class ServoHost {
 public:
  explicit ServoHost(Channel channel) : channel_(std::move(channel), "the engine") {}

  void run() {
    wire::HelloT hello;
    hello.layout = kLinkLayout;
    channel_.send(std::move(hello));
    while (!ended_) {
      std::optional<MessageChannel::Received> received = channel_.receive(-1);
      if (!received) continue;
      try {
        take(*received);
      } catch (const Error& error) {
        channel_.send(refusalMessage(error));
        throw;
      }
    }
  }

 private:
  void take(MessageChannel::Received& received) {
    if (const auto* const device = contentOf<wire::MakeDeviceT>(received.body)) {
      makeDevice(*device, std::move(received.attached));
    } else if (const auto* const mesh = contentOf<wire::MeshT>(received.body)) {
      takeMesh(*mesh, std::move(received.attached));
    } else if (const auto* const loop = contentOf<wire::MakeLoopT>(received.body)) {
      makeLoop(*loop, std::move(received.attached));
    } else if (contentOf<wire::StartT>(received.body) != nullptr) {
      start();
    } else if (contentOf<wire::StopT>(received.body) != nullptr) {
      ended_ = true;  // before it began
    } else {
      refuseOrder(received.body);
    }
  }

  [[noreturn]] static void refuseOrder(const wire::BodyUnion& body) {
    refuse("the engine", "it sent a message " + kindOf(body) + " where none may be",
           "start programs of the same version of Palpate");
  }

  void makeDevice(const wire::MakeDeviceT& make, Descriptor way) {
    if (device_) refuse("the engine", "it asks for a second device", "start programs of the same version of Palpate");
    readSceneText(make.scene, "the engine's scene", {}, scene_);
    objects_ = makeSceneObjects(scene_.objects);
    const VolumeBox box{.middle_W = vectorOf(make.middle), .half_W = vectorOf(make.half)};
    way_ = std::make_unique<SampledPath>(make.way_points > 0
                                             ? wayOf(std::move(way), make.way_points, make.way_is_linear)
                                             : SampledPath({0}, {box.middle_W}, SampledPath::Interpolation::kLinear));
    SceneDevice made = makeSceneDevice(scene_, *way_, box);
    wire::DeviceMadeT words = wireOf(*made.device);
    if (made.placement) {
      words.is_placed = true;
      words.place_scale = made.placement->scale;
      words.force_scale = made.placement->force_scale;
    }
    if (made.session) {
      words.session_stiffness_N_per_m = made.session->stiffness_N_per_m;
      words.session_damping_Ns_per_m = made.session->damping_Ns_per_m;
    }
    device_ = std::move(made.device);
    constexpr std::uint64_t kMostReads = std::uint64_t{1} << 32U;
    if (make.recorded_reads > kMostReads)
      refuse("the engine", "it asks for too long a recording", "make the run shorter");
    if (make.recorded_reads > 0) {
      auto recorder = std::make_unique<RecordingDevice>(std::move(device_), scene_.rate_hz, make.recorded_reads);
      recorder_ = recorder.get();
      device_ = std::move(recorder);
    }
    channel_.send(std::move(words));
  }

  void takeMesh(const wire::MeshT& mesh, Descriptor memory) {
    if (loop_)
      refuse("the engine", "it sends a mesh where none may be", "start programs of the same version of Palpate");
    volume_.isosurface =
        std::make_shared<const MeshObject>(meshOf(std::move(memory), mesh.vertices, mesh.triangles), "isosurface");
  }

  void makeLoop(const wire::MakeLoopT& make, Descriptor memory) {
    if (!device_ || loop_)
      refuse("the engine", "it asks for a loop where none may be", "start programs of the same version of Palpate");
    volume_.scale = {.contrast = make.contrast, .voxel_m = make.voxel_m};
    volume_.objects = objects_.objects;
    const RigSettings settings = settingsOf(make.settings);
    LoopParameters loop = loopParameters(scene_);
    loop.ticks = make.ticks;
    loop.record_ticks = make.record_ticks;
    loop.safety.force_limit_N = settings.force_limit_N;
    loop.instability.doubtful = make.doubtful;
    memory_.emplace(std::move(memory), make.window_samples);
    windows_.emplace(memory_->windows(), memory_->samples(), memory_->capacity());
    tool_.emplace(memory_->tool());
    algorithm_ = makeAlgorithm(settings, volume_);
    loop_.emplace(loop, *algorithm_, *device_, *windows_, *tool_);
    loop_->takeChangesFrom(changes_);
    channel_.send(wire::LoopMadeT{});
  }

  void start() {
    if (!loop_) refuse("the engine", "it starts what was not made", "start programs of the same version of Palpate");
    tellEnd(scene_.simulated_clock ? runSimulated() : runReal());
    ended_ = true;
  }

  // In step with the engine, whose work before each tick is done when it says so.
  LoopResult runSimulated() {
    return loop_->runSimulated([this](std::int64_t tick, std::int64_t time_ns) {
      noteEnded();
      wire::StepT step;
      step.tick = tick;
      step.time_ns = time_ns;
      step.ended_change = changes_ended_;
      channel_.send(step);
      for (bool go = false; !go;) {
        std::optional<MessageChannel::Received> received = channel_.receive(-1);
        if (!received) continue;
        go = contentOf<wire::GoT>(received->body) != nullptr;
        if (!go) takeWhileRunning(received->body);
      }
    });
  }

  LoopResult runReal() {
    loop_->start();
    try {
      while (loop_->running()) {
        if (std::optional<MessageChannel::Received> received = channel_.receive(kLook_ms))
          takeWhileRunning(received->body);
        if (!noteEnded()) continue;
        wire::ChangeEndedT words;
        words.number = changes_ended_;
        channel_.send(words);
      }
    } catch (...) {
      loop_->requestStop();
      static_cast<void>(loop_->wait());  // the device has its zero
      throw;
    }
    return loop_->wait();
  }

  void takeWhileRunning(wire::BodyUnion& body) {
    if (contentOf<wire::StopT>(body) != nullptr) return loop_->requestStop();
    auto* const change = contentOf<wire::ChangeT>(body);
    if (change == nullptr) refuseOrder(body);
    ServoChange made;
    if (change->settings) made.algorithm = makeAlgorithm(settingsOf(change->settings), volume_);
    if (change->force_limit_N > 0) made.force_limit_N = change->force_limit_N;
    made.doubtful = change->doubtful;
    changes_given_ = changes_.give(std::move(made));
  }

  // Whether a change has ended since the last call. Both sides count changes alike, from 1 on.
  bool noteEnded() noexcept {
    const std::uint64_t before = changes_ended_;
    while (changes_ended_ < changes_given_ && changes_.ended(changes_ended_ + 1)) ++changes_ended_;
    return changes_ended_ != before;
  }

  void tellEnd(LoopResult result) {
    RunRecords records{.ticks = std::move(result.records), .recording = {}};
    if (recorder_ != nullptr) records.recording = recordingBytes(recorder_->recording());
    wire::EndedT words;
    words.records = records.ticks.size();
    words.recording_bytes = records.recording.size();
    words.ticks_run = result.ticks_run;
    words.ticks_skipped = result.ticks_skipped;
    words.released = result.released;
    words.real_time_asked = result.real_time.asked;
    words.fifo = result.real_time.fifo;
    words.memory_locked = result.real_time.memory_locked;
    words.notes = result.real_time.notes;
    words.first_due_ns = result.first_due_ns;
    words.force_off = static_cast<std::uint8_t>(device_->forceOff());
    for (const DeviceFigure& figure : device_->figures()) {
      words.figures.push_back(std::make_unique<wire::FigureT>());
      words.figures.back()->key = figure.key;
      words.figures.back()->value = figure.value;
    }
    const SealedMemory memory = recordsMemory(records);
    channel_.send(std::move(words), memory.descriptor());
  }

  MessageChannel channel_;
  Scene scene_;
  SceneObjects objects_;
  std::unique_ptr<SampledPath> way_;  // leads the device
  std::unique_ptr<Device> device_;
  RecordingDevice* recorder_ = nullptr;  // device_, if the session is recorded
  RigVolume volume_;
  std::optional<LinkMemory> memory_;
  std::optional<WindowExchange> windows_;
  std::optional<ToolPoseMailbox> tool_;
  ServoChanges changes_;
  std::uint64_t changes_given_ = 0, changes_ended_ = 0;
  std::unique_ptr<Algorithm> algorithm_;  // the first one
  std::optional<ServoLoop> loop_;         // uses what stands above
  bool ended_ = false;
};

}  // namespace

void runServoHost(Channel channel) {
  ServoHost(std::move(channel)).run();
}

}  // namespace palpate
