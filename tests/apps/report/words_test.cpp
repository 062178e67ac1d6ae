// SPDX-License-Identifier: Apache-2.0
#include "apps/report/words.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_run.hpp"

namespace palpate {
namespace words_test {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

std::string verdictOf(const TouchRun& run) {
  return verdict(run, figuresOf(run));
}

TEST(Words, VerdictIsOneSentence) {
  TouchRun run = sampleRun();
  run.faults.clear();
  EXPECT_EQ(verdictOf(run),
            "The tool touched the surface for 3 s of 5 s, pressed at most 1 mm deep and felt at most 0.5 N; "
            "the contact was quiet; 3 edits; no fault.");
}

TEST(Words, VerdictSaysWhatTheEditsDid) {
  TouchRun run = sampleRun();
  run.edits->added_m3 = -12.34e-9;
  EXPECT_THAT(verdictOf(run),
              HasSubstr("felt at most 0.5 N; the contact was quiet; 3 edits removed about 12.3 mm3; 1 kind of fault."));
  run.edits->count = 1;
  run.edits->added_m3 = 2e-6;
  EXPECT_THAT(verdictOf(run), HasSubstr("; 1 edit added about 2000 mm3; "));
  run.edits->added_m3 = 0;
  EXPECT_THAT(verdictOf(run), HasSubstr("; 1 edit moved no voxel across the surface; "));
  run.edits->count = 0;
  EXPECT_THAT(verdictOf(run), HasSubstr("; nothing was edited; "));
  run.edits.reset();
  EXPECT_THAT(verdictOf(run), HasSubstr("felt at most 0.5 N; the contact was quiet; 1 kind of fault."));
}

TEST(Words, ClosingSummaryHasTheContentAsRecoverPrintsIt) {
  TouchRun run = sampleRun();
  EXPECT_THAT(closingSummary(run), Not(HasSubstr("Volume")));
  run.edits->content = 0x1234;
  run.edits->added_m3 = -1e-9;
  EXPECT_THAT(closingSummary(run), HasSubstr("\nVolume    removed about 1 mm3, content 0000000000001234\n"));
  run.edits->count = 1;
  run.edits->journal_records = run.edits->journal_saved = 1;
  run.scene.journal = "kept";
  EXPECT_THAT(closingSummary(run), HasSubstr("Edited    1 time; "));
  EXPECT_THAT(closingSummary(run), HasSubstr("; 1 of 1 journal record saved in kept"));
}

// One without a record is deleted where the run ends early, or where it failed.
TEST(Words, AJournalThatIsNotThereIsNotNamed) {
  TouchRun run = sampleRun();
  run.scene.journal = "kept";
  run.edits->journal_records = run.edits->journal_saved = run.edits->journal_bytes = 0;
  EXPECT_THAT(closingSummary(run), Not(HasSubstr("journal")));
  EXPECT_THAT(closingSummary(run), Not(HasSubstr("kept")));
  run.edits->journal_records = 3;
  EXPECT_THAT(closingSummary(run), HasSubstr("; 0 of 3 journal records saved\n"));
  run.edits->journal_records = 0;
  run.edits->journal_bytes = 241;  // nothing was edited until the end: it stays
  EXPECT_THAT(closingSummary(run), HasSubstr("; 0 of 0 journal records saved in kept, 241 B\n"));
}

TEST(Words, ARunThatWasStoppedSaysSoFirst) {
  TouchRun run = sampleRun();
  const std::string verdict = verdictOf(run);
  EXPECT_THAT(closingSummary(run), Not(HasSubstr("early")));
  run.ended_early = "stopped by the user after 5 s of 60 s";
  EXPECT_EQ(verdictOf(run), "Ended early: stopped by the user after 5 s of 60 s. " + verdict);
  EXPECT_THAT(closingSummary(run), HasSubstr("\nEnded     early: stopped by the user after 5 s of 60 s\nContact "));
}

// 0.05 N is the least that counts as felt: the sample's largest is 0.5 N.
TEST(Words, VerdictSaysThatForcesWereFaint) {
  TouchRun run = sampleRun();
  run.faults.clear();
  run.edits.reset();
  for (TickRecord& r : run.records) r.force_W[2] *= 0.1;
  EXPECT_THAT(verdictOf(run), HasSubstr(" and felt at most 0.05"));
  for (TickRecord& r : run.records) r.force_W[2] *= 0.9;
  EXPECT_THAT(verdictOf(run),
              HasSubstr("pressed at most 1 mm deep and no force above 0.05 N was reached, so that nobody feels it: "
                        "at most 0.045 N; the contact was quiet; "));
}

TEST(Words, VerdictOfARunWithoutContact) {
  TouchRun run = sampleRun();
  for (TickRecord& r : run.records) r.in_contact = false;
  run.stability = {};
  EXPECT_EQ(verdictOf(run), "The tool never touched the surface in 5 s; 3 edits; 1 kind of fault.");
}

TEST(Words, ClosingSummaryNamesWhatMatters) {
  const std::string text = closingSummary(sampleRun());
  for (const char* words :
       {"phantom:sphere?size=64", "3 s of 5 s, one touch", "at most 0.5 N", "hri at 1000 Hz, 5000 ticks, 0 late",
        "stale_window in 12 of 5000 ticks, first at tick 300", "the force falls to zero; make the window larger",
        "quiet: the surface took", "the slide is 12 mm", "out/trace.csv", "VHIP off by 0.01 voxel",
        "over 2000 ticks in contact of the slide",
        "Edited    3 times; from edit to window 1.5 ms median, 2.5 ms p99"}) {
    EXPECT_THAT(text, HasSubstr(words));
  }
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 10);
}

TEST(Words, ClosingSummaryToTheLetter) {
  TouchRun run = sampleEditedRun();
  run.ended_early = "stopped by the user after 5 s of 60 s";
  EXPECT_EQ(
      closingSummary(run),
      "Touched   phantom:sphere?size=64 (64 x 65 x 66 voxels) at isovalue 0.25\n"
      "Ended     early: stopped by the user after 5 s of 60 s\n"
      "Contact   3 s of 5 s, 2 touches, over 20 mm of surface\n"
      "Felt      force median 0.25 N, at most 0.5 N; depth median 0.5 mm, at most 1 mm\n"
      "Energy    quiet: the surface took 1.5 mJ from the hand, and no contact gave more than it had taken\n"
      "Servo     hri at 1000 Hz, 4993 ticks, 4 late, 7 left out; tick 2 us median, 3.25 us p99; wake-up 60 us p99 "
      "late\n"
      "Edited    3 times; from edit to window 1.5 ms median, 2.5 ms p99; 2 of 3 journal records saved in kept, 500 "
      "B; 1 refused; saved 2 times in a.vdb up to edit 3, 2 KiB, at most 0.5 s, 4 failed\n"
      "Volume    added about 2 mm3, content 0000000000000abc\n"
      "Truth     VHIP off by 0.01 voxel median, 0.05 p99; force off by 0.02 N median, 0.04 N p99, and by 0.3 degrees "
      "median, 1.2 p99; over 2000 ticks "
      "in contact of the slide\n"
      "Fault     stale_window in 12 of 5000 ticks, first at tick 300: the engine published too rarely; the force "
      "falls to zero; make the window larger\n"
      "Note      the slide is 12 mm instead of 20 mm\n"
      "Files     out/trace.csv  out/summary.json\n");
}

// Nothing was touched and nothing edited; there is nothing to tell but that.
TEST(Words, ClosingSummaryOfAnEmptyRunToTheLetter) {
  TouchRun run;
  run.volume.name = "a.nrrd";
  run.scene.simulated_clock = true;
  run.figures = RunFigures{};
  run.edits = RunEdits{};
  run.edits->content = 0x12;
  run.exact = ExactErrors{};
  run.exact->ticks = 1;
  EXPECT_EQ(closingSummary(run),
            "Touched   a.nrrd (0 x 0 x 0 voxels) at isovalue 0\n"
            "Contact   none in 0 s\n"
            "Servo     hri at 1000 Hz, 0 ticks, simulated clock (no times measured)\n"
            "Edited    0 times\n"
            "Volume    content 0000000000000012\n"
            "Truth     force off by 0 degrees median, 0 p99; over 1 tick in contact\n"
            "Faults    none\n");
  run.figures->contact_ticks = run.figures->touches = 1;
  run.figures->contact_s = 0.001;
  EXPECT_THAT(closingSummary(run), HasSubstr("Contact   0.001 s of 0 s, one touch, over 0 mm of surface\n"
                                             "Felt      force median 0 N, at most 0 N; "
                                             "no depth, for it knows no surface\nEnergy    no contact\nServo"));
  EXPECT_EQ(verdict(run, *run.figures),
            "The tool touched the surface for 0.001 s of 0 s and no force above 0.05 N was reached, "
            "so that nobody feels it: at most 0 N; nothing was edited; no fault.");
}

TEST(Words, FaultsAreCountedByKind) {
  EXPECT_EQ(faultWord(0), "no fault");
  EXPECT_EQ(faultWord(1), "1 kind of fault");
  EXPECT_EQ(faultWord(2), "2 kinds of fault");
}

TEST(Words, SavesSayHowOftenAndWhatFailed) {
  TouchRun run = sampleRun();
  run.scene.save = "a.vdb";
  EXPECT_EQ(saveWords(run), "saved 2 times in a.vdb up to edit 3, 2 KiB, at most 0.5 s");
  EXPECT_THAT(closingSummary(run), HasSubstr("; saved 2 times in a.vdb"));
  run.edits->saves = 0;
  run.edits->save_failures = 3;
  EXPECT_EQ(saveWords(run), "never saved in a.vdb, 3 failed");
  run.edits->refused = 7;
  EXPECT_THAT(closingSummary(run), HasSubstr("; 7 refused"));
}

TEST(Words, QuietSaysWhatWasTakenAndNeverContradictsItself) {
  RunFigures figures;
  figures.energy_end_J = 1.5e-3;
  ContactStability quiet;
  quiet.verdict = ContactVerdict::kQuiet;
  quiet.allowed_J = 0.02e-3;
  EXPECT_EQ(stabilityWords(quiet, figures),
            "quiet: the surface took 1.5 mJ from the hand, and no contact gave more than it had taken");
  // Encoders may leave a little less than nothing.
  figures.energy_end_J = -0.01e-3;
  quiet.error_J = 0.015e-3;
  quiet.stored_J = 3e-3;
  EXPECT_EQ(stabilityWords(quiet, figures),
            "quiet: "
            "the surface gave the hand 0.01 mJ, which is within the 0.02 mJ that are left open over all contacts, "
            "and no contact gave more than it had taken (the encoders leave 0.015 mJ open)");
}

TEST(Words, QuietSaysWhereTheEncodersAreTooCoarseToTell) {
  ContactStability quiet;
  quiet.verdict = ContactVerdict::kQuiet;
  quiet.stored_J = 0.1e-3;
  quiet.error_J = 0.2e-3;
  EXPECT_EQ(stabilityWords(quiet, RunFigures{}),
            "quiet as far as the encoders can tell: "
            "they leave 0.2 mJ open in one contact, and at most 0.1 mJ was stored; finer encoders would tell more");
}

TEST(Words, SlightlyActiveNamesTheSource) {
  ContactStability active;
  active.verdict = ContactVerdict::kSlightlyActive;
  active.source = ActivitySource::kSampledWall;
  EXPECT_THAT(stabilityWords(active, {}), HasSubstr("K T / 2 does so; more --damping or a higher --rate"));
  active.delay_ticks = 3;
  EXPECT_THAT(
      stabilityWords(active, {}),
      HasSubstr("less damping than K T (1/2 + 3) does so; more --damping, a shorter --delay or a higher --rate"));
  ContactStability swings = active;
  swings.verdict = ContactVerdict::kUnstable;
  EXPECT_THAT(stabilityWords(swings, {}), HasSubstr("; lower --stiffness or --delay, raise --rate,"));
  active.source = ActivitySource::kField;
  EXPECT_THAT(stabilityWords(active, {}), HasSubstr("it is the field"));
  EXPECT_THAT(stabilityWords(active, {}), HasSubstr(", or --passivity control, lessens it"));
  active.source = ActivitySource::kEdits;
  EXPECT_THAT(stabilityWords(active, {}), HasSubstr("; the volume was edited under the tool"));
  RunFigures controlled;
  controlled.damped_ticks = 1;
  for (const auto source : {ActivitySource::kSampledWall, ActivitySource::kField}) {
    active.source = source;
    EXPECT_THAT(stabilityWords(active, controlled), Not(HasSubstr("--passivity")));  // followed already
  }
}

TEST(Words, ActiveContactsToTheLetter) {
  ContactStability s;
  s.verdict = ContactVerdict::kSlightlyActive;
  s.source = ActivitySource::kSampledWall;
  s.given_J = 0.2e-3;
  s.error_J = 0.05e-3;
  s.stored_J = 1.5e-3;
  RunFigures controlled;
  controlled.damped_ticks = 1;
  const std::string begin =
      "slightly active: a contact gave the hand 0.2 mJ more than it had taken (the encoders leave 0.05 mJ open), "
      "where at most 1.5 mJ was stored at once, and the tool did not keep swinging; ";
  EXPECT_EQ(stabilityWords(s, controlled),
            begin +
                "a sampled wall with less damping than K T / 2 does so; "
                "more --damping or a higher --rate lessens it; the controller acted in 1 tick");
  EXPECT_EQ(stabilityWords(s, {}), begin +
                                       "a sampled wall with less damping than K T / 2 does so; "
                                       "more --damping or a higher --rate, or --passivity control, lessens it");
  s.source = ActivitySource::kField;
  EXPECT_EQ(stabilityWords(s, {}),
            begin +
                "the damping is enough for this stiffness and rate, so it is the field: "
                "where samples are few or noisy its normals are not those of its surface; "
                "--filter gaussian:1 or --algorithm god-object, or --passivity control, lessens it");
  s.verdict = ContactVerdict::kUnstable;
  s.bounces = 1;
  s.swing_m = 0.8e-3;
  s.swing_hz = 31;
  s.unstable_from_s = 1.25;
  s.unstable_to_s = 4.5;
  EXPECT_EQ(stabilityWords(s, {}),
            "unstable: from 1.25 s to 4.5 s the tool swung against the surface by 0.8 mm at 31 Hz without settling, "
            "1 bounce in all, and the surface fed it; lower --stiffness, "
            "raise --rate, or raise --damping; --passivity control lessens it");
  s.most_damping_Ns_per_m = 58;
  EXPECT_THAT(stabilityWords(s, {}), HasSubstr("raise --rate, or raise --damping to 58 at most; --passivity"));
  s.damps_too_much = true;
  EXPECT_THAT(stabilityWords(s, {}), HasSubstr("raise --rate, or lower --damping to 58 at most; --passivity"));
  EXPECT_EQ(stabilityWords({}, {}), "no contact");
}

TEST(Words, SlightlyActiveSaysByHowMuchAndThatItSettled) {
  ContactStability active;
  active.verdict = ContactVerdict::kSlightlyActive;
  active.given_J = 0.2e-3;
  active.stored_J = 1.5e-3;
  RunFigures figures;
  figures.damped_ticks = 34;
  const std::string text = stabilityWords(active, figures);
  EXPECT_THAT(text,
              ::testing::StartsWith("slightly active: a contact gave the hand 0.2 mJ more than it had taken, "
                                    "where at most 1.5 mJ was stored at once, and the tool did not keep swinging; "));
  EXPECT_THAT(text, EndsWith("; the controller acted in 34 ticks"));
  TouchRun run = sampleRun();
  run.stability = active;
  EXPECT_THAT(verdictOf(run), HasSubstr("; the contact was slightly active; "));
}

TEST(Words, UnstableSaysWhatToChange) {
  TouchRun run = sampleRun();
  run.stability.verdict = ContactVerdict::kUnstable;
  run.stability.bounces = 96;
  run.stability.swing_m = 0.8e-3;
  run.stability.swing_hz = 31;
  run.stability.unstable_from_s = 1.25;
  run.stability.unstable_to_s = 4.5;
  const std::string text = closingSummary(run);
  EXPECT_THAT(
      text, HasSubstr("Energy    unstable: from 1.25 s to 4.5 s the tool swung against the surface by 0.8 mm at 31 Hz "
                      "without settling, 96 bounces in all, and the surface fed it; "));
  EXPECT_THAT(text, Not(HasSubstr("quiet")));
  for (const std::string& words : {text, verdictOf(run)}) {
    for (const char* remedy : {"lower --stiffness", "raise --rate", "--damping", "--passivity control"})
      EXPECT_THAT(words, HasSubstr(remedy));
  }
  EXPECT_THAT(verdictOf(run), HasSubstr("felt at most 0.5 N; the contact was unstable: lower --stiffness"));
  // No advice that was followed already.
  run.records[2500].damped = true;
  EXPECT_THAT(verdictOf(run), Not(HasSubstr("--passivity")));
  EXPECT_THAT(closingSummary(run), Not(HasSubstr("--passivity")));
}

TEST(Words, ClosingSummarySaysThatTheClockWasSimulated) {
  TouchRun run = sampleRun();
  run.scene.simulated_clock = true;
  EXPECT_THAT(closingSummary(run), HasSubstr("no times measured"));
  EXPECT_THAT(closingSummary(run), Not(HasSubstr("us median")));
}

TEST(Words, NumbersAndBytes) {
  EXPECT_EQ(shortNumber(0.12345), "0.123");
  EXPECT_EQ(shortNumber(1234.5), "1235");
  EXPECT_EQ(shortNumber(0), "0");
  EXPECT_EQ(shortNumber(9'999'999), "9999999");
  EXPECT_EQ(shortNumber(1e7), "1e+07");
  EXPECT_EQ(shortNumber(-99.95), "-100");
}

// Halves go up, as people round, and not to the digit that is even.
TEST(Words, NumbersRoundHalvesAwayFromZero) {
  for (const auto& [value, text] : {std::pair(114.5, "115"),
                                    {115.5, "116"},
                                    {-114.5, "-115"},
                                    {12.25, "12.3"},
                                    {12.35, "12.4"},
                                    {1.125, "1.13"},
                                    {0.0625, "0.0625"},
                                    {0.00012345, "0.000123"},
                                    {99.95, "100"},
                                    {99.94, "99.9"},
                                    {999.5, "1000"},
                                    {1e-9, "1e-09"}})
    EXPECT_EQ(shortNumber(value), text) << value;
}

// To three digits, whatever the number: within half a unit of the third.
TEST(Words, NumbersKeepThreeDigits) {
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    const double value = std::pow(10.0, std::uniform_real_distribution<double>(-12, 6.9)(random));
    const double unit = value >= 100 ? 1 : std::pow(10.0, std::floor(std::log10(value)) - 2);
    EXPECT_NEAR(std::stod(shortNumber(value)), value, 0.5 * unit * (1 + 1e-9)) << value;
  }
  EXPECT_EQ(shortNumber(std::nan("")), "nan");
  EXPECT_EQ(shortNumber(1e-320), "1e-320");
}

// A run of 5 s of which 206 grid points were left out is still one of 5 s, and the words say how many were.
TEST(Words, TimesAndTicksLeftOutAgree) {
  TouchRun run = sampleRun();
  run.records.erase(run.records.begin() + 2000, run.records.begin() + 2200);
  run.records.resize(run.records.size() - 6);  // behind the last record
  run.grid_points = 5000;
  run.faults.clear();
  run.edits.reset();
  EXPECT_THAT(verdictOf(run), ::testing::StartsWith("The tool touched the surface for 3 s of 5 s, "));
  EXPECT_THAT(closingSummary(run), HasSubstr("4794 ticks, 0 late, 206 left out; "));
}

TEST(Words, VerdictTellsWhatThePathDidNotKeep) {
  TouchRun run = sampleRun();
  run.edits.reset();
  run.faults.clear();
  for (std::size_t i = 2500; i < 2800; ++i) run.records[i].in_contact = false;
  run.records.back().in_contact = true;
  run.stability = {};
  EXPECT_THAT(verdictOf(run), HasSubstr("felt at most 0.5 N; it left the surface for 0.3 s of the slide; "
                                        "the retreat touched the object again; the retreat ended in contact; "));
}

}  // namespace words_test
}  // namespace palpate
