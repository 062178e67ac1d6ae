// SPDX-License-Identifier: Apache-2.0
// apps/serve/served_volume.hpp: a scene's volume and its editing session, touched by a servo in another process as long
// as one is there.
//
// A thread of its own does the engine's work: edits, pictures, and windows for the servo, with a rig (apps/rig). What
// clients ask for comes from other threads and is done by that one in order, whether a servo is there or not. An edit
// is answered when it is on the disk, in the journal. When the servo goes, the engine goes on without; the next one is
// taken as soon as it has made its device, which another thread waits for.
//   If the Vulkan device is lost, or other filters are asked for, the engine is made anew from the CPU's copy of the
// volume, which has every edit: clients, history and journal stay, what is asked for meanwhile waits, and the servo
// goes over to the new engine's windows.
// Threads: one makes, starts and closes it; all other functions by any. `tell` is called by several at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/onlook/onlook_messages.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "apps/serve/asked_isovalues.hpp"
#include "apps/serve/brush_holders.hpp"
#include "apps/serve/disk_answers.hpp"
#include "apps/serve/lost_engines.hpp"
#include "apps/serve/onlookers.hpp"
#include "apps/serve/picture_queue.hpp"
#include "apps/serve/served_engine.hpp"
#include "apps/serve/served_status.hpp"
#include "apps/serve/servo_door.hpp"
#include "apps/serve/told_faults.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "service/channel/channel.hpp"

namespace palpate {

class ServedVolume {
 public:
  struct Request {
    Scene scene;                    // the user's, whose device servos make
    Scene settings;                 // with what is to be in effect at first (live_setting.hpp), and the filters
    std::filesystem::path journal;  // folder; empty: none
    std::string commit;             // of this program
  };
  using Tell = std::function<void(const std::string&)>;
  // Throws Error as checkServable() and ServedEngine do.
  ServedVolume(const Request& request, Progress& progress, Tell tell);
  ~ServedVolume();
  ServedVolume(const ServedVolume&) = delete;
  ServedVolume& operator=(const ServedVolume&) = delete;

  void start();
  // Ends the thread, finishes what was asked for and closes the session; the journal stays if an edit is in effect.
  // `save`: the file that then gets the volume; empty: none. Throws what ended the engine, as LiveVolume::close(), and
  // Error(kIo) if that file was not written. Called once; the destructor's own call does nothing then.
  void close(const std::string& save = {});
  // Its thread looks again and again, or makes its engine anew, which may take ten minutes.
  [[nodiscard]] bool isAlive(std::int64_t within_ns) const noexcept;
  // The engine has failed for good; close() throws why.
  [[nodiscard]] bool failed() const noexcept { return failed_.load(std::memory_order_acquire); }

  // A servo that has connected, and said this. False, and the channel stays the caller's: one is there already.
  [[nodiscard]] bool attach(Channel&& channel, const wire::HelloT& hello) {
    return door_->letIn(std::move(channel), hello);
  }
  [[nodiscard]] bool isServo(std::int64_t process) { return door_->isServo(process); }  // ServoDoor

  // Each `done` is called once, by any thread, with what became of it.
  using Done = std::function<void(const std::optional<Error>& refusal)>;
  void edit(std::vector<EditCommand> commands, Done done);
  void undo(Done done);
  void redo(Done done);
  void save(const std::string& file, std::function<void(const LiveVolume::Saved&)> done);
  // The whole object from in front, with every edit made until now; drawn beside windows and edits, one at a time.
  // Throws as PictureQueue::ask().
  void render(int width, int height, PictureQueue::Done done);
  // The filters that the field goes through before it is felt (engine/filter), from now on; empty: none. The engine is
  // made anew with them; if it cannot be, with those that there were.
  void filter(const std::string& chain, Done done);
  [[nodiscard]] Scene scene() const;
  // Its isovalue is in effect, not on its way.
  [[nodiscard]] bool isIsovalueFelt() const;
  // Live settings (live_setting.hpp); the servo takes them between two ticks. `done`: an isovalue is in effect, or was
  // refused; `awaits`: also one that is on its way already. Throws Error(kBadInput), and changes nothing, as
  // TouchRig::change() does; kDevice while the engine is being made anew.
  enum class Awaits : std::uint8_t { kAnotherIsovalue, kTheIsovalue };
  void change(const Scene& scene, Done done, Awaits awaits = Awaits::kAnotherIsovalue);
  // What of the settings the servo's device cannot render, one line each; empty, too, while there is no servo.
  [[nodiscard]] std::vector<std::string> warnings() const;
  // What a user should know of a volume of few values at its isovalue and with its filters (LiveVolume::stairsAt).
  [[nodiscard]] std::string stairs() const;
  [[nodiscard]] ServedStatus status() const;

  // A client looks on, until leave(): it has memory of its own, which it shares with the engine. The brush that it lets
  // the tool hold is dropped when it leaves. Throws as Onlookers::add(), show() and change().
  [[nodiscard]] std::shared_ptr<Onlooker> lookOn();
  void leave(const std::shared_ptr<Onlooker>& one);
  void show(Onlooker& one, ViewRequest wanted) { onlookers_.show(one, std::move(wanted)); }
  // Its pointer's button is down, from askToHold() until release(): with `turn` from the former, it does nothing after
  // the latter.
  [[nodiscard]] BrushHolders::Turn askToHold(const Onlooker& one) const { return holders_.ask(one); }
  void hold(const std::shared_ptr<Onlooker>& one, BrushHolders::Turn turn, const ToolBrushSpec& brush);
  void release(const std::shared_ptr<Onlooker>& one);
  void goTo(std::size_t done);  // RigEdits::goTo()
  // What differs between the two, and nothing else: a client may not have seen yet what others have changed.
  void change(const RigSettings& before, const RigSettings& wanted, Done done);
  [[nodiscard]] ServedFacts facts() const;
  // `known`: State::edits of the list of steps that the client has; empty: it has none.
  [[nodiscard]] Looked looked(const Onlooker& one, const std::optional<std::uint64_t>& known) const;
  [[nodiscard]] const Vec3i& size() const noexcept { return size_; }
  [[nodiscard]] const Lattice& lattice() const noexcept { return lattice_; }
  [[nodiscard]] const BrushProfile& profile() const noexcept { return profile_; }  // of edits
  [[nodiscard]] bool keepsJournal() const noexcept { return !journal_.empty(); }

 private:
  void run();
  void work();
  void feel(std::unique_ptr<RemoteServo> servo);
  void lookAlone();
  bool lookAround(std::int64_t now_ns);
  void lookForOnlookers(TouchRig& rig);
  void noteMemory(std::int64_t now_ns);
  void settle();
  void makeAnew();
  enum class Patience : std::uint8_t { kNone, kForMemory };
  void makeEngine(const Scene& scene, Patience patience);
  void noteLost();
  void noteLackOfMemory(const Error& lack);
  [[nodiscard]] bool mustBeMadeAnew() const;
  void lendRig(TouchRig* rig);
  void heedRig(TouchRig& rig);
  void takeIsovalueAlone();
  void endIsovalue(const Error& refusal, double in_use);
  void noteReached(double isovalue);
  void takeSettings(const Scene& settings);
  // With changers_ held. Throws as change().
  void checkPossible(const Scene& wanted, bool goes_elsewhere) const;
  [[nodiscard]] double wantedIsovalue(const Scene& scene) const;
  [[nodiscard]] RigEdits& edits() noexcept { return engine_->live().edits(); }
  void refuseWaiting();
  [[nodiscard]] Done onDisk(Done done);
  [[nodiscard]] RigSettings settingsOf(const Scene& scene) const;

  const Tell tell_;
  const std::filesystem::path journal_;
  const Scene first_scene_;
  // Of the volume, which does not change:
  double first_isovalue_ = 0;
  Vec3i size_;
  Lattice lattice_;
  BrushProfile profile_;
  std::optional<SampledPath> way_;  // of a device that nobody holds
  SeenVolume seen_volume_;          // for whoever looks on
  // Engine's thread:
  std::unique_ptr<RemoteServo> servo_;  // the last one, whose memory the engine may still write to
  std::unique_ptr<ServedEngine> engine_;
  DiskAnswers answers_;
  LostEngines lost_;
  PictureQueue pictures_;
  Onlookers onlookers_;
  ToldFaults faults_;
  std::vector<TickRecord> told_;  // to them; kept for its memory
  std::int64_t memory_at_ns_ = 0;
  std::int64_t next_servo_ns_ = 0;  // no servo is taken in before this [ns]

  mutable std::mutex engines_;  // guards the next, and what of engine_ depends on its filters
  bool is_ready_ = true;        // false: the engine is being made anew

  mutable std::mutex changers_;  // guards the next; held while the rig takes a change
  TouchRig* rig_ = nullptr;

  BrushHolders holders_;

  AskedIsovalues asked_isovalues_;

  mutable std::mutex mutex_;  // guards what follows
  Scene scene_;
  double felt_isovalue_ = 0;
  std::optional<std::string> wanted_filter_;
  Done filter_done_;
  ServedStatus status_;

  std::atomic<bool> stop_{false}, failed_{false};
  std::atomic<std::int64_t> looked_at_ns_{0};  // while an engine is being made: by when it must be done
  std::exception_ptr failure_;
  bool closed_ = false;
  std::optional<ServoDoor> door_;
  std::jthread thread_;  // last members: they use the others
};

}  // namespace palpate
