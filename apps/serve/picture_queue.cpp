// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/picture_queue.hpp"

#include <utility>

#include "base/error.hpp"
#include "engine/draw/picture_image.hpp"

namespace palpate {

void PictureQueue::ask(ViewRequest request, Done done) {
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMostWaiting)
    throw Error(Error::Code::kOutOfMemory, "the picture", "too many others wait", "ask again when they are done");
  waiting_.push_back({std::move(request), std::move(done)});
}

bool PictureQueue::drawOn(std::uint64_t edit_version, bool may_begin) {
  if (!drawing_) {
    std::erase_if(handed_out_, [](const auto& one) { return one.expired(); });
    if (!may_begin || handed_out_.size() >= kMostHandedOut) return false;
    std::unique_lock lock(mutex_);
    if (waiting_.empty()) return false;
    drawing_ = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    from_edits_ = edit_version;
    // Tile by tile: coarse pixels first, those that edits change would come before finer ones again and again.
    ViewRequest request = drawing_->request;
    request.order = DrawOrder::kWhole;
    request_ = view_->show(request);
    return true;
  }
  const std::string failure = view_->failure();
  const ViewFrame& frame = view_->latest();
  const bool is_whole = frame.request == request_ && frame.fine && frame.edit_version >= from_edits_;
  if (!is_whole && failure.empty()) return true;
  view_->rest();
  const Drawing drawn = std::move(*std::exchange(drawing_, std::nullopt));
  const Camera& camera = drawn.request.camera;
  Picture picture;
  if (is_whole) {
    picture = std::make_shared<const RenderedImage>(asImage(camera.width, camera.height, frame.pixels));
    handed_out_.emplace_back(picture);
  }
  drawn.done(picture, is_whole ? "" : failure);
  return true;
}

void PictureQueue::giveUp(const std::string& why) {
  std::deque<Drawing> waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting.swap(waiting_);
  }
  if (drawing_) waiting.push_front(std::move(*std::exchange(drawing_, std::nullopt)));
  for (const Drawing& one : waiting) one.done({}, why);
}

void PictureQueue::startAgain() {
  view_.emplace();
  if (!drawing_) return;
  const std::lock_guard lock(mutex_);
  waiting_.push_front(std::move(*std::exchange(drawing_, std::nullopt)));
}

}  // namespace palpate
