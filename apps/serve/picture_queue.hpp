// SPDX-License-Identifier: Apache-2.0
// apps/serve/picture_queue.hpp: pictures that a service is asked for, one after another, drawn in pieces beside windows
// and edits.
//
// Threads: ask() by any; drawOn(), view() and startAgain() by the engine's. Nothing is drawn while nobody asks.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/rig/live_view.hpp"
#include "base/camera.hpp"

namespace palpate {

class PictureQueue {
 public:
  // With the picture, or null and why there is none; by the engine's thread.
  using Picture = std::shared_ptr<const RenderedImage>;
  using Done = std::function<void(const Picture& picture, const std::string& failure)>;
  static constexpr std::size_t kMostWaiting = 16;
  static constexpr std::size_t kMostHandedOut = 2;  // that are not let go yet; no other is begun meanwhile

  // Throws Error(kOutOfMemory) if too many wait.
  void ask(ViewRequest request, Done done);

  // For the rig, or whoever looks at it (LiveView::look): valid until startAgain().
  [[nodiscard]] LiveView& view() noexcept { return *view_; }
  // At every look at the tool, after that of the view: begins the next picture, if `may_begin`, and hands out one that
  // is whole, with every edit up to `edit_version` when it began, and perhaps parts of later ones: edits that go on and
  // on do not keep it from being done. Whether one is under way.
  bool drawOn(std::uint64_t edit_version, bool may_begin);
  // Nothing is drawn any more: whoever waits is told why. By the engine's thread, or after it.
  void giveUp(const std::string& why);
  // On another engine; the picture under way begins anew.
  void startAgain();

 private:
  struct Drawing {
    ViewRequest request;
    Done done;
  };
  std::optional<LiveView> view_{std::in_place};
  std::optional<Drawing> drawing_;
  std::uint64_t from_edits_ = 0;                                // that its frame shows
  std::uint64_t request_ = 0;                                   // its number in the view
  std::vector<std::weak_ptr<const RenderedImage>> handed_out_;  // engine's thread; expired: let go
  std::mutex mutex_;                                            // guards the next
  std::deque<Drawing> waiting_;
};

}  // namespace palpate
