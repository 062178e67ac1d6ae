// SPDX-License-Identifier: Apache-2.0
// apps/live/live_volume.hpp: a volume that is edited while it is touched and seen: loaded, on the engine, with an
// editing session, its journal, and files that are written beside the edits.
//
// A window and a service are built on it. It has no thread: whoever runs a rig with edits() lends it the rig's
// (apps/rig/touch_rig.hpp). Threads: one makes and closes it; save(), isUnsaved() and errands() by any between; `tell`
// is called by the engine's thread and the saver's.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "apps/console/progress.hpp"
#include "apps/rig/rig_edits.hpp"
#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "engine/journal/replay.hpp"
#include "engine/plan/plan.hpp"
#include "engine/service/engine.hpp"
#include "engine/session/edit_session.hpp"

namespace palpate {

struct Stairs;

struct LiveVolumeRequest {
  using Look = std::function<void(const Volume& volume, double isovalue)>;
  std::string volume = {};               // as loadVolume takes it
  std::optional<double> isovalue = {};   // empty: as `palpate touch` chooses it [density]
  std::string gpu = {};                  // part of the Vulkan device's name; empty: the best one
  std::uint64_t gpu_memory_bytes = 0;    // limit for densities and samples; 0: the device's
  Plan plan = {};                        // which allows edits
  std::filesystem::path journal = {};    // folder for the journal; empty: none
  std::filesystem::path recovers = {};   // journal of a session of this volume, whose edits are made again first; with
                                         // outlives_its_engine, from the checkpoints in `journal` on
  std::string recovers_else = {};        // what to do if that cannot be; empty: what the journal's reader says
  Look look = {};                        // at the volume without an edit, for facts that a crash must not change
  std::size_t undo_bytes = 256U << 20U;  // memory for undo
  bool outlives_its_engine = false;      // makeEngineAnew() may be called: EditSession::keepAbreast()
  std::string work = {};                 // names the verb in messages: "palpate sculpt"
  bool takes_filters = true;  // its user may give filters; if not, a volume of few values is to be filtered as a file
};

class LiveVolume {
 public:
  using Tell = std::function<void(const std::string&)>;
  // Throws Error as loadVolume, Engine and EditSession do, as readJournal and checkStart do, and kCancelled on Ctrl-C.
  // Edits that are made again are in this session's journal too. They can be undone, but for those that a checkpoint
  // had.
  LiveVolume(const LiveVolumeRequest& request, Progress& progress, Tell tell);
  ~LiveVolume();  // as close(); drops failures
  LiveVolume(const LiveVolume&) = delete;
  LiveVolume& operator=(const LiveVolume&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] double firstIsovalue() const noexcept { return first_isovalue_; }
  // What its user should know at this isovalue and with the filters of this plan, if it is a mask or a map of labels
  // (apps/load/stair_words.hpp); "": nothing. Of the volume as it was loaded. Any thread; no look at the volume.
  [[nodiscard]] std::string stairsAt(double isovalue, const Plan& plan) const;
  // With the edits that the saver has. Before edits are made, and after makeEngineAnew() until the next: it is the
  // saver's otherwise.
  [[nodiscard]] const Volume& volume() const noexcept { return *volume_; }
  [[nodiscard]] bool hasEngine() const noexcept { return engine_ != nullptr; }
  [[nodiscard]] Engine& engine() noexcept { return *engine_; }
  [[nodiscard]] const Engine& engine() const noexcept { return *engine_; }
  [[nodiscard]] EditSession& session() noexcept { return *session_; }
  [[nodiscard]] const EditSession& session() const noexcept { return *session_; }
  [[nodiscard]] RigEdits& edits() noexcept { return *edits_; }
  [[nodiscard]] const RigEdits& edits() const noexcept { return *edits_; }

  [[nodiscard]] bool keepsJournal() const noexcept { return !journal_.empty(); }
  // Whether every edit made until now is on the disk, in the journal. Waits for the disk. Engine's thread.
  [[nodiscard]] bool journalHolds() { return session_->flushJournal(); }
  [[nodiscard]] std::string journalFailure() const;
  // Of the journal whose edits were made again (LiveVolumeRequest::recovers): what of it could not be read, in words,
  // and how many records that somebody was told of are missing. "": nothing.
  [[nodiscard]] const std::string& loss() const noexcept { return loss_; }
  [[nodiscard]] std::uint64_t lostRecords() const noexcept { return lost_records_; }

  // Writes the volume, or its isosurface as a mesh, as the suffix says, with every edit made until now, in the
  // background. `done` gets what became of it, once, whatever happens. Throws Error(kBadInput) as checkOutput() does
  // (apps/convert).
  struct Saved {
    bool written = false;
    std::string words;                  // for people: what was written, or why it was not
    std::optional<Error> refusal = {};  // why it was not
  };
  void save(const std::string& file, double isovalue, std::function<void(const Saved&)> done);
  [[nodiscard]] std::size_t errands() const noexcept { return errands_.load(); }  // saves that are under way
  [[nodiscard]] bool isUnsaved() const;                                           // the newest file lacks an edit

  // When no rig runs: another engine of the same volume, by this plan, in place of the present one, which may have
  // failed. Edits, history, journal and files that are being written go on; its isovalue is the first one. Throws Error
  // as Engine and EditSession::leaveEngine() do: then there is no engine, and nothing but this and close() may be
  // called, beside what reads states and takes requests.
  void makeEngineAnew(const Plan& plan);

  // When no rig runs any more: does the requests that wait, finishes what save() began, and ends the journal. Deletes
  // the journal if it is not to be kept. Throws Error(kIo) if neither a file nor the journal holds every edit, unless
  // nothing is to be kept.
  enum class KeepJournal { kIfUnsaved, kAlways, kNever };
  void close(KeepJournal keep = KeepJournal::kIfUnsaved);

 private:
  class SavePromise;
  void makeAgain(std::span<const LastingEdit> edits, Progress& progress);

  const std::string name_, work_, gpu_;
  const std::uint64_t gpu_memory_bytes_;
  const bool takes_filters_;
  const Tell tell_;
  // Before all that may still have something to tell when it ends.
  std::atomic<std::uint64_t> saved_version_{0};  // RigEdits::State::content_version that a saved file holds
  std::atomic<std::size_t> errands_{0};
  std::filesystem::path journal_;
  std::string loss_;
  std::uint64_t lost_records_ = 0;
  std::optional<Volume> volume_;  // the saver's from the constructor to close()
  double first_isovalue_ = 0;
  std::unique_ptr<const Stairs> stairs_;  // of the volume without an edit
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<EditSession> session_;
  std::unique_ptr<RigEdits> edits_;
  bool closed_ = false;
};

}  // namespace palpate
