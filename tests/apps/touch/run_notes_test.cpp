// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/run_notes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

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
  scene.encoder_resolution_m = 0.049e-3;
  EXPECT_FALSE(noteOnEncoders(scene));
  scene.encoder_resolution_m = 0.2e-3;
  EXPECT_THAT(noteOnEncoders(scene).value_or(""), HasSubstr("encoders, 0.2 mm, changes the force by 0.4 N"));
  scene.algorithm = "haptization";
  EXPECT_FALSE(noteOnEncoders(scene));
}

// texture.hpp: at most 0.276 wavelengths.
TEST(RunNotes, TellOfATextureThatIsCutOff) {
  Scene scene;
  scene.texture_amplitude_m = 1e-3;
  scene.texture_wavelength_m = 1e-3;
  EXPECT_FALSE(noteOnTexture(scene));
  scene.texture = "procedural";
  EXPECT_THAT(noteOnTexture(scene).value_or(""), HasSubstr("amplitude is 0.276 mm instead of 1 mm"));
  scene.texture_amplitude_m = 0.27e-3;
  EXPECT_FALSE(noteOnTexture(scene));
}

}  // namespace
}  // namespace palpate
