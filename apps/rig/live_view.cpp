// SPDX-License-Identifier: Apache-2.0
#include "apps/rig/live_view.hpp"

#include <exception>
#include <utility>

#include "base/error.hpp"
#include "engine/service/engine.hpp"

namespace palpate {
namespace {

constexpr std::uint64_t kNoPieces = ~std::uint64_t{0};  // of a picture that nothing was handed over of

}  // namespace

LiveView::LiveView(double frame_s, double piece_s)
    : frame_ns_(static_cast<std::int64_t>(1e9 * frame_s)), piece_s_(piece_s) {}

std::uint64_t LiveView::show(const ViewRequest& request) {
  const std::scoped_lock lock(mutex_);
  request_ = Numbered{++requests_, request};
  failure_.clear();
  return requests_;
}

std::string LiveView::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

void LiveView::rest() noexcept {
  shown_.reset();
  pieces_ = kNoPieces;
  whole_ = false;
}

bool LiveView::look(Engine& engine, std::int64_t now_ns) noexcept {
  try {
    return lookOrThrow(engine, now_ns);
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    failure_ = error.what();
    shown_.reset();
    return false;
  }
}

// A frame is copied and a request taken while no piece of work is under way, so that neither waits for one.
bool LiveView::lookOrThrow(Engine& engine, std::int64_t now_ns) {
  if (!engine.pollPicture()) return true;
  const PictureState state = engine.pictureState();
  if (!shown_ || state.showable) {
    std::optional<Numbered> wanted = takeRequest();
    if (shown_) handOver(engine, state, now_ns, wanted.has_value());
    if (!wanted && shown_ && engine.isovalue() != isovalue_) wanted = shown_;
    if (wanted) {
      isovalue_ = engine.isovalue();
      tryToShow(engine, *wanted);
    }
  }
  return shown_ && !engine.drawPiece(piece_s_);
}

// What is refused leaves the picture that is shown; it is still kept up to date.
void LiveView::tryToShow(Engine& engine, const Numbered& wanted) {
  const ViewRequest& request = wanted.request;
  try {
    engine.show(request.camera, request.style, request.order);
    shown_ = wanted;
    is_handed_ = false;
    pieces_ = kNoPieces;  // also where all of it is drawn already, for another request
  } catch (const Error& error) {
    if (error.code() != Error::Code::kBadInput && error.code() != Error::Code::kOutOfMemory) throw;
    const std::scoped_lock lock(mutex_);
    failure_ = error.what();
  }
}

std::optional<LiveView::Numbered> LiveView::takeRequest() {
  const std::scoped_lock lock(mutex_);
  if (request_) failure_.clear();
  return std::exchange(request_, std::nullopt);
}

// `last`: of this camera, so that something of each is seen.
void LiveView::handOver(Engine& engine, const PictureState& state, std::int64_t now_ns, bool last) {
  if (state.pieces == pieces_ && state.whole == whole_) return;
  // Finer pixels alone are shown less often: a frame takes as long to copy as some thousand pixels to draw.
  const bool only_finer = is_handed_ && state.version == handed_version_;
  const std::int64_t pause_ns = only_finer ? kFinerFrames * frame_ns_ : frame_ns_;
  if (!state.whole && !last && now_ns - frame_at_ns_ < pause_ns) return;
  ViewFrame& frame = frames_.back();
  engine.copyPicture(frame.pixels);
  frame.number = ++number_;
  frame.request = shown_->number;
  frame.camera = shown_->request.camera;
  frame.edit_version = state.version;
  frame.fine = state.fine;
  frame.whole = state.whole;
  frames_.publish();
  is_handed_ = true;
  handed_version_ = state.version;
  pieces_ = state.pieces;
  whole_ = state.whole;
  frame_at_ns_ = now_ns;
}

}  // namespace palpate
