// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/tune_job.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/console/interrupt.hpp"
#include "apps/report/words.hpp"
#include "apps/scene/scene_file.hpp"
#include "apps/scene/scene_text.hpp"
#include "apps/touch/force_error.hpp"
#include "apps/touch/live_edits.hpp"
#include "apps/tune/reasons.hpp"
#include "apps/tune/tune_report.hpp"
#include "apps/tune/workbench.hpp"
#include "base/atomic_file.hpp"
#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"
#include "engine/phantoms/phantom_spec.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr int kFreshRuns = 5;                                   // each with an engine of its own
constexpr std::size_t kMostConfirmed = 8;                       // so many picks are felt anew at most
constexpr const char* kFirstWords = "Written by palpate tune";  // by which a file is known as its own
constexpr const char* kSealWords =
    "# Checksum of the lines above, by which palpate tune knows that nobody edited them: ";
constexpr double kLeastUsefulStiffness_N_per_m = 10;  // a softer wall is hardly felt
constexpr std::string_view kTunedKeys[] = {"filter", "gradient_operator", "samples", "window", "servo.n"};

// A file's first words say who wrote it, and its last line what else it then held, so that no hand's work is lost.
std::string withSeal(const std::string& text) {
  return text + fmt::format("{}{:08x}\n", kSealWords, crc32c(text));
}

enum class Writer { kTune, kTuneAndAHand, kOther };

Writer writerOf(const fs::path& file) {
  if (!fs::is_regular_file(file)) return Writer::kOther;  // a pipe may be waited for for ever
  std::ifstream stream(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  if (!text.starts_with(fmt::format("# {}", kFirstWords))) return Writer::kOther;
  const std::size_t seal = text.rfind(kSealWords);
  const bool sealed = seal != std::string::npos && text == withSeal(text.substr(0, seal));
  return sealed ? Writer::kTune : Writer::kTuneAndAHand;
}

// What is there already, and is not for the program to replace.
void checkMayReplace(const std::string& out) {
  std::error_code ignored;
  if (!fs::exists(out, ignored)) return;
  const Writer writer = writerOf(out);
  if (writer == Writer::kTune) return;
  refuse(out,
         writer == Writer::kOther ? "it is there, and palpate tune did not write it"
                                  : "it is there, and was edited since palpate tune wrote it",
         "name another file with -o, or give --overwrite");
}

// By a brush of the scene, or of its path's file.
bool edits(const Scene& scene) {
  return !withRecordedBrush(scene).edit.empty();
}

// Before any long work.
void checkRequest(const TuneRequest& request, const std::string& out) {
  if (!algorithmEntry(request.scene.algorithm).traits.shows_surface) {
    refuse(fmt::format("--algorithm {}", request.scene.algorithm),
           "it shows no surface, so its force has no error that could be kept", "tune a scene with another algorithm");
  }
  if (request.goal.kind == Goal::Kind::kBudget && edits(request.scene)) {
    refuse(request.source, "its tool edits, which takes time at every tick, and trials are felt without a brush",
           "tune it with --error, or give --budget for the scene without its brush");
  }
  (void)sceneText(request.scene, fs::path(out).parent_path());  // refuses names that a scene cannot hold
  if (fs::path(out).extension() != kSceneExtension)
    refuse(out, "a scene's name ends with .toml", "add .toml to it, so that it can be run");
  checkOutputsDiffer({out, request.json});
  if (!request.overwrite) checkMayReplace(out);
  checkWritable(out);
  if (!request.json.empty()) checkWritable(request.json);
}

// Counts runs and says how long the others will take.
class RunProgress {
 public:
  RunProgress(Progress& progress, std::size_t most) : progress_(progress), most_(most) {
    progress_.stage(fmt::format("at most {} runs", most));
  }
  void done() {
    throwIfInterrupted("palpate tune");
    ++done_;
    const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(most_));
    progress_.fraction(share, watch_.seconds() * (1 - share) / share);
  }
  [[nodiscard]] std::size_t count() const { return done_; }

 private:
  Progress& progress_;
  std::size_t most_, done_ = 0;
  Stopwatch watch_;
};

class TuneJob {
 public:
  TuneJob(const TuneRequest& request, Progress& progress)
      : request_(request), progress_(progress), out_(request.out.empty() ? tunedName(request.source) : request.out) {
    checkRequest(request, out_);
  }

  TuneResult run() {
    progress_.stage("loading " + request_.scene.volume);
    bench_ = std::make_unique<Workbench>(request_.scene, progress_);
    find();
    confirm();
    result_.device = bench_->deviceName();
    result_.truth = truthWords();
    notes();
    if (result_.met) {
      reason();
      writeFileAtomically(out_, tunedScene());
      result_.out = out_;
    } else {
      takeNearest();
      result_.needed = neededWords();
      std::error_code ignored;
      if (fs::exists(out_, ignored)) result_.notes.push_back(out_ + " is of an earlier run, and stays as it is");
    }
    if (!request_.json.empty()) writeFileAtomically(request_.json, tuneJson(request_, result_));
    progress_.done();
    return std::move(result_);
  }

 private:
  void find() {
    const SearchSpace space =
        searchSpace(request_.scene, {.filters_and_operators = bench_->whyNotExact().empty(),
                                     .renews_planes = algorithmEntry(request_.scene.algorithm).traits.renews_planes,
                                     .longest_edge = bench_->longestEdge()});
    RunProgress runs(progress_, mostRuns(space));
    result_.found = search(request_.goal, space, [&](const Candidate& candidate) {
      Trial trial = bench_->feel(candidate);
      runs.done();
      return trial;
    });
    result_.runs = runs.count();
    if (!(result_.found.base.contact_share > 0)) {
      refuse(request_.source, "the tool feels no surface on its path, so there is no error to keep",
             "choose another path or isovalue; 'palpate touch' shows what is felt");
    }
  }

  // A candidate in fresh runs: the median of their times and starts, and the worst of what else was felt. The first
  // that is impossible ends them.
  [[nodiscard]] Trial feltAnew(const Candidate& candidate) {
    std::vector<double> times_us, starts_ms;
    Trial worst;
    for (int run = 0; run < kFreshRuns && worst.impossible.empty(); ++run) {
      throwIfInterrupted("palpate tune");
      const Trial fresh = bench_->feelAnew(candidate);
      times_us.push_back(fresh.loop_us);
      starts_ms.push_back(fresh.start_ms);
      if (run == 0) worst = fresh;
      keepWorse(worst, fresh);
    }
    worst.loop_us = median(times_us);
    longest_us_.push_back(std::ranges::max(times_us));
    worst.start_ms = median(starts_ms);
    return worst;
  }

  // The first of the picks that meets the goal in fresh runs. What is told of it are the figures of these runs. After
  // one that takes longer than in its trial, only those are tried that would still be quick enough by as much longer.
  void confirm() {
    bench_->emptyShelf();
    for (const std::size_t pick : result_.found.picks) {
      const Trial& trial = result_.found.trials[pick];
      if (result_.felt_anew.size() == kMostConfirmed) return;
      Trial expected = trial;
      expected.loop_us *= result_.longer;
      if (!meets(request_.goal, expected, result_.found.base)) continue;
      progress_.stage("feeling the choice anew");
      const Trial fresh = feltAnew(trial.candidate);
      result_.felt_anew.push_back(fresh);
      const bool quick = request_.goal.kind == Goal::Kind::kError || longest_us_.back() <= request_.goal.bound;
      if (quick && meets(request_.goal, fresh, result_.found.base)) {
        result_.met = true;
        result_.chosen = fresh;
        picked_ = pick;
        return;
      }
      tellMiss(trial, fresh);
    }
  }

  void tellMiss(const Trial& trial, const Trial& fresh) {
    if (!fresh.impossible.empty()) {
      result_.notes.push_back("a choice that met the goal in trials could not be felt anew: " + fresh.impossible);
      return;
    }
    const double taken_us = std::max(fresh.loop_us, longest_us_.back() / kTimeMargin);
    if (trial.loop_us > 0) result_.longer = std::max(result_.longer, taken_us / trial.loop_us);
    result_.notes.push_back(
        fmt::format("a choice that met the goal in trials did not in fresh runs, with its margin: {} N, {} us a tick",
                    figureText(fresh.error_N), figureText(fresh.loop_us)));
  }

  // Of what was felt anew, if anything was: trials met the goal then, and are no answer to why it cannot be met.
  void takeNearest() {
    const bool anew = !result_.felt_anew.empty();
    const std::vector<Trial>& felt = anew ? result_.felt_anew : result_.found.trials;
    const std::size_t nearest = nearestTo(request_.goal, felt, result_.found.base);
    result_.chosen = felt[nearest];
    // No fresh run may take longer than a budget either.
    needed_us_ = std::max(result_.chosen.loop_us * kTimeMargin, anew ? longest_us_[nearest] : 0);
  }

  [[nodiscard]] std::string truthWords() const {
    if (bench_->whyNotExact().empty()) return "the exact surface of the phantom, without its noise";
    return fmt::format(
        "what the same algorithm finds at the same places with n = 1, {} and the largest window, since {}",
        bench_->truthSamples() == Scene{}.samples ? "floats" : "halves, as floats do not fit,", bench_->whyNotExact());
  }

  void notes() {
    const Scene& scene = request_.scene;
    std::vector<std::string> how;
    if (edits(scene)) {
      result_.notes.emplace_back("the tool was felt without its brush: what it edits changes the contact");
      how.emplace_back("without its brush");
    }
    if (scene.device != defaultDevice()) {
      result_.notes.push_back(fmt::format(
          "trials are felt with the simulated device, not with {}: no hand can repeat its way. Its hand and "
          "its force's delay are not in the figures",
          scene.device));
      how.emplace_back("with the simulated device");
    }
    result_.felt_how = fmt::format("{}", fmt::join(how, ", "));
    if (!scene.stiffness_density.empty())
      result_.notes.emplace_back("the error is that of the largest stiffness which the density gives");
    if (scene.spring_hand) {
      result_.notes.emplace_back(
          "the hand is a spring, so each candidate was felt at places of its own; the error is taken at these");
    }
    if (!scene.simulated_clock) {
      result_.notes.emplace_back(
          "trials go by the simulated clock: by the real one a tick wakes from sleep and takes two to three times as "
          "long");
    }
    result_.notes.emplace_back(
        bench_->whyNotExact().empty()
            ? "'palpate touch' of the scene with --clock simulated repeats the error (exact.force_error_p99_N)"
            : "'palpate touch' cannot repeat the error: it knows exact surfaces only");
  }

  void reason() {
    const Trial& picked = result_.found.trials[picked_];
    for (const Axis axis : kAxes) {
      std::string why = reasonFor(axis, picked, result_.found.trials, result_.found.base, request_.goal);
      const bool surface = axis == Axis::kOperator || axis == Axis::kFilter;
      if (surface && !bench_->whyNotExact().empty()) why = "as the scene has it: another would feel another surface";
      if (axis == Axis::kN && !algorithmEntry(request_.scene.algorithm).traits.renews_planes)
        why = "as the scene has it: the algorithm keeps no planes";
      if (why.empty()) why = "no other was tried with the rest of the choice";
      result_.reasons.push_back({axisName(axis), valueOn(axis, picked.candidate), why});
    }
  }

  [[nodiscard]] std::string neededWords() const {
    const Trial& best = result_.chosen;
    if (!best.impossible.empty()) return fmt::format("settings that can be: {}", best.impossible);
    if (!holdsContact(best, result_.found.base)) return "a path on which the contact is not lost";
    if (request_.goal.kind == Goal::Kind::kBudget) {
      return fmt::format(
          "a budget of {} us ({} times what was measured, for the machine's other work), or a quicker algorithm or "
          "machine",
          shortNumber(needed_us_), kTimeMargin);
    }
    const double least_N = best.error_N * kErrorMargin, share = request_.goal.bound / least_N;
    if (!(share < 1)) return "runs that repeat what the trials found";
    std::string words = fmt::format("an error of {} N", shortNumber(least_N));
    if (share * stiffnessOf(request_.scene) >= kLeastUsefulStiffness_N_per_m)
      words += fmt::format(", or a stiffness of at most {} N/m", shortNumber(share * stiffnessOf(request_.scene)));
    const bool noisy = bench_->whyNotExact().empty() && parsePhantomSpec(request_.scene.volume).noise > 0;
    return words + (noisy ? ", or a volume with less noise" : ", or smaller voxels");
  }

  // The volume's name says series, NaN and resampling already.
  [[nodiscard]] std::string tunedScene() {
    Scene scene = bench_->sceneOf(result_.chosen.candidate);
    scene.series.clear();
    scene.nan.clear();
    scene.resample = false;
    std::string text = tomlComment(fmt::format("{}: {}", kFirstWords, request_.command));
    for (const Reason& reason : result_.reasons)
      text += tomlComment(fmt::format("{} = {}: {}", reason.choice, reason.value, reason.why));
    text += tomlComment("Comments of the scene that it was made from are not here.") + "\n";
    return withSeal(text + sceneText(scene, fs::path(out_).parent_path(), kTunedKeys));
  }

  const TuneRequest& request_;
  Progress& progress_;
  std::string out_;
  std::unique_ptr<Workbench> bench_;
  std::size_t picked_ = 0;
  std::vector<double> longest_us_;  // the longest run of each that was felt anew
  double needed_us_ = 0;            // not met: a budget that the nearest keeps
  TuneResult result_;
};

}  // namespace

std::string tunedName(const std::string& source) {
  fs::path name(source);
  if (name.extension() != kSceneExtension) return "tuned.toml";
  return name.replace_extension(".tuned.toml").string();
}

TuneResult tune(const TuneRequest& request, Progress& progress) {
  return TuneJob(request, progress).run();
}

}  // namespace palpate
