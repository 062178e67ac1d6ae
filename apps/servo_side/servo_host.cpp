// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/servo_host.hpp"

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "apps/scene/scene_file.hpp"
#include "apps/servo_setup/rig_volume.hpp"
#include "apps/servo_setup/scene_device.hpp"
#include "apps/servo_setup/scene_objects.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/servo_side/attachments.hpp"
#include "apps/servo_side/stale_watch.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "base/other_version.hpp"
#include "service/memory/link_memory.hpp"
#include "service/messages/message_channel.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/devices/recording_device.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr int kLook_ms = 5;  // how long a change may have ended before the engine hears of it
constexpr std::uint64_t kVersionsOfAnEngine = std::uint64_t{1} << 40U;  // windows of 35 years

}  // namespace

class ServoHost::Impl {
 public:
  Impl(bool stays, std::string commit, Tell tell, ServoCeilings ceilings)
      : stays_(stays), commit_(std::move(commit)), tell_(std::move(tell)), ceilings_(ceilings) {}
  ~Impl() { stopLoop(); }

  [[nodiscard]] std::uint64_t firstVersion() const noexcept { return engines_ * kVersionsOfAnEngine + 1; }

  void serve(Channel channel, const std::function<bool()>& stopped, bool is_greeted) {
    if (!is_greeted && !channel.send(greeting(commit_, firstVersion(), stays_), MessageChannel::kPatience_ms))
      channel.close();  // it is gone, which is told below
    ++engines_;
    channel_.emplace(std::move(channel), "the engine");
    ended_ = is_shared_ = false;
    stale_.beginAnew();
    try {
      while (!ended_ && !stopped()) listen();
    } catch (...) {
      leaveEngine();
      throw;
    }
    leaveEngine();
  }

 private:
  // A servo's ends of what it shares with one engine.
  struct EngineEnd {
    EngineEnd(Descriptor given, const LinkMemory::Room& room)
        : memory(std::move(given), room),
          windows(memory.windows(), memory.samples(), memory.capacity()),
          tool(memory.tool()) {
      if (room.ticks > 0) ticks.emplace(memory.ticks(), memory.tickRing(), room.ticks);
    }
    LinkMemory memory;
    WindowExchange windows;
    ToolPoseMailbox tool;
    std::optional<LiveTicks> ticks;
  };

  // Also looks for what ended without a message.
  void listen() {
    if (std::optional<MessageChannel::Received> received = channel_->receive(kLook_ms)) {
      try {
        take(*received);
      } catch (const Error& error) {
        channel_->send(refusalMessage(error));
        throw;
      } catch (const std::exception& failure) {  // no memory for what was asked for
        const Error error(Error::Code::kOutOfMemory, "the servo",
                          fmt::format("what was asked for cannot be made ({})", failure.what()),
                          "end other programs, or make it smaller");
        channel_->send(refusalMessage(error));
        throw error;
      }
    }
    if (!loop_ || !started_ || ended_) return;
    takeLinked();
    if (is_shared_) tellForceOff();
    if (is_shared_ && stays_ && tell_) tellStale();
    if (noteEnded() && is_shared_ && changes_ended_ > changes_before_) {
      wire::ChangeEndedT words;
      words.number = changes_ended_ - changes_before_;
      channel_->send(words);
    }
    if (loop_->running()) return;
    started_ = false;
    tellEnd(loop_->wait());
  }

  void tellForceOff() {
    const ForceOff now = device_->forceOff();
    if (std::exchange(told_force_off_, now) == now) return;
    wire::DeviceStateT words;
    words.force_off = static_cast<std::uint8_t>(now);
    channel_->send(words);
  }

  void tellStale() {
    const bool is_stale = has(loop_->newestFaults(), ServoFault::kStaleWindow);
    if (const std::string words = stale_.look(is_stale, monotonicNow_ns()); !words.empty()) tell_(words);
  }

  // A servo that does not stay brings its force to zero and ends with its engine.
  void leaveEngine() {
    if (next_) {
      links_->withdraw();
      awaitLink([](ServoLinks::State state) { return state == ServoLinks::State::kNone; });
    }
    if (!stays_) stopLoop();
    channel_->close();
  }

  void stopLoop() {
    if (loop_ && started_) {
      loop_->requestStop();
      static_cast<void>(loop_->wait());  // the device has its zero
    }
    started_ = false;
    loop_.reset();
    next_.reset();
    end_.reset();
  }

  void take(MessageChannel::Received& received) {
    if (is_shared_) return takeWhileRunning(received.body);
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
    refuseOtherVersion("the engine", "it sent a message " + kindOf(body) + " where none may be");
  }

  void makeDevice(const wire::MakeDeviceT& make, Descriptor way) {
    const VolumeBox box{.middle_W = vectorOf(make.middle), .half_W = vectorOf(make.half)};
    SampledPath path = make.way_points > 0 ? wayOf(std::move(way), make.way_points, make.way_is_linear)
                                           : SampledPath({0}, {box.middle_W}, SampledPath::Interpolation::kLinear);
    if (device_ && !stays_) refuseOtherVersion("the engine", "it asks for a second device");
    if (!device_ || !isSame(make, path)) {
      stopLoop();  // another scene: its device begins anew
      recorder_ = nullptr;
      device_.reset();
      made_for_ = {make.scene, box, make.recorded_reads};
      way_ = std::make_unique<SampledPath>(std::move(path));
      pointer_.reset();
      if (make.pointer_leads)
        pointer_ = make.way_points > 0 ? std::make_unique<PointerPath>(*way_)
                                       : std::make_unique<PointerPath>(vectorOf(make.pointer_start));
      makeDeviceFor(make, box);
    }
    wire::DeviceMadeT words = wireOf(*device_);
    told_force_off_ = forceOffOf(words.force_off);
    if (placement_) {
      words.is_placed = true;
      words.place_scale = placement_->scale;
      words.force_scale = placement_->force_scale;
    }
    if (session_) {
      words.session_stiffness_N_per_m = session_->stiffness_N_per_m;
      words.session_damping_Ns_per_m = session_->damping_Ns_per_m;
    }
    channel_->send(std::move(words));
  }

  // A device that a running loop has is kept for the same scene.
  [[nodiscard]] bool isSame(const wire::MakeDeviceT& make, const SampledPath& path) const {
    return make.scene == made_for_.scene && vectorOf(make.middle) == made_for_.box.middle_W &&
           vectorOf(make.half) == made_for_.box.half_W && make.recorded_reads == made_for_.recorded_reads &&
           path.times_s() == way_->times_s() && path.points_W() == way_->points_W() &&
           path.interpolation() == way_->interpolation() && make.pointer_leads == (pointer_ != nullptr);
  }

  void makeDeviceFor(const wire::MakeDeviceT& make, const VolumeBox& box) {
    scene_ = Scene{};
    readSceneText(make.scene, "the engine's scene", {}, scene_);
    told_clipped_.clear();
    scene_ = within(ceilings_, std::move(scene_), [this](const std::string& words) { tellClipped(words); });
    if (stays_ && scene_.simulated_clock)
      refuse("--clock simulated", "a servo that stays runs by the real clock", "leave it out");
    objects_ = makeSceneObjects(scene_.objects);
    const Path& leads = pointer_ ? static_cast<const Path&>(*pointer_) : *way_;
    SceneDevice made = makeSceneDevice(scene_, leads, box);
    placement_ = made.placement;
    session_ = made.session;
    device_ = std::move(made.device);
    constexpr std::uint64_t kMostReads = std::uint64_t{1} << 32U;
    if (make.recorded_reads > kMostReads || (stays_ && make.recorded_reads > 0))
      refuse("the engine", "it asks for a recording that cannot be",
             "make the run shorter, or let the servo end with it");
    if (make.recorded_reads > 0) {
      auto recorder = std::make_unique<RecordingDevice>(std::move(device_), scene_.rate_hz, make.recorded_reads);
      recorder_ = recorder.get();
      device_ = std::move(recorder);
    }
  }

  void takeMesh(const wire::MeshT& mesh, Descriptor memory) {
    if (loop_ && !stays_) refuseOtherVersion("the engine", "it sends a mesh where none may be");
    volume_.isosurface =
        std::make_shared<const MeshObject>(meshOf(std::move(memory), mesh.vertices, mesh.triangles), "isosurface");
  }

  void makeLoop(const wire::MakeLoopT& make, Descriptor memory) {
    if (!device_ || (loop_ && !stays_) || next_)
      refuseOtherVersion("the engine", "it asks for a loop where none may be");
    volume_.scale = {.contrast = make.contrast, .voxel_m = make.voxel_m};
    volume_.objects = objects_.objects;
    RigSettings settings = settingsOf(make.settings);
    settings.force_limit_N = mayBe(settings.force_limit_N);
    checkSetting(settings.force_limit_N > 0 && std::isfinite(settings.force_limit_N), "force limit",
                 settings.force_limit_N, "give newtons above 0");
    constexpr std::int64_t kMostTicks = std::int64_t{1} << 32U;
    if (make.record_ticks > kMostTicks || make.ticks > kMostTicks || (stays_ && make.ticks != 0))
      refuse("the engine", "it asks for a run of another length than can be", "make the run shorter");
    auto end = std::make_unique<EngineEnd>(std::move(memory),
                                           LinkMemory::Room{.samples = make.window_samples, .ticks = make.told_ticks});
    std::unique_ptr<Algorithm> algorithm = makeAlgorithm(settings, volume_);
    if (loop_ && loop_->running()) {
      linkTo(std::move(end), std::move(algorithm), settings.force_limit_N, make.doubtful);
    } else {
      stopLoop();
      LoopParameters loop = loopParameters(scene_);
      loop.ticks = make.ticks;
      loop.record_ticks = make.record_ticks;
      loop.safety.force_limit_N = settings.force_limit_N;
      loop.instability.doubtful = make.doubtful;
      end_ = std::move(end);
      algorithm_ = std::move(algorithm);
      changes_.emplace();
      changes_given_ = changes_ended_ = 0;
      links_.emplace();
      if (pointer_) pointer_->follow(end_->memory.aims());
      loop_.emplace(loop, *algorithm_, *device_, end_->windows, end_->tool);
      if (end_->ticks) loop_->tellTicksTo(*end_->ticks);
      loop_->takeChangesFrom(*changes_);
      loop_->takeLinksFrom(*links_);
    }
    changes_before_ = changes_given_;
    channel_->send(wire::LoopMadeT{});
  }

  [[nodiscard]] double mayBe(double force_limit_N) {
    return forceWithin(ceilings_, scene_, force_limit_N, [this](const std::string& words) { tellClipped(words); });
  }

  // The same words once for a device.
  void tellClipped(const std::string& words) {
    if (tell_ && told_clipped_.insert(words).second) tell_(words);
  }

  // The running loop tells its pose to the new engine, and goes over to its windows when there is one.
  void linkTo(std::unique_ptr<EngineEnd> end, std::unique_ptr<Algorithm> algorithm, double force_limit_N,
              bool doubtful) {
    next_ = std::move(end);
    link_ = {.windows = &next_->windows,
             .tool = &next_->tool,
             .algorithm = std::move(algorithm),
             .force_limit_N = force_limit_N,
             .doubtful = doubtful,
             .ticks = next_->ticks ? &*next_->ticks : nullptr};
    changes_->withdraw();  // the former engine's
    links_->give(link_);
    awaitLink([](ServoLinks::State state) { return state != ServoLinks::State::kGiven; });
  }

  // Some ticks; a loop that has ended answers nothing.
  void awaitLink(const std::function<bool(ServoLinks::State)>& is_enough) {
    while (loop_->running() && !is_enough(links_->state()) && links_->state() != ServoLinks::State::kDone)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    takeLinked();
  }

  // Once the loop has gone over nothing uses the former engine's memory.
  void takeLinked() {
    if (!next_) return;
    const ServoLinks::State state = links_->state();
    if (state != ServoLinks::State::kDone && state != ServoLinks::State::kNone) return;
    if (state == ServoLinks::State::kDone) {
      if (pointer_) pointer_->follow(next_->memory.aims());
      while (pointer_ && loop_->running() && !pointer_->hasFollowed())  // a tick
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      end_ = std::move(next_);
    }
    next_.reset();
    link_ = {};
  }

  void start() {
    if (!loop_) refuseOtherVersion("the engine", "it starts what was not made");
    if (scene_.simulated_clock) return tellEnd(runSimulated());
    if (!started_) {
      loop_->start();
      if (stays_ && tell_) {
        tell_(fmt::format("the device {} touches the engine's volume", device_->name()));
        for (const std::string& note : loop_->realTime().notes) tell_(note);
      }
    }
    started_ = is_shared_ = true;
  }

  // In step with the engine, whose work before each tick is done when it says so.
  LoopResult runSimulated() {
    return loop_->runSimulated([this](std::int64_t tick, std::int64_t time_ns) {
      noteEnded();
      wire::StepT step;
      step.tick = tick;
      step.time_ns = time_ns;
      step.ended_change = changes_ended_ - changes_before_;
      channel_->send(step);
      for (bool go = false; !go;) {
        std::optional<MessageChannel::Received> received = channel_->receive(-1);
        if (!received) continue;
        go = contentOf<wire::GoT>(received->body) != nullptr;
        if (!go) takeWhileRunning(received->body);
      }
    });
  }

  void takeWhileRunning(wire::BodyUnion& body) {
    if (contentOf<wire::StopT>(body) != nullptr) return stays_ ? tellEnd({}) : loop_->requestStop();
    auto* const change = contentOf<wire::ChangeT>(body);
    if (change == nullptr) refuseOrder(body);
    ServoChange made;
    if (change->settings) made.algorithm = makeAlgorithm(settingsOf(change->settings), volume_);
    if (change->force_limit_N > 0) made.force_limit_N = mayBe(change->force_limit_N);
    made.doubtful = change->doubtful;
    changes_given_ = changes_->give(std::move(made));
  }

  // Whether a change has ended since the last call. Both sides count changes alike, from 1 on.
  bool noteEnded() noexcept {
    const std::uint64_t before = changes_ended_;
    while (changes_ended_ < changes_given_ && changes_->ended(changes_ended_ + 1)) ++changes_ended_;
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
    channel_->send(std::move(words), memory.descriptor());
    ended_ = true;
  }

  // What the device was made for.
  struct MadeFor {
    std::string scene;
    VolumeBox box;
    std::uint64_t recorded_reads = 0;
  };

  const bool stays_;
  const std::string commit_;
  const Tell tell_;
  const ServoCeilings ceilings_;
  std::set<std::string> told_clipped_;
  std::optional<MessageChannel> channel_;  // to the present engine
  std::uint64_t engines_ = 0;              // that it has spoken with
  MadeFor made_for_;
  Scene scene_;
  SceneObjects objects_;
  std::unique_ptr<SampledPath> way_;      // leads the device
  std::unique_ptr<PointerPath> pointer_;  // or this does
  ForceOff told_force_off_ = ForceOff::kNone;
  StaleWatch stale_;
  std::unique_ptr<Device> device_;
  std::optional<Placement> placement_;
  std::optional<RecordedContact> session_;
  RecordingDevice* recorder_ = nullptr;  // device_, if the session is recorded
  RigVolume volume_;
  std::unique_ptr<EngineEnd> end_, next_;  // that the loop reads; that it is to go over to
  ServoLink link_;                         // to the next
  std::optional<ServoLinks> links_;
  std::optional<ServoChanges> changes_;
  std::uint64_t changes_given_ = 0, changes_ended_ = 0;  // in all
  std::uint64_t changes_before_ = 0;                     // that former engines gave
  std::unique_ptr<Algorithm> algorithm_;                 // the first one
  std::optional<ServoLoop> loop_;                        // uses what stands above
  bool started_ = false, is_shared_ = false, ended_ = false;
};

ServoHost::ServoHost(bool stays, std::string commit, Tell tell, ServoCeilings ceilings)
    : impl_(std::make_unique<Impl>(stays, std::move(commit), std::move(tell), ceilings)) {}
ServoHost::~ServoHost() = default;

std::uint64_t ServoHost::firstVersion() const {
  return impl_->firstVersion();
}

void ServoHost::serve(Channel channel, const std::function<bool()>& stopped, bool is_greeted) {
  impl_->serve(std::move(channel), stopped, is_greeted);
}

std::vector<std::byte> greeting(const std::string& commit, std::uint64_t first_version, bool stays) {
  wire::HelloT hello;
  hello.layout = kLinkLayout;
  hello.commit = commit;
  hello.first_version = first_version;
  hello.stays = stays;
  return encoded(std::move(hello));
}

}  // namespace palpate
