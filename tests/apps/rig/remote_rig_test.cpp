// SPDX-License-Identifier: Apache-2.0
// A rig whose servo is behind a channel, here in a thread of the same process: the same records, bit for bit, as with
// the servo beside it, whatever changes meanwhile; and what becomes of it when either side is gone.
#include <atomic>
#include <chrono>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include "apps/rig/remote_windows.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "apps/servo_side/remote_servo.hpp"
#include "apps/servo_side/servo_host.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/phantoms/phantom.hpp"
#include "servo/meshes/mesh_object.hpp"
#include "servo/safety/faults.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/open_descriptors.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace remote_rig_test {

using testing::HasSubstr;

// A servo's side in a thread.
class Host {
 public:
  Host() {
    auto [ours, theirs] = channelPair();
    channel_ = std::move(ours);
    thread_ = std::thread([this, theirs = std::move(theirs)]() mutable {
      try {
        ServoHost(false, "").serve(std::move(theirs));
      } catch (const Error& error) {
        ended_with = error.what();
      }
    });
  }
  ~Host() {
    channel_.close();
    join();
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  Channel takeChannel() { return std::move(channel_); }
  void join() {
    if (thread_.joinable()) thread_.join();
  }
  std::string ended_with;

 private:
  Channel channel_;
  std::thread thread_;
};

class RemoteRig : public testing::Test {
 protected:
  RemoteRig() : phantom(makePhantom("phantom:sphere?size=48")), volume(makeVolume(*phantom)) {
    scene.volume = "phantom:sphere?size=48";
    scene.simulated_clock = true;
    scene.duration_s = 0.9;
    const Vec3 centre_W = volume.lattice().toWorld(0.5 * (volume.size() - Vec3i::Ones()).cast<double>());
    double radius_m = 0;
    while (phantom->offset(centre_W + radius_m * Vec3::UnitX()).distance_m < 0) radius_m += 1e-6;
    const auto below = [&](double depth_m) { return Vec3(centre_W + (radius_m - depth_m) * Vec3::UnitX()); };
    path.emplace(std::vector<double>{0, 0.1, 1.0}, std::vector<Vec3>{below(-4e-3), below(1e-3), below(1e-3)},
                 SampledPath::Interpolation::kCubic);
    other_isovalues.other_isovalues = true;
  }

  using Act = std::function<void(TouchRig& rig, std::int64_t tick)>;
  RigVolume rigVolume() const { return {.scale = densityScaleOf(volume, phantom->isovalue()), .isosurface = mesh}; }

  LoopResult local(const Act& act) {
    Engine engine(volume, makePlan(other_isovalues), phantom->isovalue(), "");
    const auto device = makeDevice(scene.device, deviceSetup(scene, *path));
    TouchRig rig(engine, *device, loopParameters(scene), rigVolume(), rigSettings(scene, phantom->isovalue()));
    return rig.runSimulated({}, [&](std::int64_t tick, std::int64_t) { act(rig, tick); });
  }
  LoopResult remote(const Act& act) {
    Host host;
    RemoteServo servo(host.takeChannel(), {.scene = scene, .box = {}, .way = &*path, .window_samples = 32 * 32 * 32});
    Engine engine(volume, makePlan(other_isovalues), phantom->isovalue(), "");
    publishTo(servo, engine);
    TouchRig rig(engine, servo, loopParameters(scene), rigVolume(), rigSettings(scene, phantom->isovalue()));
    LoopResult result = rig.runSimulated({}, [&](std::int64_t tick, std::int64_t) { act(rig, tick); });
    host.join();
    EXPECT_EQ(host.ended_with, "");
    return result;
  }
  void expectSame(const Act& act) {
    const LoopResult here = local(act), there = remote(act);
    ASSERT_GT(here.records.size(), 100U);
    ASSERT_EQ(there.records.size(), here.records.size());
    EXPECT_EQ(std::memcmp(there.records.data(), here.records.data(), here.records.size() * sizeof(TickRecord)), 0);
    EXPECT_EQ(there.ticks_run, here.ticks_run);
    EXPECT_EQ(there.ticks_skipped, here.ticks_skipped);
    EXPECT_EQ(there.released, here.released);
    EXPECT_EQ(there.device.force_limit_N, here.device.force_limit_N);
  }

  std::unique_ptr<Phantom> phantom;
  Volume volume;
  Scene scene;
  std::optional<SampledPath> path;
  EngineRequest other_isovalues;
  std::shared_ptr<const ContactObject> mesh;
};

TEST_F(RemoteRig, FeelsTheSameBitForBit) {
  expectSame([](TouchRig&, std::int64_t) {});
  scene.spring_hand = true;
  scene.encoder_resolution_m = 50e-6;
  scene.texture = "procedural";
  scene.friction_static = 0.4;
  scene.stiffness_density = {{0, 1}, {100, 2}};
  expectSame([](TouchRig&, std::int64_t) {});
}

TEST_F(RemoteRig, TakesTheIsosurfacesMesh) {
  scene.algorithm = "god-object";
  mesh = std::make_shared<const MeshObject>(isosurfaceMesh(volume, phantom->isovalue()), "isosurface");
  expectSame([](TouchRig&, std::int64_t) {});
}

// Other algorithms, settings and isovalues while it runs, and an early end: taken in the same ticks.
TEST_F(RemoteRig, ChangesInTheSameTicks) {
  const char* const names[] = {"hri", "blezek", "implicit", "hri-paper"};
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const auto act = [&](const std::shared_ptr<Seeded>& random) {
      return [&names, random](TouchRig& rig, std::int64_t tick) {
        if (tick == 800) rig.requestStop();
        if (tick < 50 || random->pick(25) != 0) return;
        RigSettings next = rig.settings();
        next.algorithm = names[random->pick(4)];
        next.parameters.stiffness_N_per_m = random->logBetween(50, 3000);
        next.parameters.plane_renewal_ticks = 1 + random->pick(20);
        next.force_limit_N = random->logBetween(0.1, 8);
        if (random->pick(3) == 0) next.parameters.isovalue = static_cast<float>(random->between(-0.2, 0.2));
        rig.change(next);
      };
    };
    const LoopResult here = local(act(std::make_shared<Seeded>(seed)));
    const LoopResult there = remote(act(std::make_shared<Seeded>(seed)));
    ASSERT_EQ(here.records.size(), 801U);  // the tick of the request is the last
    ASSERT_EQ(there.records.size(), 801U);
    EXPECT_EQ(std::memcmp(there.records.data(), here.records.data(), here.records.size() * sizeof(TickRecord)), 0);
  }
}

TEST_F(RemoteRig, RunsByTheRealClock) {
  scene.simulated_clock = false;
  scene.duration_s = 1;
  Host host;
  RemoteServo servo(host.takeChannel(), {.scene = scene, .box = {}, .way = &*path, .window_samples = 32 * 32 * 32});
  Engine engine(volume, makePlan(other_isovalues), phantom->isovalue(), "");
  LinkMemory& memory = servo.memory();
  engine.shareWindows({&memory.windows(), memory.samples(), memory.capacity(), memory.windowBytes(), 1});
  TouchRig rig(engine, servo, loopParameters(scene), rigVolume(), rigSettings(scene, phantom->isovalue()));
  rig.start();
  RigSettings next = rig.settings();
  next.parameters.stiffness_N_per_m = 100;
  rig.change(next);
  const LoopResult run = rig.wait();
  EXPECT_GT(run.first_due_ns, 0);
  EXPECT_EQ(run.ticks_run + run.ticks_skipped, 1000);
  EXPECT_TRUE(run.released);
  std::int64_t contact = 0;
  for (const TickRecord& record : run.records) contact += record.in_contact ? 1 : 0;
  EXPECT_GT(contact, 100);
  // The stiffness that came later: 100 N/m, and 0.5 N s/m times a speed of some millimetres a second.
  const TickRecord& last = run.records.back();
  EXPECT_NEAR(asVec3(last.force_W).norm(), 100 * last.depth_m, 0.02);
  EXPECT_GT(last.depth_m, 0.9e-3);
}

// The engine's side vanishes in contact: the servo brings the force to zero, and says who is gone.
TEST_F(RemoteRig, TheServoEndsWithoutAnEngine) {
  scene.simulated_clock = false;
  scene.duration_s = 60;
  Host host;
  {
    RemoteServo servo(host.takeChannel(), {.scene = scene, .box = {}, .way = &*path, .window_samples = 32 * 32 * 32});
    servo.makeLoop(loopParameters(scene), rigSettings(scene, phantom->isovalue()), rigVolume(), nullptr);
    servo.start();
    while (servo.tool().latest().tick < 20) std::this_thread::yield();
  }
  host.join();  // and does not run for a minute
  EXPECT_TRUE(host.ended_with.empty() || host.ended_with.find("the engine: its process has ended") == 0)
      << host.ended_with;
}

// Told to stop before it began: it ends, without a word.
TEST_F(RemoteRig, TheServoEndsBeforeItBegan) {
  Host host;
  {
    MessageChannel channel(host.takeChannel(), "the servo");
    static_cast<void>(channel.expect<wire::HelloT>(5000));
    channel.send(wire::StopT{});
    host.join();  // while the channel is open
  }
  EXPECT_EQ(host.ended_with, "");
}

// What cannot be made there is refused with the words of one process.
TEST_F(RemoteRig, RefusalsComeBack) {
  scene.device = "recorded";
  scene.recording = "none.rec";
  Host host;
  EXPECT_THAT(
      refusalOf([&] { RemoteServo servo(host.takeChannel(), {.scene = scene, .box = {}, .window_samples = 512}); },
                Error::Code::kNotFound),
      HasSubstr("none.rec: the recording cannot be opened"));
  host.join();
  EXPECT_THAT(host.ended_with, HasSubstr("none.rec"));
}

// Messages where none may be: told, and the end.
TEST_F(RemoteRig, TheServoKeepsTheOrder) {
  const auto refused = [&](const std::function<void(MessageChannel&)>& say) {
    Host host;
    MessageChannel engine(host.takeChannel(), "the servo");
    static_cast<void>(engine.expect<wire::HelloT>(10'000));
    std::string words;
    try {
      say(engine);
      while (true) static_cast<void>(engine.receive(10'000));
    } catch (const Error& error) {
      words = error.what();
    }
    engine.close();
    host.join();
    return words;
  };
  wire::MakeDeviceT make;
  EXPECT_THAT(refused([&](MessageChannel& engine) {
                engine.send(wire::MakeDeviceT(make));
                static_cast<void>(engine.expect<wire::DeviceMadeT>(10'000));
                engine.send(wire::MakeDeviceT(make));
              }),
              HasSubstr("a second device"));
  EXPECT_THAT(refused([](MessageChannel& engine) { engine.send(wire::StartT{}); }), HasSubstr("what was not made"));
  EXPECT_THAT(refused([](MessageChannel& engine) { engine.send(wire::MakeLoopT{}); }),
              HasSubstr("a loop where none may be"));
  EXPECT_THAT(refused([](MessageChannel& engine) { engine.send(wire::GoT{}); }),
              HasSubstr("message Go where none may be"));
  make.way_points = 100;  // without any
  EXPECT_THAT(refused([&](MessageChannel& engine) { engine.send(wire::MakeDeviceT(make)); }),
              HasSubstr("shared memory"));
}

TEST_F(RemoteRig, LeavesNothingOpen) {
  const auto once = [&] { static_cast<void>(remote([](TouchRig&, std::int64_t) {})); };
  once();
  const long before = openDescriptors();
  for (int i = 0; i < 3; ++i) once();
  EXPECT_EQ(openDescriptors(), before);
}

// A servo that stays, in a thread, for engines one after another.
class StayingHost {
 public:
  StayingHost() : thread_([this] { run(); }) {}
  ~StayingHost() {
    stopped_ = true;
    thread_.join();
  }
  StayingHost(const StayingHost&) = delete;
  StayingHost& operator=(const StayingHost&) = delete;
  Channel connect() {
    auto [ours, theirs] = channelPair();
    const std::lock_guard lock(mutex_);
    next_ = std::move(theirs);
    return std::move(ours);
  }
  std::vector<std::string> ended_with() {
    const std::lock_guard lock(mutex_);
    return ended_with_;
  }

 private:
  void run() {
    ServoHost host(true, "");
    while (!stopped_) {
      std::unique_lock lock(mutex_);
      Channel channel = std::move(next_);
      lock.unlock();
      std::string why;
      try {
        if (channel.open()) host.serve(std::move(channel), [this] { return stopped_.load(); });
      } catch (const Error& error) {
        why = error.what();
      }
      lock.lock();
      if (!why.empty()) ended_with_.push_back(why);
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  Channel next_;
  std::vector<std::string> ended_with_;
  std::thread thread_;
};

class StayingServo : public RemoteRig {
 protected:
  StayingServo() {
    scene.simulated_clock = false;
    const SampledPath cubic = *path;
    path.emplace(cubic.times_s(), cubic.points_W(), SampledPath::Interpolation::kLinear);  // no deeper than 1 mm
    loop = loopParameters(scene);
    loop.ticks = 0;
    loop.record_ticks = 1;
  }

  // An engine for some time; the poses that it sees. `leaves`: it says so in the end; else its channel is closed, as
  // the system closes that of a process that was killed.
  std::vector<ToolPose> engineFor(Channel channel, const std::string& commit = "", double stiffness = 0) {
    std::vector<ToolPose> poses;
    const Vec3 start_W = path->position(0);
    RemoteServo servo(std::move(channel), {.scene = scene,
                                           .box = {},
                                           .way = &*path,
                                           .pointer = aims.empty() ? nullptr : &start_W,
                                           .told_ticks = told_ticks,
                                           .window_samples = 32 * 32 * 32,
                                           .commit = commit});
    EXPECT_TRUE(servo.stays());
    LiveTicks ticks(4096);
    if (told_ticks > 0) servo.tellTicksTo(ticks);
    Engine engine(volume, makePlan(other_isovalues), phantom->isovalue(), "");
    publishTo(servo, engine);
    first_versions.push_back(servo.firstVersion());
    RigSettings settings = rigSettings(scene, phantom->isovalue());
    if (stiffness > 0) settings.parameters.stiffness_N_per_m = stiffness;
    TouchRig rig(engine, servo, loop, rigVolume(), settings);
    std::atomic<std::int64_t> ticks_in_contact{0};
    rig.start([&](const ToolPose& pose, std::int64_t) {
      if (poses.empty() || poses.back().tick != pose.tick) poses.push_back(pose);
      if (pose.window_version >= servo.firstVersion() && pose.force_W.norm() > 0.1) ++ticks_in_contact;
    });
    for (int waited = 0; ticks_in_contact < 700 && waited < 5000; ++waited)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_GE(ticks_in_contact, 700);  // what a new engine adds comes in within EditEase::kTime_s
    for (int change = 1; change <= changes; ++change) {
      ServoChange next;
      next.force_limit_N = 3 + 0.1 * change;
      const std::uint64_t number = servo.give(std::move(next), settings);
      EXPECT_EQ(number, static_cast<std::uint64_t>(change));
      EXPECT_FALSE(servo.ended(number));
      for (int waited = 0; !servo.ended(number) && waited < 5000; ++waited)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      all_changes_ended = all_changes_ended && servo.ended(number);
    }
    if (!aims.empty()) {
      servo.aim(aims[first_versions.size() - 1]);
      std::this_thread::sleep_for(std::chrono::milliseconds(400));  // 20 time constants
    }
    rig.requestStop();
    const LoopResult result = rig.wait();
    EXPECT_TRUE(result.records.empty());
    told.clear();
    ticks.take(told);
    return poses;
  }

  LoopParameters loop;
  int changes = 0;  // that each engine gives
  std::size_t told_ticks = 0;
  std::vector<TickRecord> told;  // to the last engine
  std::vector<Vec3> aims;        // of each engine
  bool all_changes_ended = true;
  std::vector<std::uint64_t> first_versions;
};

// The same device and loop, one engine after another: ticks go on, windows are never taken for older ones, and each
// engine's settings hold.
TEST_F(StayingServo, GoesFromEngineToEngine) {
  StayingHost host;
  const std::vector<ToolPose> first = engineFor(host.connect());
  const std::vector<ToolPose> second = engineFor(host.connect(), "", 900);
  EXPECT_TRUE(host.ended_with().empty());
  ASSERT_EQ(first_versions.size(), 2U);
  EXPECT_GT(first_versions[1], first.back().window_version);
  EXPECT_LT(first.back().window_version, first_versions[1]);
  EXPECT_GT(second.front().tick, first.back().tick);
  EXPECT_GE(second.back().window_version, first_versions[1]);
  // 1 mm below the surface, the stiffness that each asked for.
  EXPECT_NEAR(first.back().force_W.norm(), stiffnessOf(scene) * 1e-3, 0.1);
  EXPECT_NEAR(second.back().force_W.norm(), 0.9, 0.15);
}

// What an engine before gave is no change of the next one's: neither counted nor taken.
TEST_F(StayingServo, CountsChangesByEngine) {
  StayingHost host;
  changes = 3;
  static_cast<void>(engineFor(host.connect()));
  const std::vector<ToolPose> second = engineFor(host.connect(), "", 900);
  EXPECT_TRUE(host.ended_with().empty());
  EXPECT_NEAR(second.back().force_W.norm(), 0.9, 0.15);
  EXPECT_TRUE(all_changes_ended);
}

// An engine of another scene gets a device that begins anew.
TEST_F(StayingServo, BeginsAnewWithAnotherScene) {
  StayingHost host;
  const std::vector<ToolPose> first = engineFor(host.connect());
  scene.encoder_resolution_m = 1e-4;
  const std::vector<ToolPose> second = engineFor(host.connect());
  EXPECT_LT(second.front().tick, first.back().tick);
}

// Killed when the servo had been told of its windows, and before there was one: the next engine is taken all the same.
TEST_F(StayingServo, LeavesAnEngineThatDiedBeforeItsFirstWindow) {
  StayingHost host;
  const std::vector<ToolPose> first = engineFor(host.connect());
  {
    Channel channel = host.connect();
    const int socket = channel.descriptor();
    RemoteServo servo(std::move(channel), {.scene = scene, .box = {}, .way = &*path, .window_samples = 32 * 32 * 32});
    servo.makeLoop(loop, rigSettings(scene, phantom->isovalue()), rigVolume(), nullptr);
    EXPECT_GT(servo.tool().latest().tick, first.back().tick);
    ASSERT_EQ(shutdown(socket, SHUT_RDWR), 0);
    for (int waited = 0; host.ended_with().empty() && waited < 5000; ++waited)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_THAT(host.ended_with(), testing::ElementsAre(HasSubstr("the engine: its process has ended")));
  }
  const std::vector<ToolPose> third = engineFor(host.connect());
  EXPECT_GT(third.front().tick, first.back().tick);
}

// Engine after engine is told of every tick, and its pointer leads the tool from the first aim on.
TEST_F(StayingServo, TellsItsTicksAndIsLedByEachEngine) {
  StayingHost host;
  told_ticks = 4096;
  const Vec3 pressed_W = path->position(path->duration_s());
  aims = {pressed_W + Vec3(0, 5e-4, 0), pressed_W - Vec3(0, 5e-4, 0)};  // the second engine finds it in contact, too
  for (int engine = 0; engine < 2; ++engine) {
    static_cast<void>(engineFor(host.connect()));
    ASSERT_GT(told.size(), 100U) << engine;
    std::int64_t missing = 0;
    for (std::size_t i = 1; i < told.size(); ++i) missing += told[i].tick - told[i - 1].tick - 1;
    EXPECT_LE(missing, 100) << engine;  // skipped ones alone, on a busy machine
    EXPECT_LT((asVec3(told.back().hip_W) - aims[static_cast<std::size_t>(engine)]).norm(), 1e-6) << engine;
  }
}

TEST_F(StayingServo, RefusesAnEngineOfAnotherVersionAndStays) {
  StayingHost host;
  EXPECT_THAT(refusalOf([&] { static_cast<void>(engineFor(host.connect(), "another")); }),
              HasSubstr("it was built from"));
  static_cast<void>(engineFor(host.connect()));
}

}  // namespace remote_rig_test
}  // namespace palpate
