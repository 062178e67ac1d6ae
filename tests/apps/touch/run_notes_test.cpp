// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/run_notes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace run_notes_test {

using testing::HasSubstr;

// A second at 1 kHz above the isovalue of 3, in contact but for the ticks of `silent`.
std::vector<TickRecord> pressed(std::size_t silent_from, std::size_t silent_to) {
  std::vector<TickRecord> records(1000);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].time_s = static_cast<double>(i) / 1000;
    records[i].density = 3.5F;
    records[i].in_contact = i < silent_from || i >= silent_to;
  }
  return records;
}

TEST(RunNotes, TellOfATimeInTheObjectWithoutAForce) {
  EXPECT_FALSE(noteOnSilence(pressed(0, 0), 3, 1000, "hri-paper"));
  const auto note = noteOnSilence(pressed(400, 900), 3, 1000, "hri-paper");
  ASSERT_TRUE(note);
  EXPECT_THAT(*note, HasSubstr("for 0.5 s, from 0.4 s on, the tool was in the object and hri-paper gave neither"));
}

TEST(RunNotes, ShortSilencesAreContactsThatBegin) {
  EXPECT_FALSE(noteOnSilence(pressed(400, 419), 3, 1000, "hri"));
  EXPECT_TRUE(noteOnSilence(pressed(400, 420), 3, 1000, "hri"));
  EXPECT_FALSE(noteOnSilence(pressed(400, 420), 3, 2000, "hri"));  // half as long
}

// Two stretches count together; one that is too short does not count.
TEST(RunNotes, SilencesAddUp) {
  std::vector<TickRecord> records = pressed(100, 200);
  for (std::size_t i = 300; i < 350; ++i) records[i].in_contact = false;
  for (std::size_t i = 500; i < 505; ++i) records[i].in_contact = false;
  EXPECT_THAT(noteOnSilence(records, 3, 1000, "hri").value_or(""), HasSubstr("for 0.15 s, from 0.1 s on"));
}

TEST(RunNotes, AFaultOutsideOrAnUnknownPlaceIsNoSilence) {
  std::vector<TickRecord> records = pressed(400, 900);
  for (TickRecord& r : records) r.faults = bit(ServoFault::kInsideObject);
  EXPECT_FALSE(noteOnSilence(records, 3, 1000, "hri"));
  for (TickRecord& r : records) {
    r.faults = 0;
    r.density = 3;  // at the isovalue: background
  }
  EXPECT_FALSE(noteOnSilence(records, 3, 1000, "hri"));
  for (TickRecord& r : records) r.density = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(noteOnSilence(records, 3, 1000, "hri"));
}

TEST(RunNotes, TellOfEncodersThatAreFelt) {
  Scene scene;
  scene.stiffness_N_per_m = 2000;
  const auto steps = [](double m) { return DeviceLimits{.position_resolution_m = m}; };
  EXPECT_FALSE(noteOnEncoders(scene, steps(0.049e-3)));
  EXPECT_TRUE(noteOnEncoders(scene, steps(0.051e-3)));
  EXPECT_THAT(noteOnEncoders(scene, steps(0.2e-3)).value_or(""),
              HasSubstr("encoders, 0.2 mm, changes the force by 0.4 N"));
  scene.algorithm = "haptization";
  EXPECT_FALSE(noteOnEncoders(scene, steps(0.2e-3)));
}

// texture.hpp: at most 0.138 wavelengths.
TEST(RunNotes, TellOfATextureThatIsCutOff) {
  Scene scene;
  scene.texture_amplitude_m = 1e-3;
  scene.texture_wavelength_m = 1e-3;
  EXPECT_FALSE(noteOnTexture(scene));
  scene.texture = "procedural";
  EXPECT_THAT(noteOnTexture(scene).value_or(""),
              HasSubstr("amplitude is 0.138 mm instead of 1 mm: a wavelength of 1 mm holds no more"));
  scene.texture_amplitude_m = 0.137e-3;
  EXPECT_FALSE(noteOnTexture(scene));
}

TEST(RunNotes, NothingTouchedIsToldUnlessAFaultTellsWhy) {
  RunFigures figures;
  EXPECT_THAT(noteOnNoContact(figures, false, true).value_or(""), HasSubstr("the path meets no surface"));
  figures.faults = {{ServoFault::kOverrun, 3, 0}};
  EXPECT_TRUE(noteOnNoContact(figures, false, true));
  figures.faults.push_back({ServoFault::kInsideObject, 3, 0});
  EXPECT_FALSE(noteOnNoContact(figures, false, true));
  figures.faults.clear();
  figures.contact_ticks = 1;
  EXPECT_FALSE(noteOnNoContact(figures, false, true));
}

// K times the depth is the force: 500 N/m make 0.0035 N of 0.007 mm, and 0.5 N need 71429 N/m.
TEST(RunNotes, TellOfForcesThatNobodyFeels) {
  Scene scene;
  RunFigures figures;
  EXPECT_FALSE(noteOnFaintForce(scene, figures));  // nothing was touched
  figures.contact_ticks = 100;
  figures.depth_m.count = 100;
  figures.depth_m.max = 0.007e-3;
  figures.force_N.max = 0.0035;
  EXPECT_EQ(noteOnFaintForce(scene, figures).value_or(""),
            "no force above 0.05 N was reached, which is too little to feel: the tool pressed at most 0.007 mm deep, "
            "as fits so small or thin an object, and --stiffness 500 makes 0.0035 N of that; "
            "--stiffness 72000 would make 0.5 N of it, and a larger --depth more");
  scene.press_depth_m = 0.007e-3;
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""), HasSubstr("0.007 mm deep, and --stiffness"));
  scene.press_depth_m.reset();
  scene.path_file = "way.csv";  // nor is this path fitted to the object
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""), HasSubstr("0.007 mm deep, and --stiffness"));
  figures.depth_m.max = 0.001e-3;
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""),
              HasSubstr("--stiffness 100000, the most that it takes, would make 0.1 N of it: "
                        "raise --depth too for more, or write a larger voxel size"));
  scene.spring_hand = true;
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""), HasSubstr("; raise --depth or --hand-stiffness"));
  // No stiffness is named that a device may not render, and no object is called thin that a brush removes.
  scene.path_file.clear();
  scene.device = "polhem-v1";
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""), HasSubstr("0.001 mm deep, and --stiffness 500"));
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""), HasSubstr("; raise --stiffness as far as the device"));
  scene.device = "simulated";
  scene.edit = "remove:2";
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""), HasSubstr("0.001 mm deep, and --stiffness 500"));
  EXPECT_THAT(noteOnFaintForce(scene, figures).value_or(""),
              HasSubstr("; the brush changes the object under the tool"));
}

// A depth of 0.1 mm makes 0.05 N. Less force than that is then a limit's or a fault's doing.
TEST(RunNotes, FaintForcesAreToldWhereTheDepthIsTheReason) {
  Scene scene;
  RunFigures figures;
  figures.contact_ticks = figures.depth_m.count = 100;
  figures.depth_m.max = 0.101e-3;
  figures.force_N.max = 0.04;
  EXPECT_FALSE(noteOnFaintForce(scene, figures));
  figures.depth_m.max = 0.099e-3;
  EXPECT_TRUE(noteOnFaintForce(scene, figures));
  figures.force_N.max = 0.051;
  EXPECT_FALSE(noteOnFaintForce(scene, figures));
  figures.force_N.max = 0.04;
  figures.depth_m = {};  // an algorithm without a surface
  EXPECT_FALSE(noteOnFaintForce(scene, figures));
}

// The path may well meet a surface further on.
TEST(RunNotes, ARunThatEndedEarlyIsNotThePathsFault) {
  RunFigures figures;
  EXPECT_THAT(noteOnNoContact(figures, false, false).value_or(""), HasSubstr("the hand never came to the surface"));
  EXPECT_EQ(noteOnNoContact(figures, true, true).value_or(""), "nothing was touched until the run was ended");
  figures.contact_ticks = 1;
  EXPECT_FALSE(noteOnNoContact(figures, true, true));
}

const std::vector<PathPhase> kPhases = {{"approach", 0, 1}, {"press", 1, 2}, {"slide", 2, 4}, {"retreat", 4, 5}};

// A depth of 1 mm that was asked for: nine tenths of it are enough.
TEST(RunNotes, TellOfAHandThatGaveWay) {
  Scene scene;
  scene.spring_hand = true;
  scene.press_depth_m = 1e-3;
  RunFigures figures;
  figures.depth_m = {100, 0.5e-3, 0.5e-3, 0.5e-3, 0.5e-3, 0.6e-3};
  EXPECT_THAT(
      noteOnHand(scene, figures, kPhases).value_or(""),
      HasSubstr("a spring of 400 N/m and gave way to a surface of 500 N/m: it pressed at most 0.6 mm deep instead of "
                "--depth 1 (a larger --hand-stiffness presses deeper"));
  figures.depth_m.max = 0.91e-3;
  EXPECT_FALSE(noteOnHand(scene, figures, kPhases));
  figures.depth_m.max = 0.89e-3;
  EXPECT_TRUE(noteOnHand(scene, figures, kPhases));
  for (const auto change : {+[](Scene&s, RunFigures&) { s.spring_hand = false; },
                            +[](Scene&s, RunFigures&) { s.press_depth_m.reset(); },       // as fits the object
                            +[](Scene&s, RunFigures&) { s.path_file = "way.csv"; },       // --depth is idle
                            +[](Scene&, RunFigures&f) { f.depth_m = Percentiles{}; }}) {  // no surface was felt
    Scene other = scene;
    RunFigures felt = figures;
    change(other, felt);
    EXPECT_FALSE(noteOnHand(other, felt, kPhases));
  }
  const auto phases = std::span(kPhases);
  EXPECT_TRUE(noteOnHand(scene, figures, phases.first(3)));
  EXPECT_FALSE(noteOnHand(scene, figures, phases.first(2)));  // ended in the middle of the press
}

// Contact from second 1 of 5 on, for so long.
RunFigures touchedFor(double contact_s) {
  RunFigures figures;
  figures.time_s = 5;
  figures.first_contact_s = 1;
  figures.contact_s = contact_s;
  figures.contact_ticks = static_cast<std::int64_t>(contact_s * 1000);
  return figures;
}

TEST(RunNotes, TellOfABrushThatLeavesNothingToFeel) {
  Scene scene;
  EXPECT_FALSE(noteOnBrush(scene, touchedFor(0.1)));
  scene.edit = "remove:radius=2mm";
  EXPECT_THAT(
      noteOnBrush(scene, touchedFor(0.1)).value_or(""),
      AllOf(HasSubstr("it felt the surface for 0.1 s only"), HasSubstr("--edit remove:radius=2mm:rate=20, it")));
  EXPECT_TRUE(noteOnBrush(scene, touchedFor(1.9)));
  EXPECT_FALSE(noteOnBrush(scene, touchedFor(2.1)));  // more than half of the 4 s
  EXPECT_FALSE(noteOnBrush(scene, RunFigures{}));     // nothing was touched, which has a note of its own
  scene.edit = "remove:radius=2mm:rate=20";
  EXPECT_FALSE(noteOnBrush(scene, touchedFor(0.1)));
  scene.edit = "add:radius=2mm";
  EXPECT_FALSE(noteOnBrush(scene, touchedFor(0.1)));
}

}  // namespace run_notes_test
}  // namespace palpate
