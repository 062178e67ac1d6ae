// SPDX-License-Identifier: Apache-2.0
// Clients who look on: their pictures on an engine whose volume changes, their pointers, their ticks.
#include "apps/serve/onlookers.hpp"

#include <array>
#include <chrono>
#include <functional>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/serve/picture_queue.hpp"
#include "base/descriptor.hpp"
#include "engine/draw/picture_image.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace onlookers_test {

using testing::HasSubstr;

constexpr ViewMemory::Room kRoom{.pixels = 200 * 150, .ticks = 16};

// A client's end.
struct Client {
  std::shared_ptr<Onlooker> onlooker;
  ViewMemory memory;
  LiveTicks ticks;
  PointerAim pointer;
  explicit Client(Onlookers& all)
      : onlooker(all.add(kRoom)),
        memory(Descriptor(fcntl(onlooker->descriptor(), F_DUPFD_CLOEXEC, 0)), kRoom),
        ticks(memory.ticks(), memory.tickRing(), kRoom.ticks),
        pointer(memory.aims()) {}
};

struct Drawn {
  std::unique_ptr<Phantom> phantom = makePhantom("phantom:sphere?size=32");
  Volume volume = makeVolume(*phantom);
  Engine engine{volume, makePlan({.edits = true, .draws = true}), phantom->isovalue(), ""};
  PictureQueue pictures;
  Onlookers onlookers;
  std::int64_t now_ns = 0;
  int edits = 0;
  bool busy = false;

  Drawn() { engine.allowEdits(brushProfile(volume, phantom->isovalue())); }
  [[nodiscard]] ViewRequest from(const Vec3& side_W, int width = 160, int height = 120) const {
    const Vec3 middle_W = volume.lattice().toWorld(Vec3::Constant(15.5));
    return {lookAt(middle_W, side_W, 0.1, Vec3::UnitZ(), width, height, 0.5), {}, DrawOrder::kCoarseFirst};
  }
  void edit(double radius_m = 11e-3) {
    EditCommand command;
    command.kind = ++edits % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3::Constant(15.5));
    command.radius_m = radius_m;
    engine.edit(std::array{command}, now_ns);
  }
  // As a service's engine does.
  void look() {
    now_ns += 1'000'000;
    std::this_thread::sleep_for(std::chrono::microseconds(100));  // the device works meanwhile
    static_cast<void>(pictures.view().look(engine, now_ns));
    const std::uint64_t version = engine.editVersion();
    if (pictures.drawOn(version, onlookers.mayBeInterrupted(version))) {
      onlookers.interrupt();
      busy = true;
    } else {
      busy = onlookers.drawOn(pictures.view(), version, now_ns);
    }
  }
  bool looksUntil(const std::function<bool()>& done, int most = 20'000) {
    for (int looks = 0; looks < most; ++looks) {
      if (done()) return true;
      look();
    }
    return done();
  }
  // The client's picture is the one that the engine draws of the volume as it is.
  void expectSeen(Client& client, const ViewRequest& view) {
    ASSERT_TRUE(looksUntil([&] {
      const ViewFrame& frame = client.memory.latest();
      return frame.camera == view.camera && frame.whole && frame.edit_version == engine.editVersion();
    }));
    const ViewFrame& frame = client.memory.latest();
    EXPECT_TRUE(frame.fine);
    const RenderedImage expected = engine.draw(view.camera);
    EXPECT_EQ(asImage(view.camera.width, view.camera.height, frame.pixels).rgba, expected.rgba);
  }
};

TEST(Onlookers, SeeEachItsOwnPictureAndEveryEdit) {
  Drawn drawn;
  Client one(drawn.onlookers), two(drawn.onlookers);
  const ViewRequest front = drawn.from(-Vec3::UnitY()), side = drawn.from(Vec3::UnitX(), 100, 150);
  drawn.onlookers.show(*one.onlooker, front);
  drawn.onlookers.show(*two.onlooker, side);
  drawn.expectSeen(one, front);
  drawn.expectSeen(two, side);
  for (int i = 0; i < 3; ++i) {
    drawn.edit();
    drawn.expectSeen(one, front);
    drawn.expectSeen(two, side);
  }
  ASSERT_TRUE(drawn.looksUntil([&] { return !drawn.busy; }));  // then there is nothing to do
  const std::uint64_t before = one.memory.latest().number;
  for (int i = 0; i < 200; ++i) {
    drawn.look();
    EXPECT_FALSE(drawn.busy);
  }
  EXPECT_EQ(one.memory.latest().number, before);
  // Another camera.
  const ViewRequest back = drawn.from(Vec3::UnitY(), 64, 48);
  drawn.onlookers.show(*one.onlooker, back);
  drawn.expectSeen(one, back);
  EXPECT_EQ(drawn.onlookers.failure(*one.onlooker), "");
}

// The same camera with another style is another picture.
TEST(Onlookers, AreNotGivenEachOthersPictures) {
  Drawn drawn;
  Client one(drawn.onlookers), two(drawn.onlookers);
  const ViewRequest plain = drawn.from(-Vec3::UnitY());
  ViewRequest normals = plain;
  normals.style.normals = true;
  drawn.onlookers.show(*one.onlooker, plain);
  drawn.onlookers.show(*two.onlooker, normals);
  drawn.expectSeen(one, plain);
  ASSERT_TRUE(drawn.looksUntil([&] { return two.memory.latest().whole; }));
  EXPECT_NE(two.memory.latest().pixels[60 * 160 + 80].rgba, one.memory.latest().pixels[60 * 160 + 80].rgba);
}

// Two that want to see the very same thing, and somebody who asks for a picture.
TEST(Onlookers, SeeTheSame) {
  Drawn drawn;
  Client one(drawn.onlookers), two(drawn.onlookers);
  const ViewRequest front = drawn.from(-Vec3::UnitY());
  drawn.onlookers.show(*one.onlooker, front);
  drawn.onlookers.show(*two.onlooker, front);
  drawn.expectSeen(one, front);
  drawn.expectSeen(two, front);
  drawn.onlookers.show(*two.onlooker, front);
  bool is_drawn = false;
  drawn.pictures.ask({.camera = front.camera, .style = {}},
                     [&](const PictureQueue::Picture&, const std::string&) { is_drawn = true; });
  EXPECT_TRUE(drawn.looksUntil([&] { return is_drawn; }));
  drawn.expectSeen(two, front);
}

// Edits come faster than what they change can be drawn: all get pictures nevertheless, and so does who asks for one.
TEST(Onlookers, TakeTurnsWhileEditsGoOnAndOn) {
  Drawn drawn;
  Client one(drawn.onlookers), two(drawn.onlookers), three(drawn.onlookers);
  int pictures = 0, asked = 0;
  for (Client* const client : {&one, &two, &three}) drawn.onlookers.show(*client->onlooker, drawn.from(-Vec3::UnitY()));
  const auto all = [&](std::uint64_t least) {
    return one.memory.latest().number >= least && two.memory.latest().number >= least &&
           three.memory.latest().number >= least && pictures >= 3;
  };
  EXPECT_TRUE(drawn.looksUntil([&] {
    drawn.edit();
    if (asked < pictures + 2) {  // one waits at any time
      ++asked;
      drawn.pictures.ask({.camera = drawn.from(Vec3::UnitX()).camera, .style = {}},
                         [&](const PictureQueue::Picture&, const std::string& failure) {
                           EXPECT_EQ(failure, "");
                           ++pictures;
                         });
    }
    return all(3);
  })) << one.memory.latest().number
      << ' ' << two.memory.latest().number << ' ' << three.memory.latest().number << ' ' << pictures;
}

// What cannot be drawn leaves the picture before, which follows the edits.
TEST(Onlookers, KeepTheirPictureWhereAnotherIsRefused) {
  Drawn drawn;
  Client one(drawn.onlookers), two(drawn.onlookers);
  const ViewRequest front = drawn.from(-Vec3::UnitY()), side = drawn.from(Vec3::UnitX());
  ViewRequest refused = front;
  refused.style.clips.assign(9, {});
  drawn.onlookers.show(*two.onlooker, refused);
  ASSERT_TRUE(drawn.looksUntil([&] { return !drawn.onlookers.failure(*two.onlooker).empty(); }));
  EXPECT_EQ(two.memory.latest().number, 0U);
  drawn.onlookers.show(*one.onlooker, front);
  drawn.expectSeen(one, front);
  drawn.onlookers.show(*one.onlooker, refused);
  ASSERT_TRUE(drawn.looksUntil([&] { return !drawn.onlookers.failure(*one.onlooker).empty(); }));
  EXPECT_THAT(drawn.onlookers.failure(*one.onlooker), HasSubstr("clip"));
  drawn.edit();
  drawn.expectSeen(one, front);
  drawn.onlookers.show(*one.onlooker, side);
  EXPECT_EQ(drawn.onlookers.failure(*one.onlooker), "");
  drawn.expectSeen(one, side);
  ViewRequest large = front;
  large.camera.width = 201;
  large.camera.height = 150;
  EXPECT_THAT(refusalOf([&] { drawn.onlookers.show(*one.onlooker, large); }), HasSubstr("room for 30000 pixels"));
}

TEST(Onlookers, ComeAndGo) {
  Drawn drawn;
  std::vector<std::unique_ptr<Client>> clients;
  for (std::size_t i = 0; i < Onlookers::kMost; ++i) clients.push_back(std::make_unique<Client>(drawn.onlookers));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(drawn.onlookers.add(kRoom)); }, Error::Code::kOutOfMemory),
              HasSubstr("look on already"));
  const ViewRequest front = drawn.from(-Vec3::UnitY());
  for (const auto& client : clients) drawn.onlookers.show(*client->onlooker, front);
  drawn.look();
  drawn.look();
  drawn.onlookers.remove(clients[0]->onlooker);  // whose turn it is
  clients.erase(clients.begin());
  for (const auto& client : clients) drawn.expectSeen(*client, front);
  Client late(drawn.onlookers);
  drawn.onlookers.show(*late.onlooker, front);
  drawn.expectSeen(late, front);
  for (const auto& client : clients) drawn.onlookers.remove(client->onlooker);
  drawn.onlookers.remove(late.onlooker);
  drawn.edit();
  ASSERT_TRUE(drawn.looksUntil([&] { return !drawn.busy; }));  // nobody is left
  drawn.look();
  EXPECT_FALSE(drawn.busy);
}

// Somebody goes who has had no turn yet: others are not kept waiting for it.
TEST(Onlookers, GoBeforeTheyHaveSeenAnything) {
  Drawn drawn;
  Client one(drawn.onlookers);
  drawn.onlookers.show(*one.onlooker, drawn.from(-Vec3::UnitY()));
  drawn.look();
  EXPECT_FALSE(drawn.onlookers.mayBeInterrupted(drawn.engine.editVersion()));
  drawn.onlookers.remove(one.onlooker);
  bool is_drawn = false;
  drawn.pictures.ask({.camera = drawn.from(Vec3::UnitX()).camera, .style = {}},
                     [&](const PictureQueue::Picture&, const std::string&) { is_drawn = true; });
  EXPECT_TRUE(drawn.looksUntil([&] { return is_drawn; }));
}

// On another engine all see its volume.
TEST(Onlookers, GoOnWithAnotherEngine) {
  Drawn drawn, other;
  Client one(drawn.onlookers);
  const ViewRequest front = drawn.from(-Vec3::UnitY());
  drawn.onlookers.show(*one.onlooker, front);
  drawn.expectSeen(one, front);
  other.edit();
  const RenderedImage expected = other.engine.draw(front.camera);
  drawn.onlookers.interrupt();
  const std::uint64_t before = one.memory.latest().number;
  LiveView view;
  const auto isSeen = [&] { return one.memory.latest().number > before && one.memory.latest().whole; };
  for (int looks = 0; looks < 20'000 && !isSeen(); ++looks) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    static_cast<void>(view.look(other.engine, drawn.now_ns += 1'000'000));
    static_cast<void>(drawn.onlookers.drawOn(view, other.engine.editVersion(), drawn.now_ns));
  }
  ASSERT_TRUE(isSeen());
  EXPECT_EQ(asImage(160, 120, one.memory.latest().pixels).rgba, expected.rgba);
}

TEST(Onlookers, LeadTheToolWhereOneMovedLast) {
  Onlookers all;
  Client one(all), two(all);
  EXPECT_EQ(all.takeAim(), std::nullopt);
  one.pointer.aim({1, 2, 3});
  EXPECT_EQ(all.takeAim(), Vec3(1, 2, 3));
  EXPECT_EQ(all.takeAim(), std::nullopt);
  two.pointer.aim({4, 5, 6});
  one.pointer.aim({1, 2, 3});  // again and again, as a window does at every frame
  EXPECT_EQ(all.takeAim(), Vec3(4, 5, 6));
  one.pointer.aim({1, 2, 3});
  EXPECT_EQ(all.takeAim(), std::nullopt);
  two.pointer.aim({std::nan(""), 5, 6});
  EXPECT_EQ(all.takeAim(), std::nullopt);
  one.pointer.aim({0, 0, 0});
  EXPECT_EQ(all.takeAim(), Vec3(0, 0, 0));
  const PointerTarget leap(Vec3(7, 8, 9), Vec3(7, 8, 10));
  two.pointer.aim(leap);
  EXPECT_EQ(all.takeAim(), leap);
  one.pointer.aim(PointerTarget(Vec3(0, 0, 0), Vec3(0, 0, 1)));  // of a window whose pointer rests
  EXPECT_EQ(all.takeAim(), std::nullopt);
  all.remove(one.onlooker);
  one.pointer.aim({9, 9, 9});
  EXPECT_EQ(all.takeAim(), std::nullopt);
}

TEST(Onlookers, AreToldEveryTick) {
  Onlookers all;
  Client one(all), two(all);
  std::vector<TickRecord> ticks(10);
  for (std::size_t i = 0; i < ticks.size(); ++i) ticks[i].tick = static_cast<std::int64_t>(i);
  all.pass(ticks);
  for (Client* const client : {&one, &two}) {
    std::vector<TickRecord> taken;
    client->ticks.take(taken);
    ASSERT_EQ(taken.size(), 10U);
    EXPECT_EQ(taken.back().tick, 9);
    EXPECT_EQ(client->ticks.latest().tick, 9);
  }
  // One who does not look misses some, and holds nobody up.
  for (int i = 0; i < 5; ++i) {
    all.pass(ticks);
    std::vector<TickRecord> taken;
    one.ticks.take(taken);
    EXPECT_EQ(taken.size(), 10U);
  }
  std::vector<TickRecord> taken;
  two.ticks.take(taken);
  EXPECT_EQ(taken.size(), 16U);
}

}  // namespace onlookers_test
}  // namespace palpate
