// SPDX-License-Identifier: Apache-2.0
// Recordings as bytes, back to the bit; cut and damaged ones; and a device that plays one back.
#include "servo/devices/recording.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/recording_device.hpp"
#include "servo/devices/simulated_device.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace recording_test {

using testing::HasSubstr;

Recording anyRecording(unsigned seed, int ticks) {
  Seeded random(seed);
  Recording r{.device = "any \xC3\xA9",
              .rate_hz = random.between(100, 20000),
              .contact = {random.between(0, 1e5), random.between(0, 100)}};
  r.limits = {.force_limit_N = random.between(0, 10),
              .position_resolution_m = random.between(0, 1e-4),
              .force_delay_ticks = random.pick(5),
              .slew_limit_N_per_s = random.between(0, 1e5),
              .sets_pace = random.pick(2) == 0,
              .follows_force = random.pick(2) == 0,
              .stiffness_limit_N_per_m = random.between(0, 2000),
              .workspace_radius_m = random.between(0, 1),
              .is_held = random.pick(2) == 0,
              .motion = {random.between(1, 1000), random.between(0, 1000)}};
  r.hands.resize(static_cast<std::size_t>(random.pick(4)));
  Vec3 at = Vec3::Zero();
  for (int i = 0; i < ticks; ++i) {
    RecordedTick t;
    t.elapsed_ticks = random.pick(3) == 0 ? random.pick(1000) : 1;
    t.answered = random.pick(5) != 0;
    if (random.pick(4) == 0) t.force_off = static_cast<ForceOff>(random.pick(7));
    if (random.pick(4) == 0) t.refused = static_cast<CalibrationRefusal>(random.pick(4));
    t.pressed = random.pick(2) == 0;
    t.leapt = random.pick(5) == 0;
    t.taken = random.pick(5) != 0;
    if (random.pick(2) == 0) at = random.inCube(1);
    if (random.pick(9) == 0) at.x() = -0.0;
    t.position_W = at;
    if (random.pick(2) == 0) t.report_age_ns = random.pick(1'000'000);
    t.held_differs = random.pick(3) == 0;
    if (t.held_differs) t.held_W = random.inCube(5);
    if (random.pick(4) == 0) t.boundary = {random.inCube(3), random.between(0, 1)};
    r.ticks.push_back(t);
  }
  return r;
}

// To the bit, signs of zeros included.
bool same(const RecordedTick& a, const RecordedTick& b) {
  const auto bits = [](const Vec3& u, const Vec3& v) {
    const auto equal = [](double x, double y) {
      return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    return std::equal(u.data(), u.data() + 3, v.data(), equal);
  };
  return a.elapsed_ticks == b.elapsed_ticks && a.force_off == b.force_off && a.refused == b.refused &&
         a.answered == b.answered && a.pressed == b.pressed && a.leapt == b.leapt && a.taken == b.taken &&
         a.held_differs == b.held_differs && a.report_age_ns == b.report_age_ns && bits(a.position_W, b.position_W) &&
         bits(a.held_W, b.held_W) && bits(a.boundary.force_W, b.boundary.force_W) &&
         a.boundary.stored_J == b.boundary.stored_J;
}

TEST(Recording, ComesBackToTheBit) {
  for (const int ticks : {1, 2, 100, 255, 256, 257, 9000}) {
    const Recording r = anyRecording(static_cast<unsigned>(ticks), ticks);
    const Recording back = readRecording(recordingBytes(r), "a");
    EXPECT_EQ(back.damage, "");
    EXPECT_EQ(back.device, r.device);
    EXPECT_EQ(back.rate_hz, r.rate_hz);
    EXPECT_EQ(back.contact.stiffness_N_per_m, r.contact.stiffness_N_per_m);
    EXPECT_EQ(back.contact.damping_Ns_per_m, r.contact.damping_Ns_per_m);
    EXPECT_EQ(back.limits.force_limit_N, r.limits.force_limit_N);
    EXPECT_EQ(back.limits.position_resolution_m, r.limits.position_resolution_m);
    EXPECT_EQ(back.limits.force_delay_ticks, r.limits.force_delay_ticks);
    EXPECT_EQ(back.limits.slew_limit_N_per_s, r.limits.slew_limit_N_per_s);
    EXPECT_EQ(back.limits.follows_force, r.limits.follows_force);
    EXPECT_EQ(back.limits.is_held, r.limits.is_held);
    EXPECT_EQ(back.limits.sets_pace, r.limits.sets_pace);
    EXPECT_EQ(back.limits.motion.speed_m_per_s, r.limits.motion.speed_m_per_s);
    EXPECT_EQ(back.limits.motion.acceleration_m_per_s2, r.limits.motion.acceleration_m_per_s2);
    EXPECT_EQ(back.limits.stiffness_limit_N_per_m, r.limits.stiffness_limit_N_per_m);
    EXPECT_EQ(back.limits.workspace_radius_m, r.limits.workspace_radius_m);
    ASSERT_EQ(back.hands.size(), r.hands.size());
    for (std::size_t i = 0; i < r.hands.size(); ++i) EXPECT_EQ(back.hands[i].hand_mass_kg, r.hands[i].hand_mass_kg);
    ASSERT_EQ(back.ticks.size(), r.ticks.size());
    for (std::size_t i = 0; i < r.ticks.size(); ++i) ASSERT_TRUE(same(back.ticks[i], r.ticks[i])) << i;
    EXPECT_EQ(back.gridTicks(), r.gridTicks());
  }
}

// SimulatedDevice holds a force back by 10'000 ticks at most. A session with it is read back.
TEST(Recording, MayHaveTheMostDelay) {
  Recording r = anyRecording(2, 3);
  r.limits.force_delay_ticks = 10'000;
  EXPECT_EQ(readRecording(recordingBytes(r), "a").limits.force_delay_ticks, 10'000);
}

// A tick at rest takes one byte.
TEST(Recording, IsCompact) {
  Recording r{.device = "d", .rate_hz = 1000};
  RecordedTick still;
  still.elapsed_ticks = 1;
  still.answered = true;
  r.ticks.assign(4096, still);
  EXPECT_LE(recordingBytes(r).size(), 4096U + 16 * 12 + 150U);  // twelve bytes a block
}

// Cut anywhere: what comes before the cut's block is there, and it is told; or it is refused.
TEST(Recording, OfACutFileGivesWhatIsWhole) {
  const Recording r = anyRecording(5, 10'000);
  const std::string bytes = recordingBytes(r);
  std::size_t least = 0;
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 50) {
    try {
      const Recording cut = readRecording(std::string_view(bytes).substr(0, length), "a.rec");
      EXPECT_THAT(cut.damage, HasSubstr("is cut short")) << length;
      EXPECT_TRUE(cut.ticks.size() % 256 == 0 || cut.ticks.size() == 10'000) << length;
      for (std::size_t i = 0; i < cut.ticks.size(); ++i) ASSERT_TRUE(same(cut.ticks[i], r.ticks[i])) << length;
      EXPECT_GE(cut.ticks.size(), least);
      least = cut.ticks.size();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_EQ(least, 0U);
    }
  }
  EXPECT_GE(least, 9728U);
  EXPECT_EQ(readRecording(bytes + "x", "a").damage, "1 bytes follow its end");
}

// Every changed bit is seen: in the header it is refused, in a block that block and what follows is left out.
TEST(Recording, OfADamagedFileGivesNothingWrong) {
  const Recording r = anyRecording(6, 60);
  const std::string bytes = recordingBytes(r);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    try {
      const Recording read = readRecording(damaged, "a");
      EXPECT_NE(read.damage, "") << bit;
      for (std::size_t i = 0; i < read.ticks.size(); ++i) ASSERT_TRUE(same(read.ticks[i], r.ticks[i])) << bit;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
    }
  }
}

TEST(Recording, RefusesWhatIsNone) {
  const auto refusal = [](const std::string& bytes) {
    return refusalOf([&] { static_cast<void>(readRecording(bytes, "a.rec")); });
  };
  EXPECT_THAT(refusal(""), HasSubstr("it is no recording"));
  EXPECT_THAT(refusal("PALPREC1" + std::string(500, 'x')), HasSubstr("of another form than PALPREC2"));
  EXPECT_THAT(refusal("PALPREC3"), HasSubstr("play it with the Palpate that recorded it"));
  EXPECT_THAT(refusal("PALPREC2"), HasSubstr("its header is damaged"));
  Recording none{.device = "d", .rate_hz = 1000};
  EXPECT_THAT(refusal(recordingBytes(none)), HasSubstr("no tick of it can be read"));
  for (const double rate : {0.0, -1.0, 1e9, std::nan("")}) {
    Recording odd = anyRecording(1, 3);
    odd.rate_hz = rate;
    EXPECT_THAT(refusal(recordingBytes(odd)), HasSubstr("its header is damaged")) << rate;
  }
  for (const double stiffness : {-1.0, HUGE_VAL, std::nan("")}) {
    for (double RecordedContact::*const part :
         {&RecordedContact::stiffness_N_per_m, &RecordedContact::damping_Ns_per_m}) {
      Recording odd = anyRecording(1, 3);
      odd.contact.*part = stiffness;
      EXPECT_THAT(refusal(recordingBytes(odd)), HasSubstr("its header is damaged")) << stiffness;
    }
  }
  Recording odd = anyRecording(1, 3);
  odd.limits.force_limit_N = -1;
  EXPECT_THAT(refusal(recordingBytes(odd)), HasSubstr("its header is damaged"));
  odd = anyRecording(1, 3);
  odd.hands = {{.hand_mass_kg = 0, .device_mass_kg = 0}};
  EXPECT_THAT(refusal(recordingBytes(odd)), HasSubstr("its header is damaged"));
  odd = anyRecording(1, 3);
  odd.limits.force_delay_ticks = 10'001;
  EXPECT_THAT(refusal(recordingBytes(odd)), HasSubstr("its header is damaged"));
  odd = anyRecording(1, 3);
  odd.ticks[1].elapsed_ticks = -4;
  EXPECT_THAT(refusal(recordingBytes(odd)), HasSubstr("no tick of it can be read"));
}

// A simulated device that is recorded and played back, under other forces: the same answers.
TEST(RecordedDevice, PlaysBackWhatWasRecorded) {
  const SampledPath path({0, 1}, {Vec3::Zero(), Vec3(0.1, 0.05, 0)}, SampledPath::Interpolation::kLinear);
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  p.force_limit_N = 2;
  RecordingDevice recorder(std::make_unique<SimulatedDevice>(p, path, 1000), 1000, 500);
  std::vector<Vec3> positions, held;
  for (int tick = 0; tick < 500; ++tick) {
    if (tick > 0) recorder.elapse(1);
    Vec3 at;
    ASSERT_TRUE(recorder.read(at));
    positions.push_back(at);
    EXPECT_EQ(recorder.reportAge_ns(), 0);
    static_cast<void>(recorder.boundary());
    const Vec3 force(0, 3 * std::sin(0.05 * tick), 0);
    ASSERT_TRUE(recorder.write(force));
    held.push_back(recorder.held(force));
  }
  const auto recording = std::make_shared<const Recording>(readRecording(recordingBytes(recorder.recording()), "a"));
  RecordedDevice player(recording);
  EXPECT_EQ(player.name(), "simulated, spring hand");
  EXPECT_EQ(player.limits().force_limit_N, 2);
  EXPECT_EQ(player.hands().size(), 1U);
  for (int tick = 0; tick < 500; ++tick) {
    if (tick > 0) player.elapse(1);
    Vec3 at;
    ASSERT_TRUE(player.read(at));
    EXPECT_EQ(at, positions[static_cast<std::size_t>(tick)]);
    EXPECT_EQ(player.reportAge_ns(), 0);
    EXPECT_TRUE(player.write(Vec3(0, 3 * std::sin(0.05 * tick), 0)));
    EXPECT_EQ(player.held(Vec3(0, 3 * std::sin(0.05 * tick), 0)), held[static_cast<std::size_t>(tick)]);
  }
  player.elapse(1);
  Vec3 at(1, 2, 3);
  EXPECT_FALSE(player.read(at));
  EXPECT_EQ(at, Vec3(1, 2, 3));
}

// A session whose servo left out grid points: until the next read was due there is nothing new.
TEST(RecordedDevice, KeepsToTheGridOfTheSession) {
  Recording r{.device = "d", .rate_hz = 1000};
  for (int i = 0; i < 4; ++i) {
    RecordedTick t;
    t.answered = i != 2;
    t.elapsed_ticks = i == 0 ? 0 : 3;
    t.position_W = Vec3(i, 0, 0);
    t.taken = i != 1;
    r.ticks.push_back(t);
  }
  EXPECT_EQ(r.gridTicks(), 10);
  RecordedDevice player(std::make_shared<const Recording>(r));
  std::vector<double> seen;
  std::vector<std::int64_t> ages_ms;
  std::vector<bool> answered, taken;
  for (int tick = 0; tick < 10; ++tick) {
    if (tick > 0) player.elapse(1);
    Vec3 at = Vec3::Constant(-1);
    answered.push_back(player.read(at));
    seen.push_back(at.x());
    ages_ms.push_back(player.reportAge_ns() / 1'000'000);
    taken.push_back(player.write(Vec3::Zero()));
  }
  EXPECT_THAT(seen, testing::ElementsAre(0, 0, 0, 1, 1, 1, -1, -1, -1, 3));
  // As old as it was in the session: its servo left these ticks out.
  EXPECT_THAT(ages_ms, testing::ElementsAre(0, 1, 2, 0, 1, 2, 0, 1, 2, 0));
  EXPECT_THAT(answered, testing::ElementsAre(true, true, true, true, true, true, false, false, false, true));
  EXPECT_THAT(taken, testing::ElementsAre(true, true, true, false, false, false, true, true, true, true));
}

TEST(RecordingDevice, KeepsNoMoreThanItHasRoomFor) {
  const SampledPath path({0}, {Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  RecordingDevice recorder(std::make_unique<SimulatedDevice>(SimulatedDeviceParameters{}, path, 1000), 1000, 3);
  for (int i = 0; i < 10; ++i) {
    Vec3 at;
    EXPECT_TRUE(recorder.read(at));
    EXPECT_TRUE(recorder.write(Vec3::Zero()));
  }
  EXPECT_EQ(recorder.recording().ticks.size(), 3U);
}

// What brings the force to zero after the last tick is no part of the session, though it reads and writes.
TEST(RecordingDevice, KeepsNothingOfTheEnd) {
  const SampledPath path({0}, {Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  SimulatedDeviceParameters p;
  p.force_limit_N = 2;
  RecordingDevice recorder(std::make_unique<SimulatedDevice>(p, path, 1000), 1000, 10);
  Vec3 at;
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(recorder.read(at));
    EXPECT_TRUE(recorder.write(Vec3(0, 0, 5)));
    EXPECT_EQ(recorder.held(Vec3(0, 0, 5)).z(), 2);
    recorder.elapse(1);
  }
  recorder.endRun();
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(recorder.write(Vec3(0, 0, 1)));
    EXPECT_EQ(recorder.held(Vec3(0, 0, 1)).z(), 1);
    recorder.elapse(1);
    EXPECT_TRUE(recorder.read(at));
  }
  const Recording recording = recorder.recording();
  ASSERT_EQ(recording.ticks.size(), 3U);
  EXPECT_TRUE(recording.ticks.back().held_differs);
  EXPECT_EQ(recording.ticks.back().held_W.z(), 2);
}

}  // namespace recording_test
}  // namespace palpate
