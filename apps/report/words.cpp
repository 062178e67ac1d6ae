// SPDX-License-Identifier: Apache-2.0
#include "apps/report/words.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "apps/report/path_outcome.hpp"
#include "base/byte_size.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

std::string withMm(double metres) {
  return shortNumber(metres * kMillimetresPerMetre) + " mm";
}

std::string touchedLine(const TouchRun& run) {
  const RunVolume& v = run.volume;
  return fmt::format("Touched   {} ({} x {} x {} voxels) at isovalue {}\n", v.name, v.size.x(), v.size.y(), v.size.z(),
                     shortNumber(v.isovalue));
}

std::string contactLine(const RunFigures& f) {
  if (f.contact_ticks == 0) return fmt::format("Contact   none in {} s\n", shortNumber(f.time_s));
  return fmt::format("Contact   {} s of {} s, {}, over {} of surface\n", shortNumber(f.contact_s),
                     shortNumber(f.time_s), f.touches == 1 ? "one touch" : fmt::format("{} touches", f.touches),
                     withMm(f.surface_way_m));
}

std::string feelLine(const RunFigures& f) {
  if (f.contact_ticks == 0) return "";
  const std::string depth =
      f.depth_m.count == 0 ? "no depth, for it knows no surface"
                           : fmt::format("depth median {}, at most {}", withMm(f.depth_m.p50), withMm(f.depth_m.max));
  return fmt::format("Felt      force median {} N, at most {} N; {}\n", shortNumber(f.force_N.p50),
                     shortNumber(f.force_N.max), depth);
}

std::string mJ(double joules) {
  return shortNumber(joules * 1e3) + " mJ";
}

std::string contactVerdictLine(const TouchRun& run, const RunFigures& f) {
  if (f.contact_ticks == 0) return "";
  return "Energy    " + stabilityWords(run.stability, f) + "\n";
}

std::string errorWords(const ContactStability& s) {
  return s.error_J == 0 ? "" : fmt::format(" (the encoders leave {} open)", mJ(s.error_J));
}

// An energy below zero at the end is within what the encoders and the quiet share leave open, or the verdict would
// differ.
std::string quietWords(const ContactStability& s, const RunFigures& f) {
  if (s.error_J > s.stored_J) {
    return fmt::format(
        "quiet as far as the encoders can tell: "
        "they leave {} open in one contact, and at most {} was stored; finer encoders would tell more",
        mJ(s.error_J), mJ(s.stored_J));
  }
  const std::string balance =
      f.energy_end_J >= 0
          ? fmt::format("the surface took {} from the hand", mJ(f.energy_end_J))
          : fmt::format("the surface gave the hand {}, which is within the {} that are left open over all contacts",
                        mJ(-f.energy_end_J), mJ(s.allowed_J));
  return fmt::format("quiet: {}, and no contact gave more than it had taken{}", balance, errorWords(s));
}

std::string swingWords(const ContactStability& s) {
  if (s.swing_m == 0) return fmt::format("by {} s the tool had bounced on the surface", shortNumber(s.unstable_from_s));
  return fmt::format("from {} s to {} s the tool swung against the surface by {} at {} Hz without settling",
                     shortNumber(s.unstable_from_s), shortNumber(s.unstable_to_s), withMm(s.swing_m),
                     shortNumber(s.swing_hz));
}

// What an unstable contact is mended by.
std::string remedyWords(const ContactStability& s, const RunFigures& f) {
  const std::string most = std::isfinite(s.most_damping_Ns_per_m)
                               ? fmt::format(" to {} at most", shortNumber(s.most_damping_Ns_per_m))
                               : std::string();
  return fmt::format("lower --stiffness{}, raise --rate, or {} --damping{}{}", s.delay_ticks > 0 ? " or --delay" : "",
                     s.damps_too_much ? "lower" : "raise", most,
                     f.damped_ticks > 0 ? "" : "; --passivity control lessens it");
}

std::string unstableWords(const ContactStability& s, const RunFigures& f) {
  const auto times = [](int count) { return counted(static_cast<std::uint64_t>(count), "time"); };
  return fmt::format("unstable: {}, {} in all, and the surface fed it{}; {}", swingWords(s),
                     counted(static_cast<std::uint64_t>(s.bounces), "bounce"),
                     s.ended_by_servo > 0 ? "; the servo took the force away " + times(s.ended_by_servo) : "",
                     remedyWords(s, f));
}

// The likely cause of the activity, and what lessens it.
std::string sourceWords(const ContactStability& s, const RunFigures& f) {
  switch (s.source) {
    case ActivitySource::kEdits:
      return "the volume was edited under the tool, which moves the surface against the hand";
    case ActivitySource::kSampledWall:
      return fmt::format("a sampled wall with less damping than {} does so; {}{} or a higher --rate",
                         s.delay_ticks > 0 ? fmt::format("K T (1/2 + {})", s.delay_ticks) : "K T / 2",
                         s.damps_too_much ? "less --stiffness" : "more --damping",
                         s.delay_ticks > 0 ? ", a shorter --delay" : "") +
             (f.damped_ticks > 0 ? "" : ", or --passivity control,") + " lessens it";
    default:
      return std::string("the damping is enough for this stiffness and rate, so it is the field: where samples are ") +
             "few or noisy its normals are not those of its surface; --filter gaussian:1 or --algorithm god-object" +
             (f.damped_ticks > 0 ? "" : ", or --passivity control,") + " lessens it";
  }
}

// The heading's words on the contact.
std::string stabilityClause(const ContactStability& s, const RunFigures& f) {
  switch (s.verdict) {
    case ContactVerdict::kUnstable:
      return "; the contact was unstable: " + remedyWords(s, f);
    case ContactVerdict::kSlightlyActive:
      return "; the contact was slightly active";
    case ContactVerdict::kQuiet:
      return "; the contact was quiet";
    default:
      return "";
  }
}

std::string servoLine(const TouchRun& run, const RunFigures& f) {
  if (run.scene.simulated_clock) {
    return fmt::format("Servo     {} at {} Hz, {} ticks, simulated clock (no times measured)\n", run.scene.algorithm,
                       shortNumber(run.scene.rate_hz), f.ticks);
  }
  return fmt::format(
      "Servo     {} at {} Hz, {} ticks, {} late{}; tick {} us median, {} us p99; wake-up {} us p99 late\n",
      run.scene.algorithm, shortNumber(run.scene.rate_hz), f.ticks, f.late_ticks, leftOutWords(f),
      shortNumber(f.tick_cost_us.p50), shortNumber(f.tick_cost_us.p99), shortNumber(f.lateness_us.p99));
}

std::string exactLine(const TouchRun& run) {
  if (!run.exact) return "";
  const ExactErrors& e = *run.exact;
  const std::string surface = e.vhip_median_voxel
                                  ? fmt::format("VHIP off by {} voxel median, {} p99; ",
                                                shortNumber(*e.vhip_median_voxel), shortNumber(*e.vhip_p99_voxel))
                                  : "";
  const std::string force = e.force_error_median_N
                                ? fmt::format("force off by {} N median, {} N p99, and ",
                                              shortNumber(*e.force_error_median_N), shortNumber(*e.force_error_p99_N))
                                : "force off ";
  return fmt::format("Truth     {}{}by {} degrees median, {} p99; over {} in contact{}\n", surface, force,
                     shortNumber(e.force_angle_median_deg), shortNumber(e.force_angle_p99_deg),
                     counted(static_cast<std::uint64_t>(e.ticks), "tick"), e.slide_only ? " of the slide" : "");
}

// A journal without a record was deleted, and is not named.
std::string journalClause(const TouchRun& run) {
  const RunEdits& e = *run.edits;
  if (run.scene.journal.empty() || (e.journal_bytes == 0 && e.journal_records == 0)) return "";
  std::string saved = fmt::format("; {} of {} saved", e.journal_saved, counted(e.journal_records, "journal record"));
  if (e.journal_bytes == 0) return saved;
  return saved + fmt::format(" in {}, {}", run.scene.journal, bytesInWords(e.journal_bytes));
}

std::string editLine(const TouchRun& run) {
  if (!run.edits) return "";
  const RunEdits& e = *run.edits;
  std::string text = "Edited    " + counted(e.count, "time");
  if (e.published > 0) {
    const Percentiles p = percentiles(e.edit_to_window_ms);
    text += fmt::format("; from edit to window {} ms median, {} ms p99", shortNumber(p.p50), shortNumber(p.p99));
  }
  text += journalClause(run);
  if (e.refused > 0) text += fmt::format("; {} refused", e.refused);
  if (!run.scene.save.empty()) text += "; " + saveWords(run);
  return text + "\n";
}

// As `palpate edit` and `palpate recover` print it.
std::string volumeLine(const TouchRun& run) {
  if (!run.edits || !run.edits->content) return "";
  const std::string change = run.edits->count == 0 ? "" : volumeChange(*run.edits) + ", ";
  return fmt::format("Volume    {}content {:016x}\n", change, *run.edits->content);
}

// The heading's words on the forces.
std::string forceClause(const RunFigures& f) {
  const std::string most = shortNumber(f.force_N.max);
  if (f.force_N.max >= kFaintForce_N) return fmt::format("felt at most {} N", most);
  return fmt::format("no force above {} N was reached, so that nobody feels it: at most {} N",
                     shortNumber(kFaintForce_N), most);
}

// The heading's words on the edits.
std::string editClause(const TouchRun& run) {
  if (!run.edits) return "";
  if (run.edits->count == 0) return "; nothing was edited";
  const std::string change = volumeChange(*run.edits);
  return "; " + counted(run.edits->count, "edit") + (change.empty() ? "" : " " + change);
}

std::string faultLines(const TouchRun& run) {
  if (run.faults.empty()) return "Faults    none\n";
  std::string out;
  for (const RunFault& fault : run.faults) {
    out += fmt::format("Fault     {} in {} of {} ticks, first at tick {}: {}; the force {}; {}\n", fault.name,
                       fault.ticks, run.records.size(), fault.first_tick, fault.text, fault.effect, fault.remedy);
  }
  return out;
}

std::string listLines(const char* word, const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += fmt::format("{:<10}{}\n", word, line);
  return out;
}

std::string filesLine(const TouchRun& run) {
  std::string names;
  for (const std::string& file : run.files) names += (names.empty() ? "" : "  ") + file;
  return names.empty() ? "" : "Files     " + names + "\n";
}

}  // namespace

std::string shortNumber(double value) {
  const double size = std::abs(value);
  if (!(size > 0) || !std::isfinite(value)) return fmt::format("{:.3g}", value);
  if (size >= 100 && size < 1e7) return fmt::format("{:.0f}", std::round(value));
  // Rounds halves away from zero, as people do; {fmt} would round them to even.
  const double scale = std::pow(10.0, 2 - std::floor(std::log10(size)));
  const double rounded = std::round(value * scale) / scale;
  return fmt::format("{:.3g}", std::isfinite(rounded) ? rounded : value);
}

std::string leftOutWords(const RunFigures& f) {
  return f.skipped_ticks == 0 ? "" : fmt::format(", {} left out", f.skipped_ticks);
}

std::string saveWords(const TouchRun& run) {
  const RunEdits& e = *run.edits;
  const std::string failed = e.save_failures == 0 ? "" : fmt::format(", {} failed", e.save_failures);
  if (e.saves == 0) return fmt::format("never saved in {}{}", run.scene.save, failed);
  return fmt::format("saved {} in {} up to edit {}, {}, at most {} s{}", counted(e.saves, "time"), run.scene.save,
                     e.save_version.value_or(0), bytesInWords(e.save_bytes), shortNumber(percentiles(e.save_s).max),
                     failed);
}

std::string volumeChange(const RunEdits& edits) {
  if (!edits.added_m3) return "";
  const double mm3 = *edits.added_m3 * kMillimetresPerMetre * kMillimetresPerMetre * kMillimetresPerMetre;
  if (mm3 == 0) return "moved no voxel across the surface";
  return fmt::format("{} about {} mm3", mm3 < 0 ? "removed" : "added", shortNumber(std::abs(mm3)));
}

std::string counted(std::uint64_t count, const std::string& word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string faultWord(std::size_t count) {
  if (count == 0) return "no fault";
  return count == 1 ? "1 kind of fault" : fmt::format("{} kinds of fault", count);
}

std::string stabilityWords(const ContactStability& s, const RunFigures& f) {
  std::string text = "no contact";
  if (s.verdict == ContactVerdict::kQuiet) {
    text = quietWords(s, f);
  } else if (s.verdict == ContactVerdict::kSlightlyActive) {
    text = fmt::format(
        "slightly active: a contact gave the hand {} more than it had taken{}, "
        "where at most {} was stored at once, and the tool did not keep swinging; {}",
        mJ(s.given_J), errorWords(s), mJ(s.stored_J), sourceWords(s, f));
  } else if (s.verdict == ContactVerdict::kUnstable) {
    text = unstableWords(s, f);
  }
  if (f.damped_ticks > 0)
    text += "; the controller acted in " + counted(static_cast<std::uint64_t>(f.damped_ticks), "tick");
  return text;
}

std::string verdict(const TouchRun& run, const RunFigures& f) {
  const std::string begin = run.ended_early.empty() ? "" : "Ended early: " + run.ended_early + ". ";
  const std::string end = pathClause(pathOutcome(run.records, run.phases, run.scene.rate_hz)) +
                          stabilityClause(run.stability, f) + editClause(run) + "; " + faultWord(run.faults.size()) +
                          ".";
  if (f.contact_ticks == 0)
    return begin + fmt::format("The tool never touched the surface in {} s{}", shortNumber(f.time_s), end);
  const std::string depth = f.depth_m.count == 0 ? "" : fmt::format(", pressed at most {} deep", withMm(f.depth_m.max));
  return begin + fmt::format("The tool touched the surface for {} s of {} s{} and {}{}", shortNumber(f.contact_s),
                             shortNumber(f.time_s), depth, forceClause(f), end);
}

std::string closingSummary(const TouchRun& run) {
  const RunFigures figures = figuresOf(run);
  const std::string ended = run.ended_early.empty() ? "" : "Ended     early: " + run.ended_early + "\n";
  return touchedLine(run) + ended + contactLine(figures) + feelLine(figures) + contactVerdictLine(run, figures) +
         servoLine(run, figures) + editLine(run) + volumeLine(run) + exactLine(run) + faultLines(run) +
         listLines("Note", run.notes) + filesLine(run);
}

}  // namespace palpate
