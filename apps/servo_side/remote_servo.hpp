// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/remote_servo.hpp: the servo of a rig in a process of its own, seen from the engine's. As
// servo_side.hpp says; docs/service-protocol.md has the order of the messages.
//
// The other process makes device, algorithm and loop from the same scene, and reads windows from memory that both
// share. By the simulated clock it asks before each tick, so that the records are the same as in one process, bit for
// bit. If it dies, wait() and runSimulated() throw Error(kDevice). If this process dies, the other one brings the force
// to zero and ends.
#pragma once

#include <atomic>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "apps/held/placement_choice.hpp"
#include "apps/scene/scene.hpp"
#include "apps/servo_side/servo_side.hpp"
#include "service/memory/link_memory.hpp"
#include "service/messages/message_channel.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/recording.hpp"

namespace palpate {

class RemoteServo final : public ServoSide {
 public:
  struct Request {
    const Scene& scene;                   // whose device it makes
    VolumeBox box;                        // of the volume, for a device that a person holds
    const SampledPath* way = nullptr;     // of a device that none holds; null: none
    const Vec3* pointer = nullptr;        // a pointer leads it (aim()); without a way from here on; null: none does [m]
    std::size_t told_ticks = 0;           // that tellTicksTo() keeps at most between two looks; 0: none
    std::size_t window_samples = 0;       // that a window has at most
    std::size_t recorded_reads = 0;       // of the device, to keep for recording(); 0: none
    std::string commit = {};              // of this program, which must be the servo's
    const wire::HelloT* hello = nullptr;  // the servo's first message, if it was read already
    int patience_ms = 120'000;            // while the servo makes a device
    int loop_patience_ms = 120'000;       // while it makes a loop, with a mesh's search tree
    // From a request to stop. Empty: the longest fade that the servo's own ceilings may ask for (longestFade_s(), a
    // minute at most), and MessageChannel::kPatience_ms.
    std::optional<int> end_patience_ms = {};
  };
  // Makes the device over there. Throws Error: as makeSceneDevice() does; kDevice, kBadInput as MessageChannel does.
  RemoteServo(Channel channel, const Request& request);
  ~RemoteServo() override;
  RemoteServo(const RemoteServo&) = delete;
  RemoteServo& operator=(const RemoteServo&) = delete;

  // For the engine, before the loop is made: its memory, and the number of the first window there.
  [[nodiscard]] LinkMemory& memory() noexcept { return memory_; }
  // The one that made the device, as the kernel says; 0: it is not known here, as in another container.
  [[nodiscard]] std::int64_t process() const noexcept { return process_; }
  [[nodiscard]] std::uint64_t firstVersion() const noexcept { return first_version_; }
  // It goes on when this one is let go, or its process ends: requestStop() then leaves it, and its result is empty.
  [[nodiscard]] bool stays() const noexcept { return stays_; }
  struct PlacedScales {
    double scale = 1, force_scale = 1;  // as Placement has them
  };
  [[nodiscard]] const std::optional<PlacedScales>& placed() const noexcept {
    return placed_;
  }  // empty: nobody holds it
  // With which a recorded session was felt; empty: none is played back.
  [[nodiscard]] const std::optional<RecordedContact>& session() const noexcept { return session_; }

  [[nodiscard]] const Device& device() const noexcept override;
  [[nodiscard]] ToolPoseMailbox& tool() noexcept override { return tool_; }
  void makeLoop(const LoopParameters& loop, const RigSettings& settings, const RigVolume& volume,
                std::unique_ptr<Algorithm> algorithm) override;
  // Throws Error(kDevice) if the other process is gone, or soon if it does not read: then it is let go, too.
  std::uint64_t give(ServoChange change, const RigSettings& settings) override;
  [[nodiscard]] bool ended(std::uint64_t number) const noexcept override {
    return ended_.load(std::memory_order_acquire) >= number;
  }
  [[nodiscard]] LoopResult runSimulated(const ServoLoop::Hook& before_tick) override;
  void start() override;
  [[nodiscard]] bool running() const noexcept override { return running_.load(std::memory_order_acquire); }
  [[nodiscard]] bool isGone() const noexcept override { return is_gone_.load(std::memory_order_acquire); }
  [[nodiscard]] LoopResult wait() override;
  void requestStop() noexcept override;
  void tellTicksTo(LiveTicks& live) override;
  // Where the pointer leads the tool from now on (servo/devices/pointer_path.hpp). One thread.
  void aim(const PointerTarget& target) noexcept { aims_.aim(target); }

  // Ends a run, and lets the other process go; only memory() may be used afterwards. Waits for an end in good order,
  // for as long as Request::end_patience_ms says.
  void leave() noexcept;

  // After a run.
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& deviceFigures() const noexcept { return figures_; }
  [[nodiscard]] const std::optional<Recording>& recording() const noexcept { return recording_; }

 private:
  class Proxy;

  [[noreturn]] void refuseVersion(const std::string& reason);
  void sendMesh(const ContactObject& mesh);
  [[nodiscard]] std::int64_t endPatience_ns(const SafetyParameters& safety) const;
  void take(const wire::EndedT& ended, Descriptor attached);
  void listen();
  void passTicksOn();

  MessageChannel channel_;
  const int loop_patience_ms_;
  const std::optional<int> end_patience_ms_;
  std::int64_t end_patience_ns_ = 0;  // from a request to stop: the force fades first
  std::unique_ptr<Proxy> device_;
  std::optional<PlacedScales> placed_;
  std::optional<RecordedContact> session_;
  LinkMemory memory_;
  ToolPoseMailbox tool_;
  PointerAim aims_;
  std::optional<LiveTicks> told_ticks_;  // the other end of the servo's
  LiveTicks* ticks_ = nullptr;           // whom they are told here
  std::vector<TickRecord> taken_;
  std::int64_t last_told_ = -1;
  std::atomic<bool> is_gone_{false};
  std::atomic<bool> is_deaf_{false};  // it did not take a change; no other is waited for
  std::atomic<std::uint64_t> given_{0};
  std::atomic<std::uint64_t> ended_{0};
  std::uint64_t first_version_ = 1;
  std::int64_t process_ = 0;
  bool stays_ = false;
  std::atomic<bool> running_{false}, stop_{false};
  LoopResult result_;
  std::vector<std::pair<std::string, double>> figures_;
  std::optional<Recording> recording_;
  std::exception_ptr failure_;
  std::uint64_t most_records_ = 0, most_recording_bytes_ = 0;
  std::jthread listener_;  // last member: it uses the others
};

}  // namespace palpate
