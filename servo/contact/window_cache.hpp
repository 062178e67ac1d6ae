// SPDX-License-Identifier: Apache-2.0
// servo/contact/window_cache.hpp: the sampler of the present window, made again only for a new window.
//
// A window that is not usable gives a sampler for which every place is beyond the window. Thread: the servo's. Cost:
// two comparisons; with a new window some 20 ns.
#pragma once

#include "servo/window/window_sampler.hpp"

namespace palpate {

class WindowCache {
 public:
  [[nodiscard]] const WindowSampler& of(const SampleWindow& window) noexcept {
    if (!window.usable()) {
      sampler_ = {};
      samples_ = nullptr;
    } else if (window.version != version_ || window.samples != samples_) {
      sampler_ = WindowSampler(window);
      version_ = window.version;
      samples_ = window.samples;
    }
    return sampler_;
  }

  // Call it before another run: windows of that run may have the same versions and storage.
  void forget() noexcept { *this = WindowCache(); }

 private:
  WindowSampler sampler_;
  std::uint64_t version_ = 0;
  const Sample* samples_ = nullptr;
};

}  // namespace palpate
