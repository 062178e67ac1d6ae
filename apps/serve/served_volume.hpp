// SPDX-License-Identifier: Apache-2.0
// apps/serve/served_volume.hpp: a scene's volume and its editing session, touched by a servo in another process as long
// as one is there.
//
// A thread of its own does the engine's work: edits, pictures, and windows for the servo, with a rig (apps/rig). What
// clients ask for comes from other threads and is done by that one in order, whether a servo is there or not. An edit
// is answered when it is on the disk, in the journal. When the servo goes, the engine goes on without; the next one is
// taken as soon as it connects.
//   A service that was killed finds its journal again: its edits are made again first.
// Threads: one makes, starts and closes it; all other functions by any. `tell` is called by several, one at a time.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/live/live_volume.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/rig/live_view.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "apps/serve/kept_journal.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "service/channel/channel.hpp"

namespace palpate {

struct ServedStatus {
  bool servo = false;           // one is there
  std::uint64_t servos = 0;     // that have come so far
  ToolPose pose;                // of the newest one; tick -1: none
  std::int64_t pose_at_ns = 0;  // when it was seen (CLOCK_MONOTONIC)
  std::string device;           // of the servo
  std::uint64_t windows = 0;    // that the servo has read, as its poses say
  std::size_t waiting = 0;      // edits that are made but not on the disk
  std::uint64_t content_version = 0, edits = 0, refused = 0;
  std::size_t undoable = 0, redoable = 0;
  bool unsaved = false;
  std::uint64_t journal_bytes = 0;
  std::string journal_failure;
};

class ServedVolume {
 public:
  struct Request {
    Scene scene;
    std::filesystem::path journal;  // folder; empty: none
    std::string commit;             // of this program
  };
  using Tell = std::function<void(const std::string&)>;
  // Throws Error as LiveVolume does; kBadInput for a scene that cannot be served: with a simulated clock, a recording,
  // a brush of its own, or an algorithm that touches a mesh, which would not follow the edits.
  ServedVolume(const Request& request, Progress& progress, Tell tell);
  ~ServedVolume();
  ServedVolume(const ServedVolume&) = delete;
  ServedVolume& operator=(const ServedVolume&) = delete;

  void start();
  // Ends the thread, finishes what was asked for and closes the session; the journal stays if an edit is in effect.
  // Throws what ended the engine, and as LiveVolume::close().
  void close();
  // The engine has failed; close() throws why.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }

  // A servo that has connected, and said this. False: one is there already.
  [[nodiscard]] bool attach(Channel channel, const wire::HelloT& hello);

  using Done = std::function<void(const std::optional<Error>& refusal)>;
  void edit(std::vector<EditCommand> commands, Done done);
  void undo(Done done);
  void redo(Done done);
  void save(const std::string& file, std::function<void(const LiveVolume::Saved&)> done);
  // The whole object from in front, as PNG; drawn beside windows and edits. One at a time: a later one waits.
  void render(int width, int height, std::function<void(RenderedImage, const std::string& failure)> done);
  [[nodiscard]] Scene scene() const;
  // Live settings (live_setting.hpp); the servo takes them between two ticks. Throws Error as TouchRig::change() does.
  void change(const Scene& scene);
  [[nodiscard]] ServedStatus status() const;
  [[nodiscard]] const Vec3i& size() const noexcept { return size_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }

 private:
  struct Written {  // an edit that was made, and its record's number in the journal
    std::uint64_t record = 0;
    Done done;
  };
  struct Drawing {
    ViewRequest request;
    std::function<void(RenderedImage, const std::string& failure)> done;
  };
  void run();
  void feel(Channel channel, const wire::HelloT& hello);
  void lookAlone();
  bool lookAround(std::int64_t now_ns);
  void settle();
  bool drawOn();
  void noteStatus();
  void lendRig(TouchRig* rig);
  void heedRefusal(TouchRig& rig);
  [[nodiscard]] double wantedIsovalue(const Scene& scene) const;
  [[nodiscard]] Channel takeNext(wire::HelloT& hello);
  [[nodiscard]] Done onDisk(Done done);
  [[nodiscard]] RigSettings firstSettings() const;

  const std::string commit_;
  const Tell tell_;
  std::optional<KeptJournal> journal_;  // held as long as the session writes to it
  std::optional<LiveVolume> live_;
  Vec3i size_;
  Lattice lattice_;
  std::optional<SampledPath> way_;
  VolumeBox box_;
  SeenExtent seen_;
  DensityScale scale_;
  double lowest_ = 0, highest_ = 0;  // densities
  bool other_isovalues_ = true, gradient_everywhere_ = false;
  LiveView view_;
  std::deque<Written> written_;         // engine's thread
  std::optional<Drawing> drawing_;      // engine's thread
  std::unique_ptr<RemoteServo> servo_;  // engine's thread; the last one, whose memory the engine may still write to
  std::string servos_trouble_;          // why the last servo did not come to be; told once
  std::uint64_t drawing_from_ = 0;      // edits that it must show
  std::mutex changers_;                 // guards the next; held while the rig takes a change
  TouchRig* rig_ = nullptr;
  mutable std::mutex mutex_;  // guards what follows
  Scene scene_;
  Channel next_;
  wire::HelloT hello_;
  bool has_servo_ = false;
  std::deque<Drawing> drawings_;
  ServedStatus status_;
  std::atomic<bool> stop_{false}, failed_{false};
  std::exception_ptr failure_;
  bool closed_ = false;
  std::jthread thread_;  // last member: it uses the others
};

}  // namespace palpate
