// SPDX-License-Identifier: Apache-2.0
// How a served volume gets another engine: after its device was lost, or with other filters.
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "apps/serve/flat_heap.hpp"
#include "apps/serve/served_engine.hpp"
#include "apps/serve/served_volume.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds kMemoryRetry{200};  // until the next try: another program may give memory back
// An engine that takes longer to be made counts as hanging. The largest volume with filters may need most of it on a
// slow device.
constexpr std::int64_t kMakeAnew_ns = 600'000'000'000;

Error asError(const std::exception& failure, const char* what) {
  if (const auto* const error = dynamic_cast<const Error*>(&failure)) return *error;
  return {Error::Code::kOutOfMemory, what, failure.what(), "end other programs, or ask for less"};
}

}  // namespace

bool ServedVolume::mustBeMadeAnew() const {
  const LiveVolume& live = engine_->live();
  if (live.engine().broken() || !live.edits().counts().editing) return true;
  const std::lock_guard lock(mutex_);
  return wanted_filter_.has_value();
}

// What clients ask for meanwhile waits.
void ServedVolume::makeAnew() {
  std::optional<std::string> filter;
  Done done;
  {
    const std::scoped_lock lock(engines_, mutex_);
    filter = std::exchange(wanted_filter_, std::nullopt);
    done = std::exchange(filter_done_, {});
    is_ready_ = false;
    looked_at_ns_.store(monotonicNow_ns() + kMakeAnew_ns, std::memory_order_relaxed);
  }
  if (!filter) noteLost();
  settle();
  pictures_.startAgain();
  onlookers_.interrupt();
  Scene next = scene();
  std::optional<Error> refusal;
  if (filter) next.filter = *filter;
  try {
    makeEngine(next, filter ? Patience::kNone : Patience::kForMemory);
  } catch (const std::exception& error) {
    if (!filter) throw;
    refusal = asError(error, "the filters");
    next.filter = scene().filter;
    try {
      makeEngine(next, Patience::kForMemory);
    } catch (...) {
      done(refusal);  // or nobody would
      throw;
    }
  }
  if (filter && !refusal)
    tell_(filter->empty() ? std::string("the volume is felt without filters from now on")
                          : fmt::format("the volume is felt through {} from now on", *filter));
  servo_.reset();  // to whose memory the engine before wrote
  giveFreeHeapBack();
  Done also;  // of a client that asked meanwhile for the same filters
  {
    const std::scoped_lock lock(engines_, mutex_);
    scene_.filter = next.filter;
    ++status_.engines;
    if (wanted_filter_ == next.filter) {
      wanted_filter_.reset();
      also = std::exchange(filter_done_, {});
    }
    is_ready_ = true;
    looked_at_ns_.store(monotonicNow_ns(), std::memory_order_relaxed);
  }
  if (done) done(refusal);
  if (also) also({});
}

void ServedVolume::noteLost() {
  if (!lost_.mayGoOn(monotonicNow_ns()))
    throw Error(Error::Code::kDevice, "the engine", "its device has failed again and again",
                "see the driver's messages, or choose another device with --gpu; the edits are in the journal");
  tell_("the Vulkan device has failed; the engine is made anew from the volume with its edits");
}

void ServedVolume::noteLackOfMemory(const Error& lack) {
  if (!lost_.mayGoOn(monotonicNow_ns()))
    throw Error(Error::Code::kOutOfMemory, "the engine", fmt::format("it cannot be made anew: {}", lack.what()),
                "end other programs that hold the device's memory, and start again; the edits are in the journal");
}

// Begins with the first isovalue; that of the scene is taken then. The device may be lost meanwhile, too, or another
// program may have taken its memory, perhaps for a moment.
void ServedVolume::makeEngine(const Scene& scene, Patience patience) {
  while (true) {
    try {
      return engine_->makeAnew(scene);
    } catch (const Error& error) {
      const bool lacks_memory = error.code() == Error::Code::kOutOfMemory;
      if (error.code() != Error::Code::kDevice && !(lacks_memory && patience == Patience::kForMemory)) throw;
      tell_(error.what());
      if (lacks_memory) {
        noteLackOfMemory(error);
        std::this_thread::sleep_for(kMemoryRetry);
      } else {
        noteLost();
      }
    }
  }
}

void ServedVolume::filter(const std::string& chain, Done done) {
  Scene next = scene();
  next.filter = chain;
  static_cast<void>(servedPlan(next));  // or says why not
  {
    const std::scoped_lock lock(engines_, mutex_);
    if (wanted_filter_)
      throw Error(Error::Code::kOutOfMemory, "the filters", "others are being made ready", "ask again in a moment");
    if (chain != scene_.filter || !is_ready_) {
      wanted_filter_ = chain;
      filter_done_ = std::move(done);
      return;
    }
  }
  done({});
}

}  // namespace palpate
