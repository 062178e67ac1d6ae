// SPDX-License-Identifier: Apache-2.0
// The rig on a phantom's ball, by both clocks: what it feels is what its parts feel, and settings change while it runs.
#include "apps/rig/touch_rig.hpp"

#include <cstring>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "engine/phantoms/phantom.hpp"
#include "servo/devices/path.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/safety/faults.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace touch_rig_test {

using testing::HasSubstr;

constexpr double kDepth_m = 1e-3;

TEST(DensityScaleOf, GoesFromTheIsovalueUpToTheHighestDensity) {
  Lattice lattice;
  lattice.spacing_m = Vec3(3e-3, 1e-3, 2e-3);
  const Volume volume = Volume::fromDense({2, 2, 2}, lattice, {-5, 0, 1, 2, 3, 4, 40, 7}, {});
  EXPECT_EQ(densityScaleOf(volume, 15).contrast, 25);
  EXPECT_EQ(densityScaleOf(volume, -3).contrast, 43);
  EXPECT_EQ(densityScaleOf(volume, 15).voxel_m, 1e-3);
}

// A tool that comes from outside within 0.1 s and stays a millimetre below the surface of a ball.
class Rig : public testing::Test {
 protected:
  explicit Rig(const EngineRequest& request = {})
      : phantom(makePhantom("phantom:sphere?size=48")),
        volume(makeVolume(*phantom)),
        engine(volume, makePlan(request), phantom->isovalue(), "") {
    const Vec3 centre_W = volume.lattice().toWorld(0.5 * (volume.size() - Vec3i::Ones()).cast<double>());
    // Along +x from the middle, to where the phantom says that its surface is.
    double radius_m = 0;
    while (phantom->offset(centre_W + radius_m * Vec3::UnitX()).distance_m < 0) radius_m += 1e-6;
    const auto below = [&](double depth_m) { return Vec3(centre_W + (radius_m - depth_m) * Vec3::UnitX()); };
    path.emplace(std::vector<double>{0, 0.1, 1.0}, std::vector<Vec3>{below(-4e-3), below(kDepth_m), below(kDepth_m)},
                 SampledPath::Interpolation::kLinear);
    settings.parameters = {.isovalue = phantom->isovalue(), .stiffness_N_per_m = 500, .damping_Ns_per_m = 0};
    loop.ticks = 900;
    loop.real_time = false;
  }

  [[nodiscard]] TouchRig rig() { return {engine, device(), loop, {}, settings}; }
  SimulatedDevice& device() { return device_.emplace(SimulatedDeviceParameters{}, *path, loop.rate_hz); }
  // Of an algorithm that finds the surface: K D, within the 2 % that sampling of a ball of 40 voxels allows.
  static double newtons(const TickRecord& record) { return asVec3(record.force_W).norm(); }

  std::unique_ptr<Phantom> phantom;
  Volume volume;
  Engine engine;
  std::optional<SampledPath> path;
  RigSettings settings;
  LoopParameters loop;

 private:
  std::optional<SimulatedDevice> device_;
};

// By a thread that is nobody and may have no priority: the engine's thread has ended before start() throws.
TEST_F(Rig, ARefusedStartLeavesNobodyAtWork) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_RTPRIO, &before), 0);
  const rlimit none = {0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_RTPRIO, &none), 0);
  loop.real_time = loop.require_real_time = true;
  TouchRig touch = rig();
  const auto held = std::make_shared<int>(0);
  std::string refusal;
  std::thread([&] {
    constexpr uid_t kNobody = 65534;
    EXPECT_TRUE(geteuid() != 0 || syscall(SYS_setresuid, -1, kNobody, -1) == 0);  // of this thread alone
    refusal = refusalOf([&] { touch.start([held](const ToolPose&, std::int64_t) {}); }, Error::Code::kDevice);
  }).join();
  ASSERT_EQ(setrlimit(RLIMIT_RTPRIO, &before), 0);
  EXPECT_THAT(refusal, HasSubstr("SCHED_FIFO"));
  EXPECT_EQ(held.use_count(), 1);
  EXPECT_FALSE(touch.running());
}

TEST_F(Rig, FeelsWhatItsPartsFeelBitForBit) {
  TouchRig whole = rig();
  const std::vector<TickRecord> records = whole.runSimulated().records;
  Engine other(volume, makePlan({}), phantom->isovalue(), "");
  const auto algorithm = makeAlgorithm("hri", {.parameters = settings.parameters});
  ToolPoseMailbox tool;
  ServoLoop servo(loop, *algorithm, device(), other.exchange(), tool);
  const std::vector<TickRecord> parts =
      servo.runSimulated([&](std::int64_t, std::int64_t now_ns) { other.publishFor(tool.latest(), now_ns); }).records;
  ASSERT_EQ(records.size(), 900U);
  ASSERT_EQ(parts.size(), 900U);
  EXPECT_EQ(std::memcmp(records.data(), parts.data(), parts.size() * sizeof(TickRecord)), 0);
  EXPECT_NEAR(newtons(records.back()), 500 * kDepth_m, 0.02 * 500 * kDepth_m);
}

TEST_F(Rig, CallsFollowAndThenTheTickWithEachPose) {
  TouchRig one = rig();
  std::vector<std::int64_t> poses, ticks;
  const LoopResult result = one.runSimulated([&](const ToolPose& pose, std::int64_t) { poses.push_back(pose.tick); },
                                             [&](std::int64_t tick, std::int64_t) {
                                               ticks.push_back(tick);
                                               EXPECT_EQ(poses.size(), ticks.size());
                                               if (tick == 99) one.requestStop();
                                             });
  EXPECT_EQ(result.ticks_run, 100);  // the one before which it was asked for is the last
  ASSERT_EQ(poses.size(), 100U);
  ASSERT_EQ(ticks.size(), 100U);
  for (std::size_t i = 0; i < ticks.size(); ++i) EXPECT_EQ(ticks[i], static_cast<std::int64_t>(i));
  EXPECT_EQ(poses.front(), -1);
  EXPECT_EQ(poses.back(), 98);
}

// Each setting at tick 300. Within 0.1 s it is the new one, on a line: `most_N` of force in a tick.
TEST_F(Rig, TakesEverySettingWhileItRuns) {
  const auto endsWith = [&](double most_N, const std::function<void(RigSettings&)>& change) {
    TouchRig one = rig();
    const auto records = one.runSimulated({},
                                          [&](std::int64_t tick, std::int64_t) {
                                            if (tick != 300) return;
                                            RigSettings next = one.settings();
                                            change(next);
                                            one.change(next);
                                            EXPECT_EQ(one.settings(), next);
                                          })
                             .records;
    EXPECT_NEAR(newtons(records[299]), 0.5, 0.01);
    for (std::size_t i = 301; i < records.size(); ++i) {
      EXPECT_TRUE(records[i].in_contact) << i;
      EXPECT_LE(std::abs(newtons(records[i]) - newtons(records[i - 1])), most_N) << i;
    }
    return newtons(records.back());
  };
  EXPECT_NEAR(endsWith(0.0105, [](RigSettings& s) { s.parameters.stiffness_N_per_m = 1500; }), 1.5, 0.03);
  EXPECT_NEAR(endsWith((8 - 0.2) / 100 + 1e-9, [](RigSettings& s) { s.force_limit_N = 0.2; }), 0.2, 1e-9);
  EXPECT_NEAR(endsWith(0.001, [](RigSettings& s) { s.algorithm = "blezek"; }), 0.5, 0.01);
  // Half of K below a density that the phantom has nowhere above its isovalue, so everywhere.
  const double some = phantom->isovalue();
  EXPECT_NEAR(endsWith(0.003,
                       [&](RigSettings& s) {
                         s.effects.stiffness_by_density = {{some - 1e6, 0.5}, {some + 1e6, 0.5}};
                       }),
              0.25, 0.01);
}

// Sliders and buttons at random, faster than they are taken: in the end it is as if the rig had begun with the last
// settings. The force is min(K D, limit), with D to the 2 % of sampling.
TEST_F(Rig, RandomChangesEndAsTheLastOneSays) {
  const char* const names[] = {"hri", "blezek", "implicit"};
  // After the last change, the one under way and the last may each take EditEase::kTime_s.
  loop.ticks = 700 + 2 * 500 + 100;
  for (unsigned seed = 0; seed < 30; ++seed) {
    Seeded random(seed);
    TouchRig one = rig();
    RigSettings next = settings;
    const auto records = one.runSimulated({},
                                          [&](std::int64_t tick, std::int64_t) {
                                            if (tick < 150 || tick > 700 || random.pick(20) != 0) return;
                                            next.algorithm = names[random.pick(3)];
                                            next.parameters.stiffness_N_per_m = random.logBetween(50, 3000);
                                            next.parameters.damping_Ns_per_m = random.between(0, 2);
                                            next.parameters.plane_renewal_ticks = 1 + random.pick(20);
                                            next.effects.friction.viscous_Ns_per_m = random.pick(2) * 0.5;
                                            next.force_limit_N = random.logBetween(0.1, 8);
                                            one.change(next);
                                          })
                             .records;
    EXPECT_EQ(one.settings(), next);
    const double wanted_N = std::min(next.parameters.stiffness_N_per_m * kDepth_m, next.force_limit_N);
    EXPECT_NEAR(newtons(records.back()), wanted_N, 0.02 * wanted_N) << seed;
    for (std::size_t i = 150; i < records.size(); ++i) {
      ASSERT_TRUE(records[i].in_contact) << seed << " " << i;
      ASSERT_EQ(records[i].faults & kFadingFaults, 0U) << seed << " " << i;
    }
  }
}

TEST_F(Rig, RefusesWhatItCannotTakeAndChangesNothing) {
  TouchRig one = rig();
  const auto refusal = [&](const std::function<void(RigSettings&)>& change) {
    RigSettings next = one.settings();
    change(next);
    const std::string words = refusalOf([&] { one.change(next); });
    EXPECT_EQ(one.settings(), settings);
    EXPECT_EQ(words, refusalOf([&] { TouchRig(engine, device(), loop, {}, next); }));
    return words;
  };
  EXPECT_THAT(refusal([](RigSettings& s) { s.algorithm = "hapi"; }), HasSubstr("hapi"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.algorithm = "haptization"; }), HasSubstr("gradients everywhere"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.algorithm = "god-object"; }), HasSubstr("mesh"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.parameters.isovalue = std::numeric_limits<double>::quiet_NaN(); }),
              HasSubstr("isovalue"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.parameters.rate_hz = 2000; }), HasSubstr("rate 2000 Hz"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.parameters.stiffness_N_per_m = -1; }), HasSubstr("stiffness"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.effects.friction.dynamic_ratio = 0.3; }), HasSubstr("friction"));
  EXPECT_THAT(refusal([](RigSettings& s) { s.force_limit_N = 0; }), HasSubstr("force limit"));
  const auto records = one.runSimulated().records;
  EXPECT_NEAR(newtons(records.back()), 0.5, 0.01);
}

// What a rig feels in the end that began with another isovalue.
class OtherIsovalue : public Rig {
 protected:
  [[nodiscard]] std::vector<TickRecord> feltFromTheStart(double isovalue) {
    Engine other(volume, makePlan({}), isovalue, "");
    RigSettings begun = settings;
    begun.parameters.isovalue = isovalue;
    return TouchRig(other, device(), loop, {}, begun).runSimulated().records;
  }
  // `share` of the way from the isovalue to the density of the middle, or to that of the air.
  [[nodiscard]] double at(double share) const {
    const double to = share > 0 ? volume.maximum() : volume.minimum();
    return static_cast<float>(phantom->isovalue() + std::abs(share) * (to - phantom->isovalue()));
  }
};

// Outwards, inwards, and so far inwards that the tool is free: the force goes over to what it would be. Where it grows
// it does so no more abruptly than an edit that adds as much, over EditEase::kTime_s; else by a hundredth of the way in
// a tick.
TEST_F(OtherIsovalue, IsTakenWhileItRuns) {
  for (const double share : {-0.6, -0.2, 0.1, 0.6}) {
    const double isovalue = at(share);
    const std::vector<TickRecord> wanted = feltFromTheStart(isovalue);
    Engine own(volume, makePlan({}), phantom->isovalue(), "");
    TouchRig one(own, device(), loop, {}, settings);
    const auto records = one.runSimulated({},
                                          [&](std::int64_t tick, std::int64_t) {
                                            if (tick != 300) return;
                                            RigSettings next = one.settings();
                                            next.parameters.isovalue = isovalue;
                                            one.change(next);
                                            EXPECT_EQ(one.settings(), next);
                                            EXPECT_EQ(own.isovalue(), phantom->isovalue());
                                          })
                             .records;
    EXPECT_EQ(own.isovalue(), isovalue);
    EXPECT_EQ(one.takeRefusal(), std::nullopt);
    const double whole_N = newtons(wanted.back()) - newtons(records[299]);
    EXPECT_GT(std::abs(whole_N), 0.02) << share;  // another isosurface
    EXPECT_NEAR(newtons(records.back()), newtons(wanted.back()), 1e-3 * newtons(wanted.back())) << share;
    EXPECT_EQ(records.back().in_contact, share < 0.5);
    for (std::size_t i = 301; i < records.size(); ++i) {
      const double ticks = whole_N > 0 ? 500 : 100;
      EXPECT_LE(std::abs(newtons(records[i]) - newtons(records[i - 1])), 1.5 / ticks * std::abs(whole_N) + 1e-4) << i;
    }
    Engine fresh(volume, makePlan({}), isovalue, "");
    EXPECT_EQ(own.planFacts().gradient_bricks, fresh.planFacts().gradient_bricks);  // the last one's are gone
  }
}

// A run that ends in the middle of a transition. A look at the last tick but one publishes the new samples. The servo
// reads them in that tick, so the look at the last tick gives it the new isovalue, unless it was wanted a tick later.
// Once nobody reads them, the samples of the isovalue that is not in use are freed.
TEST_F(OtherIsovalue, IsLeftWithItsOwnSamplesAlone) {
  for (const std::int64_t late : {0, 1}) {
    const double wanted = at(0.6);
    const std::int64_t last = loop.ticks - 1;
    Engine own(volume, makePlan({}), phantom->isovalue(), "");
    TouchRig one(own, device(), loop, {}, settings);
    std::size_t of_both = 0;
    static_cast<void>(one.runSimulated({}, [&](std::int64_t tick, std::int64_t) {
      if (tick == last) of_both = own.planFacts().gradient_bricks;
      if (tick != last - 2 + late) return;
      RigSettings next = one.settings();
      next.parameters.isovalue = wanted;
      one.change(next);
    }));
    const double in_use = late == 0 ? wanted : phantom->isovalue();
    EXPECT_EQ(own.isovalue(), in_use) << late;
    Engine fresh(volume, makePlan({}), in_use, "");
    EXPECT_EQ(own.planFacts().gradient_bricks, fresh.planFacts().gradient_bricks) << late;
    EXPECT_LT(own.planFacts().gradient_bricks, of_both) << late;
  }
}

// Sliders that are pulled about: of all isovalues the last one is felt, with the settings that came with it or later.
TEST_F(OtherIsovalue, TheLastOfManyIsFelt) {
  const char* const names[] = {"hri", "blezek", "implicit"};
  // After the last change, those under way, of the settings and of the isovalue, may each take EditEase::kTime_s.
  loop.ticks = 500 + 3 * 500 + 200;
  for (unsigned seed = 0; seed < 20; ++seed) {
    Seeded random(seed);
    Engine own(volume, makePlan({}), phantom->isovalue(), "");
    TouchRig one(own, device(), loop, {}, settings);
    RigSettings next = settings;
    const auto records = one.runSimulated({},
                                          [&](std::int64_t tick, std::int64_t) {
                                            if (tick < 150 || tick > 500 || random.pick(25) != 0) return;
                                            if (random.pick(4) != 0)
                                              next.parameters.isovalue = at(random.between(-0.5, 0.5));
                                            if (random.pick(6) == 0) next.parameters.isovalue = phantom->isovalue();
                                            next.algorithm = names[random.pick(3)];
                                            next.parameters.stiffness_N_per_m = random.logBetween(100, 2000);
                                            next.force_limit_N = random.logBetween(0.1, 8);
                                            one.change(next);
                                          })
                             .records;
    EXPECT_EQ(one.settings(), next);
    EXPECT_EQ(own.isovalue(), next.parameters.isovalue);
    settings.algorithm = next.algorithm;
    settings.parameters = next.parameters;
    settings.force_limit_N = next.force_limit_N;
    const double wanted_N = newtons(feltFromTheStart(next.parameters.isovalue).back());
    EXPECT_NEAR(newtons(records.back()), wanted_N, 1e-3 * wanted_N) << seed;
    for (std::size_t i = 150; i < records.size(); ++i)
      ASSERT_EQ(records[i].faults & kFadingFaults, 0U) << seed << " " << i;
    settings =
        RigSettings{.parameters = {.isovalue = phantom->isovalue(), .stiffness_N_per_m = 500, .damping_Ns_per_m = 0}};
  }
}

// The engine has no isosurface there: what came with it is not taken either.
TEST_F(OtherIsovalue, ThatIsRefusedLeavesTheLastOne) {
  TouchRig one = rig();
  const auto records = one.runSimulated({},
                                        [&](std::int64_t tick, std::int64_t) {
                                          RigSettings next = one.settings();
                                          next.parameters.isovalue = volume.maximum() + 1;
                                          next.parameters.stiffness_N_per_m = 1000;
                                          if (tick == 300) one.change(next);
                                        })
                           .records;
  const std::optional<Error> refusal = one.takeRefusal();
  ASSERT_TRUE(refusal);
  EXPECT_THAT(refusal->what(), HasSubstr("there is no isosurface"));
  EXPECT_FALSE(one.takeRefusal());  // it was taken
  EXPECT_EQ(one.settings(), settings);
  EXPECT_NEAR(newtons(records.back()), 0.5, 0.01);
}

// An isovalue that no float holds: to change another setting is not to change it.
TEST_F(OtherIsovalue, IsAFloatsThatItIs) {
  Engine own(volume, makePlan({}), 0.1, "");
  settings.parameters.isovalue = 0.1;
  TouchRig one(own, device(), loop, {}, settings);
  EXPECT_EQ(one.settings().parameters.isovalue, static_cast<double>(0.1F));
  std::uint64_t windows = 0;
  const auto records = one.runSimulated({},
                                        [&](std::int64_t tick, std::int64_t) {
                                          if (tick == 300) windows = own.exchange().nextVersion();
                                          RigSettings next = one.settings();
                                          next.parameters.stiffness_N_per_m = 1000;
                                          next.parameters.isovalue = 0.1;
                                          if (tick == 300) one.change(next);
                                        })
                           .records;
  EXPECT_EQ(own.exchange().nextVersion(), windows);  // no window for another one was made
  EXPECT_NEAR(newtons(records.back()), 2 * newtons(records[299]), 0.01);
}

// A slider that moves before each tick, and another setting with it: isovalues are felt while it moves, not only when
// it rests.
TEST_F(OtherIsovalue, IsFeltWhileASliderMoves) {
  loop.ticks = 2400;
  Engine own(volume, makePlan({}), phantom->isovalue(), "");
  TouchRig one(own, device(), loop, {}, settings);
  std::set<double> felt;
  const auto records = one.runSimulated({},
                                        [&](std::int64_t tick, std::int64_t) {
                                          felt.insert(own.isovalue());
                                          if (tick < 150 || tick >= 1150) return;
                                          RigSettings next = one.settings();
                                          next.parameters.isovalue = at(-0.3e-3 * static_cast<double>(tick - 150));
                                          next.force_limit_N = 5 + 1e-3 * static_cast<double>(tick);
                                          one.change(next);
                                        })
                           .records;
  EXPECT_GE(felt.size(), 5U);  // each takes a tenth of a second, or half of one where the force grows
  EXPECT_EQ(own.isovalue(), one.settings().parameters.isovalue);
  const double wanted_N = newtons(feltFromTheStart(own.isovalue()).back());
  EXPECT_NEAR(newtons(records.back()), wanted_N, 1e-3 * wanted_N);
}

// A mesh is that of one isovalue.
TEST_F(OtherIsovalue, IsRefusedToAnAlgorithmWithAMesh) {
  TouchRig one(engine, device(), loop,
               {.isosurface = std::make_shared<MeshObject>(
                    TriangleMesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}}})},
               settings);
  RigSettings next = settings;
  next.algorithm = "god-object";
  next.parameters.isovalue = at(0.5);
  EXPECT_THAT(refusalOf([&] { one.change(next); }), HasSubstr("its mesh is that of"));
  EXPECT_EQ(one.settings(), settings);
}

// To begin with, the rig takes the engine's only: the gradients of another are not there.
TEST_F(OtherIsovalue, IsRefusedAtTheStart) {
  settings.parameters.isovalue = at(0.5);
  EXPECT_THAT(refusalOf([&] { static_cast<void>(rig()); }), HasSubstr("begin with that"));
}

TEST_F(Rig, ByTheRealClockItFeelsChangesAndTellsItsTicks) {
  loop.ticks = 0;
  loop.record_ticks = 1;
  TouchRig one = rig();
  one.keepTicks(4096);
  std::atomic<int> follows = 0;
  one.start([&](const ToolPose&, std::int64_t) { ++follows; });
  const auto waitFor = [&](const std::function<bool(const TickRecord&)>& seen) {
    for (int i = 0; i < 2000 && !seen(one.ticks().latest()); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_TRUE(seen(one.ticks().latest()));
  };
  waitFor([](const TickRecord& r) { return r.in_contact && std::abs(newtons(r) - 0.5) < 0.01; });
  RigSettings next = settings;
  next.parameters.stiffness_N_per_m = 1000;
  one.change(next);
  waitFor([](const TickRecord& r) { return std::abs(newtons(r) - 1) < 0.02; });
  next.force_limit_N = 0.3;
  one.change(next);
  waitFor([](const TickRecord& r) { return std::abs(newtons(r) - 0.3) < 1e-9; });
  next.force_limit_N = 5;
  one.change(next);
  waitFor([](const TickRecord& r) { return std::abs(newtons(r) - 1) < 0.02; });
  next.parameters.isovalue += 0.3 * (volume.maximum() - next.parameters.isovalue);
  one.change(next);
  waitFor([](const TickRecord& r) { return newtons(r) < 0.9; });  // its isosurface lies further inside
  EXPECT_TRUE(one.running());
  one.requestStop();
  const LoopResult result = one.wait();
  EXPECT_EQ(engine.isovalue(), next.parameters.isovalue);
  Engine fresh(volume, makePlan({}), engine.isovalue(), "");
  EXPECT_EQ(engine.planFacts().gradient_bricks, fresh.planFacts().gradient_bricks);  // the last one's are freed
  EXPECT_FALSE(one.running());
  EXPECT_TRUE(result.released);
  EXPECT_GT(follows, 10);
  std::vector<TickRecord> ticks;
  one.ticks().take(ticks);
  EXPECT_GT(ticks.size(), 100U);
}

// The engine's thread ends with an error: the run ends, and the error is the run's.
TEST_F(Rig, AFailureBesideTheServoEndsTheRun) {
  loop.ticks = 0;
  loop.record_ticks = 1;
  TouchRig one = rig();
  one.start(
      [](const ToolPose&, std::int64_t) { throw Error(Error::Code::kDevice, "GPU", "it is lost", "start again"); });
  EXPECT_THROW(static_cast<void>(one.wait()), Error);  // nobody has to look for it
  EXPECT_FALSE(one.running());
}

TEST_F(Rig, ThatIsDroppedWhileItRunsLetsGo) {
  loop.ticks = 0;
  loop.record_ticks = 1;
  std::optional<TouchRig> one;
  SimulatedDevice& hand = device();
  one.emplace(engine, hand, loop, RigVolume{}, settings);
  one->start();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  one.reset();
  EXPECT_EQ(hand.actingForce(), Vec3::Zero());
}

class RigWithAllGradients : public Rig {
 protected:
  RigWithAllGradients() : Rig({.gradient_all = true}) {}
};

TEST_F(RigWithAllGradients, GoesOverToAnAlgorithmThatReadsThemEverywhere) {
  TouchRig one = rig();
  const auto records = one.runSimulated({},
                                        [&](std::int64_t tick, std::int64_t) {
                                          RigSettings next = one.settings();
                                          next.algorithm = "haptization";
                                          if (tick == 300) one.change(next);
                                        })
                           .records;
  EXPECT_NEAR(newtons(records[299]), 0.5, 0.01);
  EXPECT_GT(newtons(records.back()), 0);
  EXPECT_EQ(asVec3(records.back().vhip_W), asVec3(records.back().hip_W));  // it shows no surface
}

}  // namespace touch_rig_test
}  // namespace palpate
