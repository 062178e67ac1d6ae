// SPDX-License-Identifier: Apache-2.0
#include "apps/live/live_volume.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/convert/convert_job.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/load/stair_words.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/acknowledged_file.hpp"
#include "engine/journal/checkpoint.hpp"
#include "engine/journal/recovery.hpp"
#include "engine/journal/volume_identity.hpp"

namespace palpate {
namespace {

// The file, and the folder if nothing else is in it.
void removeJournal(const std::filesystem::path& folder) {
  std::error_code ignored;
  removeCheckpoints(folder);
  std::filesystem::remove(journalFile(folder), ignored);
  std::filesystem::remove(folder, ignored);
}

Journal journalOf(const LiveVolumeRequest& request, const Volume& volume) {
  try {
    Journal journal = readJournal(request.recovers);
    checkStart(journal, volume, request.volume);
    return journal;
  } catch (const Error& error) {
    if (request.recovers_else.empty()) throw;
    throw Error(error.code(), error.input(), error.reason(), request.recovers_else);
  }
}

}  // namespace

LiveVolume::LiveVolume(const LiveVolumeRequest& request, Progress& progress, Tell tell)
    : name_(request.volume),
      work_(request.work),
      gpu_(request.gpu),
      gpu_memory_bytes_(request.gpu_memory_bytes),
      takes_filters_(request.takes_filters),
      tell_(std::move(tell)),
      journal_(request.journal) {
  progress.stage("loading " + request.volume);
  volume_ = loadAndTell(request.volume, progress);
  if (const std::string& remark = volume_->facts().remark; !remark.empty()) tell_(remark);
  checkTouchable(*volume_);
  std::optional<Journal> journal;
  if (!request.recovers.empty()) {
    journal = journalOf(request, *volume_);
    first_isovalue_ = journal->header.profile.isovalue;
  } else {
    first_isovalue_ = static_cast<float>(request.isovalue ? *request.isovalue : defaultIsovalue(*volume_));
  }
  checkIsovalue(*volume_, first_isovalue_);
  stairs_ = std::make_unique<const Stairs>(stairsOf(*volume_, first_isovalue_));
  if (const std::string stairs = stairsAt(first_isovalue_, request.plan); !stairs.empty()) {
    tellUser(volume_->facts().source + ": " + stairs);
    tell_(stairs);
  }
  const auto stopIfInterrupted = [this] { throwIfInterrupted(work_); };
  stopIfInterrupted();
  if (request.look) request.look(*volume_, first_isovalue_);
  const bool checkpoints = request.outlives_its_engine && !journal_.empty();
  const VolumeIdentity identity = journal_.empty() ? VolumeIdentity{} : identityOf(*volume_);
  Recovered found;  // in the volume before the engine gets it
  if (journal)
    found =
        recoverSession(*journal, checkpoints ? checkpointFolder(request.recovers) : std::filesystem::path(), *volume_);
  loss_ = found.loss;
  lost_records_ = found.lost_records;
  if (!loss_.empty()) tell_(loss_);
  progress.stage("computing on Vulkan");
  engine_ = std::make_unique<Engine>(*volume_, request.plan, first_isovalue_, request.gpu, request.gpu_memory_bytes,
                                     passProgress(progress, stopIfInterrupted));
  const BrushProfile profile = journal ? journal->header.profile : brushProfile(*volume_, first_isovalue_);
  session_ = std::make_unique<EditSession>(*engine_, profile, std::span<const EditKind>{}, request.undo_bytes,
                                           found.held.edits);
  if (!journal_.empty()) {
    std::optional<JournalBeginning> beginning;
    if (found.begins_with_bricks) beginning = {found.mark, &*volume_, found.held.bricks};
    session_->keepJournal(journal_, identity, watchedJournal(), beginning);
  }
  volume_->keepIsovalue(first_isovalue_);
  session_->keepSaved(*volume_, {}, 0);
  if (request.outlives_its_engine) session_->keepAbreast();
  if (checkpoints) session_->keepCheckpoints(journal_, found.before, found.held, tell_);
  makeAgain(found.edits, progress);
  edits_ = std::make_unique<RigEdits>(*session_, volume_->size(), volume_->lattice(), tell_);
  if (const std::size_t edits = session_->history().editsInEffect(); journal && edits > 0)
    tell_(fmt::format("edits of the session before that are in the volume again: {}; steps that can be undone: {}",
                      edits, session_->history().done()));
  if (journal && !journalHolds()) {
    tell_(fmt::format("the edits stay in {}, since the new journal cannot be written", request.recovers.string()));
  }
}

std::string LiveVolume::stairsAt(double isovalue, const Plan& plan) const {
  return stairWords(*stairs_, isovalue, plan, takes_filters_ ? FilterGiven::kAsOption : FilterGiven::kAsFile);
}

// As edits of this session, so that its journal holds them too.
void LiveVolume::makeAgain(std::span<const LastingEdit> edits, Progress& progress) {
  if (edits.empty()) return;
  progress.stage("making the edits again");
  for (std::size_t i = 0; i < edits.size(); ++i) {
    throwIfInterrupted(work_);
    progress.fraction(static_cast<double>(i) / static_cast<double>(edits.size()));
    static_cast<void>(session_->edit(edits[i].commands, 0, edits[i].goes_on ? UndoStep::kLast : UndoStep::kNew));
  }
}

void LiveVolume::makeEngineAnew(const Plan& plan) {
  if (engine_) {  // it ends first: there may be no room for two
    const std::unique_ptr<Engine> last = std::move(engine_);
    session_->leaveEngine();
  }
  auto next = std::make_unique<Engine>(*volume_, plan, first_isovalue_, gpu_, gpu_memory_bytes_);
  session_->goOnWith(*next);
  engine_ = std::move(next);
  edits_->goOn();
}

LiveVolume::~LiveVolume() {
  try {
    close();
  } catch (const std::exception&) {  // nobody is left who could be told
  }
}

std::string LiveVolume::journalFailure() const {
  const JournalWriter* const journal = session_->journal();
  return journal != nullptr && journal->failed() ? journal->failure() : "";
}

// Of a file that was asked for: it is told what became of it, also where nobody gets to it any more.
class LiveVolume::SavePromise {
 public:
  SavePromise(LiveVolume& live, std::string file, std::function<void(const Saved&)> done)
      : live_(live), file_(std::move(file)), done_(std::move(done)) {
    ++live_.errands_;
  }
  ~SavePromise() {
    if (!kept_)
      refuse(Error(Error::Code::kCancelled, file_, "it was not written: editing has ended", "start again, and save"));
    --live_.errands_;
  }
  SavePromise(const SavePromise&) = delete;
  SavePromise& operator=(const SavePromise&) = delete;
  void refuse(const Error& why) { keep({false, why.what(), why}); }
  void keep(const Saved& outcome) {
    done_(outcome);
    kept_ = true;
  }

 private:
  LiveVolume& live_;
  const std::string file_;
  const std::function<void(const Saved&)> done_;
  bool kept_ = false;
};

void LiveVolume::save(const std::string& file, double isovalue, std::function<void(const Saved&)> done) {
  ConvertRequest request{.in = name_, .out = file};
  if (isMeshFileName(file)) request.isovalue = isovalue;
  checkOutput(request);
  const std::uint64_t content = edits_->counts().content_version;
  const bool is_volume = isVolumeFileName(file);
  const auto promise = std::make_shared<SavePromise>(*this, request.out, std::move(done));
  const bool is_taken =
      edits_->errand([this, promise, request, content, is_volume](const Volume& volume, std::uint64_t) {
        try {
          Progress silent(nullptr);
          AtomicFile target(request.out, Rights::kPrivate);
          const ConvertResult result = writeOutput(volume, request, work_, target, silent);
          target.commit();
          if (is_volume) saved_version_ = std::max(saved_version_.load(), content);
          promise->keep({true, convertWords(request, result)});
        } catch (const std::exception& error) {
          const auto* const known = dynamic_cast<const Error*>(&error);
          promise->refuse(known != nullptr ? *known
                                           : Error(Error::Code::kOutOfMemory, request.out,
                                                   fmt::format("it was not written: {}", error.what()),
                                                   "end other programs, and save again"));
        }
      });
  if (!is_taken)
    promise->refuse(Error(Error::Code::kOutOfMemory, request.out,
                          "it was not written: too many requests wait, or editing has ended",
                          "save again when others are done"));
}

bool LiveVolume::isUnsaved() const {
  return edits_->counts().content_version > saved_version_.load();
}

void LiveVolume::close(KeepJournal keep) {
  if (std::exchange(closed_, true) || !session_) return;
  if (engine_) edits_->doWaiting(0);  // a file that was asked for last
  edits_->end();
  session_->close();
  const bool unsaved = isUnsaved();
  const bool keeps = keep == KeepJournal::kIfUnsaved ? unsaved : keep == KeepJournal::kAlways;
  if (!journal_.empty() && !keeps) removeJournal(journal_);
  // With kNever nobody wants the edits, so nobody is told of a journal that lacks them.
  const JournalWriter* journal = session_->journal();
  if (unsaved && keep != KeepJournal::kNever && journal != nullptr && !journal->failure().empty()) {
    throw Error(Error::Code::kIo, journal_.string(), "edits are lost that no file holds: " + journal->failure(),
                "'palpate recover' brings back those before");
  }
}

}  // namespace palpate
