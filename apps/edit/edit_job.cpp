// SPDX-License-Identifier: Apache-2.0
#include "apps/edit/edit_job.hpp"

#include <set>
#include <thread>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/progress.hpp"
#include "apps/edit/script_reader.hpp"
#include "apps/edit/stamp_files.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/journal/acknowledged_file.hpp"
#include "engine/journal/volume_identity.hpp"
#include "engine/session/edit_session.hpp"

namespace palpate {
namespace {

constexpr std::size_t kQueuedOrders = 1024;
constexpr std::size_t kMostTimes = std::size_t{1} << 18U;

// The same message with more behind it, or in front of it.
Error withMore(const Error& error, const std::string& front, const std::string& behind) {
  const bool is_named = front.empty() || std::string_view(error.what()).starts_with(front + ": ");
  return {error.code(), is_named ? error.input() : front + ": " + error.input(), error.reason(),
          behind.empty() ? error.remedy() : error.remedy() + "; " + behind};
}

// No output file may be one of the inputs.
void checkReadOnly(const std::string& in, const EditRequest& request) {
  for (const std::string& out : {request.out, request.json}) checkNotInput(in, out);
}

void stopIfInterrupted() {
  throwIfInterrupted("palpate edit", "start it again");
}

// Whether the session can continue after this error.
bool isSurvivable(const Error& error) {
  return error.code() != Error::Code::kDevice && error.code() != Error::Code::kCancelled;
}

// Times of any number of commands in bounded memory: keeps every one, then every second one, and so on.
class Times {
 public:
  void add(double milliseconds) {
    if (count_++ % stride_ != 0) return;
    kept_.push_back(milliseconds);
    if (kept_.size() < kMostTimes) return;
    for (std::size_t i = 0; 2 * i < kept_.size(); ++i) kept_[i] = kept_[2 * i];
    kept_.resize(kMostTimes / 2);
    stride_ *= 2;
  }
  [[nodiscard]] Percentiles percentiles() const { return kept_.empty() ? Percentiles{} : palpate::percentiles(kept_); }

 private:
  std::vector<double> kept_;
  std::uint64_t count_ = 0;
  std::uint64_t stride_ = 1;
};

// What the user said on the command line, then what the script says. Made before the volume is loaded, so that a typo
// or a script that is not there is told at once.
class Orders {
 public:
  explicit Orders(const EditRequest& request) {
    if (request.commands.empty() && request.script.empty()) {
      throw Error(Error::Code::kBadInput, "palpate edit", "there is nothing to do",
                  "give --do COMMAND, for example --do remove:radius=2mm:at=0,0,0, or --script FILE");
    }
    for (const std::string& command : request.commands) {
      given_.push_back(editOrder(command, "--do"));
      if (given_.back().refusal && !request.keep_going) throw Error(*given_.back().refusal);
    }
    if (!request.script.empty()) script_.emplace(request.script);
  }

  // In a thread of its own.
  void giveTo(EditQueue& queue) {
    try {
      for (EditOrder& order : given_) {
        if (!queue.push(std::move(order))) return;
      }
      if (script_) script_->giveTo(queue, interrupted);
      stopIfInterrupted();
      queue.close();
    } catch (...) {
      queue.fail(std::current_exception());
    }
  }
  [[nodiscard]] double fraction() const { return script_ ? script_->fraction() : 0; }

 private:
  std::vector<EditOrder> given_;
  std::optional<ScriptReader> script_;
};

class Giver {
 public:
  Giver(Orders& orders, EditQueue& queue) : queue_(queue), thread_([&orders, &queue] { orders.giveTo(queue); }) {}
  ~Giver() { queue_.abandon(); }  // then the thread ends and is joined
  Giver(const Giver&) = delete;
  Giver& operator=(const Giver&) = delete;

 private:
  EditQueue& queue_;
  std::jthread thread_;
};

class Job {
 public:
  Job(const EditRequest& request, double isovalue, Volume& volume, Progress& progress,
      const std::function<void(const std::string&)>& tell)
      : request_(request),
        volume_(volume),
        progress_(progress),
        tell_(tell),
        profile_(brushProfile(volume, isovalue)),
        engine_(volume, makePlan({}), isovalue, request.gpu, request.gpu_memory_bytes,
                passProgress(progress, stopIfInterrupted)),
        session_(engine_, profile_, {}, request.history_bytes),
        stamps_(volume.lattice(), profile_) {
    result_.isovalue = isovalue;
    result_.gpu = engine_.gpu().name;
    if (request.journal.empty()) return;
    session_.keepJournal(request.journal, identityOf(volume), watchedJournal());
    tellWhatIsKept(
        fmt::format("{} was not written; "
                    "the journal {} holds the commands that had reached the disk: see 'palpate recover'",
                    request.out, request.journal));
  }

  EditResult run(Orders& orders, const ConvertRequest& output, AtomicFile& file) {
    try {
      progress_.stage("applying the edits");
      applyAll(orders);
      session_.close();
      tellOfJournal();
      // Again: with keep_going the refusal of a stamp did not end the job.
      for (const std::string& mesh : meshes_) checkReadOnly(mesh, request_);
      progress_.stage("reading back");
      result_.changed_bricks = engine_.readBack(volume_);
      volume_.keepIsovalue(result_.isovalue);
      result_.content = contentHash(volume_);
      result_.file = writeOutput(volume_, output, "palpate edit", file, progress_);
      file.commit();
      tellWhatIsKept(request_.out + " is written");
      tellOfNothing();
    } catch (const Error& error) {
      session_.close();
      session_.dropEmptyJournal();
      throw withMore(error, "", stateInWords());
    }
    addFigures();
    return result_;
  }

 private:
  void applyAll(Orders& orders) {
    EditQueue queue(kQueuedOrders);
    const Giver giver(orders, queue);
    while (std::optional<EditOrder> order = queue.pop()) {
      stopIfInterrupted();
      progress_.fraction(orders.fraction());
      try {
        if (order->refusal) throw Error(*order->refusal);
        apply(order->text, order->where);
      } catch (const Error& error) {
        if (!request_.keep_going || !isSurvivable(error)) throw withMore(error, order->where, "");
        ++result_.refused;
        tell_(std::string(withMore(error, order->where, "").what()) + " (left out)");
      }
      tellOfJournal();
    }
  }

  void apply(EditText& text, const std::string& where) {
    std::vector<EditCommand> commands;
    if (text.verb == EditText::Verb::kEdit) {
      commands = commandsOf(text);
      tellOfFineness(text.command, where);
    }
    const Stopwatch watch;
    if (text.verb == EditText::Verb::kUndo) {
      session_.undo(0);
      ++result_.undone;
    } else if (text.verb == EditText::Verb::kRedo) {
      session_.redo(0);
      ++result_.redone;
    } else {
      const Engine::EditResult edited = session_.edit(commands, 0);
      ++result_.edits;
      if (edited.changed_bricks == 0) tellOfIdle(where);
    }
    times_.add(1e3 * watch.seconds());
  }

  std::vector<EditCommand> commandsOf(EditText& text) {
    if (isStamp(text.command.kind)) {
      meshes_.insert(text.mesh_file);
      checkReadOnly(text.mesh_file, request_);
      text.command.stamp = stamps_.stampOf(text);
    }
    return withMirror(text.command, text.mirror_axis, volume_.size(), volume_.lattice());
  }

  // Tells once of a brush that is fine for the voxels, since a stroke has many pieces.
  void tellOfFineness(const EditCommand& command, const std::string& where) {
    if (told_of_fineness_) return;
    const std::string words = fineBrushWarning(command, volume_.lattice());
    if (words.empty()) return;
    told_of_fineness_ = true;
    tell_(where + ": " + words);
  }

  // Tells of an edit that reached no voxel: probably its place or unit is wrong. Only the first ones are told; all are
  // counted.
  void tellOfIdle(const std::string& where) {
    constexpr std::uint64_t kTold = 10;
    if (++result_.idle > kTold) return;
    tell_(fmt::format("{}: it changed nothing: no density is in its reach that it would change; {}", where,
                      result_.idle < kTold ? "'palpate info' says where the volume lies (mm)"
                                           : "others like it are counted and no longer told"));
  }

  // Tells once when the journal fails.
  void tellOfJournal() {
    const JournalWriter* journal = session_.journal();
    if (journal == nullptr || journal_failed_ || !journal->failed()) return;
    journal_failed_ = true;
    tell_(journal->failure());
  }

  // A script that a program wrote may well be empty: the result is the volume as it was, which is no error.
  void tellOfNothing() const {
    if (result_.applied() + result_.refused > 0) return;
    tell_(fmt::format("{}: it has no command, so there was nothing to do; {} holds the volume as it was",
                      request_.script, request_.out));
  }

  // What becomes of the commands before the one that ended the job. After the session's end.
  [[nodiscard]] std::string stateInWords() const {
    std::string words = fmt::format("{} was not written, {} command{} had been applied", request_.out,
                                    result_.applied(), result_.applied() == 1 ? "" : "s");
    const EditFigures figures = session_.figures();
    if (request_.journal.empty() || figures.acknowledged == 0) return words;
    return words + fmt::format(" and the journal {} holds {}: see 'palpate recover'", request_.journal,
                               figures.acknowledged == figures.journalled ? "them" : "those up to where it failed");
  }

  void addFigures() {
    result_.edit_ms = times_.percentiles();
    for (const MemoryFigure& figure : engine_.memory()) {
      if (figure.name == "gpu total") result_.gpu_bytes = figure.bytes;
    }
    result_.gpu_budgeted_bytes = engine_.budgetedBytes();
    result_.history_steps = session_.history().steps();
    result_.history_bytes = session_.history().bytes();
    result_.history_forgotten = session_.history().forgotten();
    const EditFigures figures = session_.figures();
    result_.journal_records = figures.journalled;
    result_.journal_saved = figures.acknowledged;
    result_.journal_bytes = figures.journal_bytes;
  }

  const EditRequest& request_;
  Volume& volume_;
  Progress& progress_;
  const std::function<void(const std::string&)>& tell_;
  BrushProfile profile_;
  Engine engine_;
  EditSession session_;
  StampFiles stamps_;
  std::set<std::string> meshes_;  // of stamps
  EditResult result_;
  Times times_;
  bool journal_failed_ = false;
  bool told_of_fineness_ = false;
};

}  // namespace

EditResult editVolume(const EditRequest& request, Progress& progress,
                      const std::function<void(const std::string&)>& tell) {
  const Stopwatch watch;
  ConvertRequest output{.in = request.in, .out = request.out};
  checkOutput(output);
  checkReadOnly(request.in, request);
  if (!request.script.empty()) checkReadOnly(request.script, request);
  Orders orders(request);
  // Opened before the long work, so that a folder without write permission is refused at once.
  AtomicFile file(request.out, Rights::kPrivate);
  progress.stage("loading " + request.in);
  Volume volume = loadAndTell(request.in, progress);
  stopIfInterrupted();
  const double isovalue = static_cast<float>(request.isovalue ? *request.isovalue : defaultIsovalue(volume));
  checkIsovalue(volume, isovalue);
  if (isMeshFileName(request.out)) output.isovalue = isovalue;
  progress.stage("computing on Vulkan");
  Job job(request, isovalue, volume, progress, tell);
  EditResult result = job.run(orders, output, file);
  progress.done();
  result.seconds = watch.seconds();
  return result;
}

}  // namespace palpate
