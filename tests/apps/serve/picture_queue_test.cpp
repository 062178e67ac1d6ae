// SPDX-License-Identifier: Apache-2.0
// Pictures that a service is asked for, on an engine whose volume changes all the while.
#include "apps/serve/picture_queue.hpp"

#include <array>
#include <chrono>
#include <thread>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace picture_queue_test {

struct Drawn {
  std::unique_ptr<Phantom> phantom = makePhantom("phantom:sphere?size=32");
  Volume volume = makeVolume(*phantom);
  Engine engine{volume, makePlan({.edits = true, .draws = true}), phantom->isovalue(), ""};
  Camera camera =
      lookAt(volume.lattice().toWorld(Vec3::Constant(15.5)), -Vec3::UnitY(), 0.1, Vec3::UnitZ(), 320, 240, 0.5);
  PictureQueue queue;
  std::int64_t now_ns = 0;
  int edits = 0;

  Drawn() { engine.allowEdits(brushProfile(volume, phantom->isovalue())); }
  // To and fro, all over what is seen.
  void edit() {
    EditCommand command;
    command.kind = ++edits % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3::Constant(15.5));
    command.radius_m = 11e-3;
    engine.edit(std::array{command}, now_ns);
  }
  void look() {
    now_ns += 1'000'000;
    std::this_thread::sleep_for(std::chrono::microseconds(100));  // the device works meanwhile
    static_cast<void>(queue.view().look(engine, now_ns));
    static_cast<void>(queue.drawOn(engine.editVersion(), true));
  }
};

// Edits come faster than what they change can be drawn anew.
TEST(PictureQueue, IsDoneWhileEditsGoOnAndOn) {
  Drawn drawn;
  int done = 0;
  for (int i = 0; i < 3; ++i) {
    drawn.queue.ask({.camera = drawn.camera, .style = {}},
                    [&](const PictureQueue::Picture& image, const std::string& failure) {
                      EXPECT_EQ(failure, "");
                      EXPECT_TRUE(image->complete());
                      ++done;
                    });
  }
  for (int looks = 0; looks < 3000 && done < 3; ++looks) {
    drawn.edit();
    drawn.look();
  }
  EXPECT_EQ(done, 3);
}

// A picture of 4096 x 4096 pixels takes 128 MiB until it is packed, which may take longer than drawing the next one.
TEST(PictureQueue, DrawsNoMoreThanAreLetGo) {
  Drawn drawn;
  std::vector<PictureQueue::Picture> kept;
  std::size_t done = 0;
  for (int i = 0; i < 6; ++i)
    drawn.queue.ask({.camera = drawn.camera, .style = {}}, [&](const PictureQueue::Picture& image, const std::string&) {
      ++done;
      kept.push_back(image);
    });
  for (std::size_t expected = PictureQueue::kMostHandedOut; expected <= 6; ++expected) {
    const Stopwatch watch;
    while (done < expected && watch.seconds() < 60) drawn.look();
    EXPECT_EQ(done, expected);
    EXPECT_FALSE(drawn.queue.view().look(drawn.engine, ++drawn.now_ns)) << "nobody asks: it draws on";
    for (int looks = 0; looks < 50; ++looks) drawn.look();
    EXPECT_EQ(done, expected);
    kept.erase(kept.begin());
  }
}

// With every edit that was made before.
TEST(PictureQueue, HasEveryEditMadeBefore) {
  Drawn drawn;
  for (int i = 0; i < 3; ++i) {
    drawn.edit();
    const RenderedImage expected = drawn.engine.draw(drawn.camera);
    bool is_done = false;
    drawn.queue.ask({.camera = drawn.camera, .style = {}}, [&](const PictureQueue::Picture& image, const std::string&) {
      EXPECT_EQ(image->rgba, expected.rgba) << i;
      is_done = true;
    });
    for (int looks = 0; looks < 10'000 && !is_done; ++looks) drawn.look();
    ASSERT_TRUE(is_done);
  }
}

// On another engine it is drawn anew.
TEST(PictureQueue, GoesOnWithAnotherEngine) {
  Drawn first, second;
  second.edit();
  const RenderedImage expected = second.engine.draw(first.camera);
  bool is_done = false;
  first.queue.ask({.camera = first.camera, .style = {}}, [&](const PictureQueue::Picture& image, const std::string&) {
    EXPECT_EQ(image->rgba, expected.rgba);
    is_done = true;
  });
  first.look();
  first.look();
  ASSERT_FALSE(is_done);
  first.queue.startAgain();
  for (int looks = 0; looks < 10'000 && !is_done; ++looks) {
    std::this_thread::sleep_for(std::chrono::microseconds(100));
    static_cast<void>(first.queue.view().look(second.engine, ++first.now_ns));
    static_cast<void>(first.queue.drawOn(second.engine.editVersion(), true));
  }
  EXPECT_TRUE(is_done);
}

TEST(PictureQueue, TellsWhoWaitsThatItEnds) {
  Drawn drawn;
  int told = 0;
  const auto done = [&](const PictureQueue::Picture& image, const std::string& failure) {
    EXPECT_EQ(failure, "it has ended");
    EXPECT_EQ(image, nullptr);
    ++told;
  };
  for (std::size_t i = 0; i < PictureQueue::kMostWaiting; ++i)
    drawn.queue.ask({.camera = drawn.camera, .style = {}}, done);
  EXPECT_THROW(drawn.queue.ask({.camera = drawn.camera, .style = {}}, done), Error);
  drawn.look();
  drawn.queue.giveUp("it has ended");
  EXPECT_EQ(told, static_cast<int>(PictureQueue::kMostWaiting));
}

}  // namespace picture_queue_test
}  // namespace palpate
