// SPDX-License-Identifier: Apache-2.0
// apps/rig/live_view.hpp: the isosurface's picture while a rig runs, drawn by the engine's thread and handed to a
// window's.
//
// The engine's thread draws in pieces between its looks at the tool, so that windows and edits come in between. A frame
// is handed over once all its pixels belong to one camera: coarse first, then finer. A camera that moves on waits until
// the coarse picture of the last one is out, so that something is seen of every movement.
//
// Another isovalue, or a style that was not drawn before, is made ready at once, and no window comes meanwhile: some
// ten milliseconds for a CT head, and longer where the driver compiles.
//
// Threads: show() from any thread, latest() from one reader, look() and rest() from the engine's thread. No call waits
// for another but for the length of a copied request.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/camera.hpp"
#include "engine/draw/draw_style.hpp"
#include "service/memory/view_frame.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

class Engine;

struct ViewRequest {
  Camera camera;
  DrawStyle style;
  DrawOrder order = DrawOrder::kCoarseFirst;
  bool operator==(const ViewRequest&) const = default;
};

class LiveView {
 public:
  // Two frames that differ only in how fine they are come this many frames apart.
  static constexpr int kFinerFrames = 4;
  // `frame_s`: the least time between two frames, but for one that is whole or the last of its camera. `piece_s`:
  // device time of a piece of work. A window of samples for the servo waits for no more than one piece.
  explicit LiveView(double frame_s = 1.0 / 60, double piece_s = 1.2e-3);

  // What is to be seen from now on; the newest request counts. A frame of it comes, even if nothing has changed.
  // Returns its number, from 1.
  std::uint64_t show(const ViewRequest& request);
  // The newest frame; valid until the next call.
  [[nodiscard]] const ViewFrame& latest() noexcept { return frames_.latest(); }
  // Why nothing is drawn any more, or why the last request is not shown; empty: it is. The servo goes on.
  [[nodiscard]] std::string failure() const;

  // Engine's thread: nothing is to be seen any more, so nothing is drawn until the next request. Then the first frame
  // comes anew, whatever was drawn before.
  void rest() noexcept;
  // Engine's thread, at every look at the tool: takes requests, submits work, hands over frames. Returns whether there
  // is more to draw, so that the thread should look again soon. Never throws: a failure ends the drawing.
  bool look(Engine& engine, std::int64_t now_ns) noexcept;

 private:
  struct Numbered {
    std::uint64_t number = 0;
    ViewRequest request;
  };
  bool lookOrThrow(Engine& engine, std::int64_t now_ns);
  void tryToShow(Engine& engine, const Numbered& wanted);
  [[nodiscard]] std::optional<Numbered> takeRequest();
  void handOver(Engine& engine, const PictureState& state, std::int64_t now_ns, bool last);

  const std::int64_t frame_ns_;
  const double piece_s_;
  mutable std::mutex mutex_;         // guards the next three
  std::uint64_t requests_ = 0;       // so far
  std::optional<Numbered> request_;  // the newest one that was not taken
  std::string failure_;
  std::optional<Numbered> shown_;
  double isovalue_ = 0;  // of what is shown
  // Of the newest frame:
  std::uint64_t pieces_ = 0;
  bool whole_ = false;
  bool is_handed_ = false;  // it is of the present request
  std::uint64_t handed_version_ = 0;
  std::int64_t frame_at_ns_ = 0;
  std::uint64_t number_ = 0;
  TripleBuffer<ViewFrame> frames_;
};

}  // namespace palpate
