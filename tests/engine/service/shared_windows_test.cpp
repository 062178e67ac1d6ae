// SPDX-License-Identifier: Apache-2.0
// Windows in memory that a servo in another process could read: the same, bit for bit, as those in the engine's own
// buffers, in place and copied, through gathers, edits and another isovalue.
#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>

#include "base/error.hpp"
#include "engine/phantoms/phantom.hpp"
#include "engine/service/engine.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {
namespace shared_windows_test {

// What a LinkMemory has (service/memory), which the engine knows nothing of. `shift`: bytes by which the samples lie
// off whole pages, so that no driver takes them.
class Shared {
 public:
  explicit Shared(std::size_t samples, std::size_t shift = 0) : samples_(samples), shift_(shift) {
    bytes_ = (samples * sizeof(Sample) + kPage - 1) / kPage * kPage;
    memory_ = static_cast<std::byte*>(
        mmap(nullptr, 3 * (bytes_ + kPage), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  }
  ~Shared() { munmap(memory_, 3 * (bytes_ + kPage)); }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  Engine::SharedWindows windows(std::uint64_t first = 1) {
    Engine::SharedWindows shared{.block = &block_, .capacity = samples_, .bytes = bytes_, .first_version = first};
    for (std::size_t slot = 0; slot < 3; ++slot)
      shared.samples[slot] = reinterpret_cast<Sample*>(memory_ + slot * (bytes_ + kPage) + shift_);
    return shared;
  }

 private:
  static constexpr std::size_t kPage = 4096;
  std::size_t samples_, shift_, bytes_ = 0;
  std::byte* memory_ = nullptr;
  WindowBlock block_;
};

void expectSame(const SampleWindow& a, const SampleWindow& b) {
  ASSERT_TRUE(a.usable() && b.usable());
  ASSERT_EQ(a.size, b.size);
  EXPECT_EQ(a.lattice.origin_W, b.lattice.origin_W);
  EXPECT_EQ(a.lattice.R_WL, b.lattice.R_WL);
  EXPECT_EQ(a.lattice.spacing_m, b.lattice.spacing_m);
  EXPECT_EQ(a.low_is_border, b.low_is_border);
  EXPECT_EQ(a.high_is_border, b.high_is_border);
  EXPECT_EQ(a.edit_version, b.edit_version);
  EXPECT_EQ(a.stamp_ns, b.stamp_ns);
  const auto bytes = static_cast<std::size_t>(a.size.prod()) * sizeof(Sample);
  EXPECT_EQ(std::memcmp(static_cast<const void*>(a.samples), static_cast<const void*>(b.samples), bytes), 0);
}

Plan planWithEdits() {
  EngineRequest request;
  request.edits = true;
  request.other_isovalues = true;
  return makePlan(request);
}

class SharedWindows : public testing::TestWithParam<std::size_t> {};

TEST_P(SharedWindows, AreThoseOfTheEnginesOwnBuffers) {
  const Volume volume = makeVolume(*makePhantom("phantom:knot?size=48"));
  Engine own(volume, planWithEdits(), 0, ""), shares(volume, planWithEdits(), 0, "");
  for (Engine* const engine : {&own, &shares}) engine->allowEdits({});
  EXPECT_TRUE(own.windowsInPlace());
  Shared memory(shares.windowCapacity(), GetParam());
  const Engine::SharedWindows given = memory.windows(100);
  shares.shareWindows(given);
  EXPECT_EQ(shares.windowsInPlace(), GetParam() == 0);  // lavapipe takes memory of the host
  WindowExchange servo(*given.block, given.samples, given.capacity);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 47);
  std::uint64_t windows = 0;
  for (std::int64_t step = 1; step <= 40; ++step) {
    const Vec3 at_W = volume.lattice().toWorld({place(random), place(random), place(random)});
    const bool published = own.publishAround(at_W, step);
    EXPECT_EQ(shares.publishAround(at_W, step), published);
    if (step % 4 == 0) {
      EditCommand command;
      command.from_W = command.to_W = at_W;
      command.radius_m = 2e-3;
      const bool reached = own.edit({&command, 1}, step).published;
      EXPECT_EQ(shares.edit({&command, 1}, step).published, reached);
      if (reached) ++windows;
    }
    if (published) ++windows;
    if (step == 20) {
      for (Engine* const engine : {&own, &shares}) {
        engine->beginIsovalue(0.1);
        while (!engine->gatherIsovalue(1000, step)) {
        }
        engine->endIsovalue(0.1);
      }
      ++windows;
    }
    expectSame(servo.latest(), own.exchange().latest());
    EXPECT_EQ(servo.confirmedAt_ns(), own.exchange().confirmedAt_ns());
    EXPECT_EQ(servo.latest().version, 99 + windows);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(windows, 20U);
}

TEST_P(SharedWindows, AreRefusedIfTheyAreTooSmall) {
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=32"));
  Engine engine(volume, makePlan({}), 0, "");
  Shared memory(engine.windowCapacity(), GetParam());
  for (int which = 0; which < 3; ++which) {
    Engine::SharedWindows given = memory.windows(1);
    if (which == 0) given.block = nullptr;
    if (which == 1) given.capacity = engine.windowCapacity() - 1;
    if (which == 2) given.bytes = given.capacity * sizeof(Sample) - 1;
    EXPECT_THROW(engine.shareWindows(given), Error) << which;
  }
  EXPECT_TRUE(engine.publishAround(volume.lattice().toWorld({16, 16, 16}), 1));  // its own windows are there
}

// A servo that comes later gets memory of its own, and the first window at once.
TEST_P(SharedWindows, MoveToAnotherServosMemory) {
  std::vector<std::unique_ptr<Shared>> memories;  // outlive the engine
  const Volume volume = makeVolume(*makePhantom("phantom:sphere?size=32"));
  Engine engine(volume, makePlan({}), 0, "");
  const Vec3 at_W = volume.lattice().toWorld({16, 16, 16});
  ASSERT_TRUE(engine.publishAround(at_W, 1));
  const auto bytes = engine.memory().back().bytes;
  std::uint64_t first = 2;
  for (int servo = 0; servo < 3; ++servo) {
    auto memory = std::make_unique<Shared>(engine.windowCapacity(), servo == 1 ? 16 - GetParam() : GetParam());
    const Engine::SharedWindows given = memory->windows(first);
    engine.shareWindows(given);
    EXPECT_TRUE(engine.publishAround(at_W, 2));
    EXPECT_FALSE(engine.publishAround(at_W, 3));
    WindowExchange exchange(*given.block, given.samples, given.capacity);
    EXPECT_EQ(exchange.latest().version, first);
    EXPECT_EQ(exchange.confirmedAt_ns(), 3);
    first += 10;
    EXPECT_LE(engine.memory().back().bytes, bytes + 3 * 4096);  // no buffers are left behind
    memories.push_back(std::move(memory));
  }
}

INSTANTIATE_TEST_SUITE_P(InPlaceAndCopied, SharedWindows, testing::Values(0, 16));

}  // namespace shared_windows_test
}  // namespace palpate
