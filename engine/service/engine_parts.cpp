// SPDX-License-Identifier: Apache-2.0
#include "engine/service/engine_parts.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/bricks/active_bricks.hpp"
#include "engine/field/statistics.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/pool_volume.hpp"
#include "engine/service/edit_plan.hpp"
#include "engine/service/window_focus.hpp"

namespace palpate {
namespace {

static_assert(kMostWindowEdge == kWindowEdge && recentreVoxels(kLeastWindowEdge) >= 1);

constexpr std::size_t kDensityBytes = kBrickVoxels * sizeof(float);  // of a brick

// Called before the volume is uploaded, when it is not yet known how many samples its surface needs.
void checkDensityRoom(const GpuBudget& budget, std::size_t stored_bricks) {
  const std::uint64_t densities = stored_bricks * kDensityBytes;
  if (densities <= budget.leftBytes()) return;
  throw Error(Error::Code::kOutOfMemory, "GPU memory for the volume",
              fmt::format("its densities take {}, samples at its surface come on top, and the budget is {}",
                          inMiB(densities), inMiB(budget.limit_bytes)),
              "raise --gpu-memory, or crop or resample the volume");
}

void checkSampleRoom(const GpuBudget& budget, std::uint64_t samples) {
  if (samples <= budget.leftBytes()) return;
  const std::uint64_t all = budget.used_bytes + samples;
  throw Error(Error::Code::kOutOfMemory, "GPU memory for the volume",
              fmt::format("it takes {} ({} for densities, {} for samples at its surface), and the budget is {}",
                          inMiB(all), inMiB(budget.used_bytes), inMiB(samples), inMiB(budget.limit_bytes)),
              fmt::format("raise --gpu-memory to {} or more, with some room for edits, or crop or resample the volume",
                          wholeMiB(all)));
}

// The progress callback of one pass.
std::function<void(double)> progressOf(Pass pass, const Engine::StartProgress& progress) {
  if (!progress) return {};
  return [pass, &progress](double done) { progress(passName(pass), done); };
}

std::pair<float, float> rangeOf(std::span<const layout::BrickBounds> bounds) {
  std::pair range(std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest());
  for (const layout::BrickBounds& brick : bounds)
    range = {std::min(range.first, brick.lowest), std::max(range.second, brick.highest)};
  return range;
}

}  // namespace

template <typename Work>
void EngineParts::stage(const char* name, Work work) {
  const Stopwatch watch;
  work();
  stages_.push_back({name, watch.seconds()});
}

EngineParts::EngineParts(const Volume& volume, const Plan& plan, double isovalue, const std::string& gpu_name,
                         std::uint64_t gpu_memory_bytes, const Engine::StartProgress& progress)
    : isovalue_(isovalue),
      gpu_(gpu::GpuRequest{.name = gpu_name}),
      transfer_(gpu_),
      gradient_all_(plan.request.gradient_all),
      window_edge_(plan.request.window_edge) {
  checkTouchable(volume);
  stage(passName(Pass::kUpload), [&] {
    auto budget = makeGpuBudget(gpu_memory_bytes);
    checkDensityRoom(*budget, volume.storedBricks());
    pool_ = std::make_unique<BrickPool>(gpu_, transfer_, volume, std::move(budget));
  });
  grid_ = pool_->grid();
  if (plan.has(Pass::kFilter)) {
    const auto source_isovalue = static_cast<float>(isovalue);
    std::vector<FilterStep> steps = lowerFilters(plan.filters, volume.lattice().spacing_m, source_isovalue);
    isovalue_ = isovalueAfter(plan.filters, source_isovalue);
    distance_ = hasDistance(plan.filters);
    if (!steps.empty()) {
      stage(passName(Pass::kFilter), [&] {
        filters_ = filteredBy(gpu_, transfer_, *pool_, std::move(steps), progressOf(Pass::kFilter, progress));
      });
    }
  }
  if (plan.has(Pass::kBrickBounds)) {
    stage(passName(Pass::kBrickBounds), [&] {
      bounds_ = std::make_unique<BrickBoundsPass>(gpu_, field());
      bounds_->run();
    });
  }
  computeGradients(volume, plan, progress);
  stage(passName(Pass::kWindow), [&] { makeWindows(); });
  draws_ = plan.request.draws;
}

// The range of densities of the field that is felt.
std::pair<float, float> EngineParts::densityRange(const Volume& volume) {
  return filters_ ? rangeOf(boundsNow()) : std::pair(volume.minimum(), volume.maximum());
}

// The bounds of every brick of the field that is felt. If every brick has gradients they are not kept, so they are
// computed.
std::vector<layout::BrickBounds> EngineParts::boundsNow() {
  if (bounds_) return bounds_->read(transfer_);
  BrickBoundsPass bounds(gpu_, field());
  bounds.run();
  return bounds.read(transfer_);
}

// The smoothed field is needed while gradients are computed. Without edits and other isovalues it is freed afterwards.
void EngineParts::computeGradients(const Volume& volume, const Plan& plan, const Engine::StartProgress& progress) {
  std::vector<FilterStep> steps = lowerFilters(plan.gradient.smoothing, pool_->lattice().spacing_m);
  if (!steps.empty()) {
    stage(passName(Pass::kSmoothing), [&] {
      smoothing_ = filteredBy(gpu_, transfer_, field(), std::move(steps), progressOf(Pass::kSmoothing, progress));
    });
  }
  stage(passName(Pass::kGradient), [&] {
    const auto isovalue = static_cast<float>(isovalue_);
    const std::vector<std::uint32_t> bricks = plan.request.gradient_all
                                                  ? allBricks(pool_->grid())
                                                  : activeBricks(bounds_->read(transfer_), pool_->grid(), isovalue);
    const auto range = plan.request.half_samples ? densityRange(volume) : std::pair(0.0F, 0.0F);
    const SampleFormat format = plan.request.half_samples
                                    ? halfSamples(isovalue, range.first, range.second, pool_->lattice().spacing_m)
                                    : SampleFormat{};
    // Filters may reduce the contrast, and a distance has a contrast of its own. So with filters it is unknown here.
    if (plan.request.half_samples && !filters_)
      checkHalfSamples(format, range.first, range.second, meanAbove(volume, isovalue_) - isovalue_);
    checkSampleRoom(*pool_->budget(), bricks.size() * kBrickVoxels * format.bytesAVoxel());
    const bool as_needed = plan.gradientsAsNeeded();
    store_ = std::make_unique<SampleStore>(gpu_, pool_->brickCount(),
                                           as_needed ? std::vector<std::uint32_t>{} : inBlocks(bricks, pool_->grid()),
                                           pool_->budget(), format);
    gradient_ = std::make_unique<GradientPass>(
        gpu_, transfer_, field(), *store_, plan.gradient, smoothing_ ? &smoothing_->result() : nullptr,
        plan.request.edits || plan.request.other_isovalues ? GradientUse::kOften : GradientUse::kOnce);
    needed_bricks_ = bricks.size();
    if (as_needed) {
      needs_gradient_.resize(pool_->brickCount());
      for (const std::uint32_t brick : bricks) needs_gradient_[brick] = true;
      return;
    }
    gradient_->run(progressOf(Pass::kGradient, progress));
  });
  if (!smoothing_ || plan.request.edits || plan.request.other_isovalues) return;
  gradient_.reset();
  smoothing_.reset();
}

void EngineParts::confirmWindow(std::int64_t now_ns) noexcept {
  if (published_ && !(editor_ && editor_->broken())) exchange_->confirm(now_ns);
}

void EngineParts::forgetWindow() noexcept {
  published_.reset();
  for (std::size_t brick = 0; brick < needs_gradient_.size(); ++brick)
    if (store_->has(brick)) store_->remove(brick);
}

// Of the bricks that a window at this place shows, those that need gradients and have none yet.
void EngineParts::computeGradientsIn(const WindowBox& box) {
  if (needs_gradient_.empty()) return;
  std::vector<std::uint32_t> missing;
  grid_.forEachIn({box.first, box.first + box.size - Vec3i::Ones()}, [&](const Vec3i& at) {
    const std::uint32_t brick = grid_.index(at);
    if (needs_gradient_[brick] && !store_->has(brick)) missing.push_back(brick);
  });
  if (missing.empty()) return;
  store_->reserve(missing.size());
  for (const std::uint32_t brick : missing) store_->add(brick, neighbourWithSamples(grid_, *store_, brick));
  gradient_->run(missing);
}

std::size_t EngineParts::windowCapacity() const noexcept {
  return static_cast<std::size_t>(pool_->size().cwiseMin(window_edge_).prod());
}

void EngineParts::makeWindowBuffers() {
  window_buffers_.clear();
  for (int slot = 0; slot < 3; ++slot)
    window_buffers_.emplace_back(gpu_, "window slot", windowCapacity() * sizeof(Sample), gpu::MemoryKind::kHost);
}

void EngineParts::makeWindows() {
  window_ = std::make_unique<WindowPass>(gpu_, field(), *store_);
  makeWindowBuffers();
  std::array<Sample*, 3> storages{};
  for (std::size_t slot = 0; slot < 3; ++slot) storages[slot] = static_cast<Sample*>(window_buffers_[slot].mapped());
  exchange_ = std::make_unique<WindowExchange>(storages, windowCapacity());
}

// None if the driver does not take all three.
std::vector<gpu::Buffer> EngineParts::windowBuffersOver(const Engine::SharedWindows& shared) {
  std::vector<gpu::Buffer> buffers;
  for (Sample* const samples : shared.samples) {
    std::optional<gpu::Buffer> buffer = gpu::Buffer::over(gpu_, "window slot", samples, shared.bytes);
    if (!buffer) return {};
    buffers.push_back(std::move(*buffer));
  }
  return buffers;
}

void EngineParts::shareWindows(const Engine::SharedWindows& shared) {
  if (shared.block == nullptr || shared.capacity < windowCapacity() ||
      shared.bytes < shared.capacity * sizeof(Sample)) {
    refuse("shared windows",
           fmt::format("they hold {} samples in {} bytes each, and a window has {}", shared.capacity, shared.bytes,
                       windowCapacity()),
           "share larger ones");
  }
  auto exchange =
      std::make_unique<WindowExchange>(*shared.block, shared.samples, shared.capacity, shared.first_version);
  std::vector<gpu::Buffer> buffers = windowBuffersOver(shared);
  const bool had_own = copies_windows_ || !shares_windows_;
  copies_windows_ = buffers.empty();
  if (!buffers.empty()) {
    window_buffers_ = std::move(buffers);
  } else if (!had_own) {
    makeWindowBuffers();
  }
  shares_windows_ = true;
  exchange_ = std::move(exchange);
  published_.reset();
}

bool EngineParts::publishFor(const ToolPose& tool, std::int64_t now_ns) {
  const double lead_m = longestWindowLead(window_edge_) * pool_->lattice().smallestSpacing();
  return publishAround(windowFocus(tool, lead_m), now_ns);
}

bool EngineParts::publishAround(const Vec3& focus_W, std::int64_t now_ns) {
  if (editor_ && editor_->broken()) return false;  // the volume is unknown, so no window may be confirmed
  const WindowBox box = windowAround(pool_->lattice().toIndex(focus_W), pool_->size(), window_edge_);
  if (published_ && stillServes(*published_, box, pool_->size(), window_edge_)) {
    exchange_->confirm(now_ns);
    return false;
  }
  computeGradientsIn(box);
  window_->run(box, window_buffers_[exchange_->backIndex()]);
  publishBox(box, now_ns);
  return true;
}

void EngineParts::publishBox(const WindowBox& box, std::int64_t now_ns) {
  SampleWindow& window = exchange_->back();
  window.lattice = pool_->lattice().shifted(box.first);
  window.size = box.size;
  for (int axis = 0; axis < 3; ++axis) {
    window.low_is_border[axis] = box.first[axis] == 0;
    window.high_is_border[axis] = box.first[axis] + box.size[axis] == pool_->size()[axis];
  }
  window.edit_version = editVersion();
  window.stamp_ns = now_ns;
  published_slot_ = exchange_->backIndex();
  if (copies_windows_) {
    const auto count = static_cast<std::size_t>(box.size.cast<std::int64_t>().prod());
    std::memcpy(static_cast<void*>(exchange_->backSamples()), window_buffers_[published_slot_].mapped(),
                count * sizeof(Sample));
  }
  exchange_->publish();
  published_ = box;
}

void EngineParts::allowEdits(const BrushProfile& profile, std::span<const EditKind> kinds, std::uint64_t version) {
  if (!gradient_) {
    throw Error(Error::Code::kBadInput, "edits", "the smoothed field, whose gradients are taken, was not kept",
                "this is a fault of Palpate, whose plan said nothing of edits: please report it");
  }
  const Editor::Parts parts{gpu_,
                            transfer_,
                            *pool_,
                            *store_,
                            bounds_.get(),
                            *gradient_,
                            *window_,
                            filters_.get(),
                            static_cast<float>(isovalue_),
                            smoothing_.get()};
  if (wanted_isovalue_) endIsovalue(isovalue_);
  if (drawing_) drawing_->wait();  // the editor makes room in buffers that it reads
  stage("edit set-up", [&] {
    editor_ = std::make_unique<Editor>(parts, profile, gradient_all_, version);
    editor_->prepare(kinds);
  });
}

// `change` gets the window to gather, or null, and returns the editor's outcome.
template <typename Change>
Engine::EditResult EngineParts::change(std::int64_t now_ns, const Change& change) {
  if (!editor_) {
    throw Error(Error::Code::kBadInput, "edit", "edits were not allowed when the engine was made",
                "this is a fault of Palpate: please report it");
  }
  std::optional<Editor::WindowTarget> target;
  if (published_) target = {*published_, &window_buffers_[exchange_->backIndex()], &window_buffers_[published_slot_]};
  if (drawing_) drawing_->wait();  // buffers that it reads may be replaced
  Editor::Outcome outcome = change(target ? &*target : nullptr);
  const auto time = [&](const char* name, auto work) {
    const Stopwatch watch;
    work();
    outcome.stages.push_back({name, watch.seconds()});
  };
  if (outcome.window_gathered) time("publish", [&] { publishBox(*published_, now_ns); });
  if (drawing_) drawing_->changed(outcome.altered, outcome.version);
  time("settle", [&] { editor_->settle(); });
  return {outcome.version, outcome.window_gathered, outcome.changed_bricks, outcome.gradient_bricks,
          std::move(outcome.stages)};
}

Engine::EditResult EngineParts::edit(std::span<const EditCommand> commands, std::int64_t now_ns,
                                     const BeforeChange& before) {
  return change(now_ns, [&](const Editor::WindowTarget* target) { return editor_->apply(commands, target, before); });
}

Engine::EditResult EngineParts::replace(std::span<const BrickContent> bricks, std::int64_t now_ns) {
  return change(now_ns, [&](const Editor::WindowTarget* target) { return editor_->replace(bricks, target); });
}

std::size_t EngineParts::readBack(Volume& volume) {
  return editor_ ? editor_->readBack(volume) : 0;
}

void EngineParts::beginIsovalue(double isovalue) {
  if (editor_) editor_->refuseIfBroken();
  if (wanted_isovalue_) endIsovalue(isovalue_);
  const std::string input = fmt::format("isovalue {:g}", isovalue);
  const char* again = "start anew with this isovalue";
  if (distance_) refuse(input, "what is felt is the distance from the isosurface that was there at the start", again);
  if (store_->format().half) refuse(input, "halves hold the density's difference from the first isovalue", again);
  if (!gradient_) refuse(input, "the smoothed field, whose gradients are taken, was not kept", again);
  const std::vector<layout::BrickBounds> bounds = boundsNow();
  const auto [lowest, highest] = rangeOf(bounds);
  const auto to = static_cast<float>(isovalue);
  if (!layout::crosses(to, {lowest, highest})) {
    refuse(input, fmt::format("the densities lie between {:g} and {:g}, so there is no isosurface", lowest, highest),
           fmt::format("give an isovalue from {:g} to below {:g}", lowest, highest));
  }
  if (!gradient_all_) isovalue_change_.emplace(*store_, *gradient_, grid_, bounds, to);
  wanted_isovalue_ = to;
  keepSamplesFor(to, bounds);
}

bool EngineParts::gatherIsovalue(std::size_t most, std::int64_t now_ns) {
  if (!wanted_isovalue_) return true;
  if (editor_) editor_->refuseIfBroken();
  try {
    if (isovalue_change_ && !isovalue_change_->gather(most)) return false;
  } catch (const Error&) {
    endIsovalue(isovalue_);
    throw;
  }
  if (published_) {
    window_->run(*published_, window_buffers_[exchange_->backIndex()]);
    publishBox(*published_, now_ns);
  }
  isovalue_change_.reset();
  isovalue_ = *wanted_isovalue_;
  wanted_isovalue_.reset();
  return true;
}

void EngineParts::endIsovalue(double keep) {
  isovalue_change_.reset();
  wanted_isovalue_.reset();
  isovalue_ = keep;
  keepSamplesFor(isovalue_, gradient_all_ ? std::vector<layout::BrickBounds>{} : boundsNow());
}

// From now on keeps the samples of the isovalue that is felt and of `other`, and of no third one.
void EngineParts::keepSamplesFor(double other, std::span<const layout::BrickBounds> bounds) {
  const layout::IsovaluePair isovalues{static_cast<float>(isovalue_), static_cast<float>(other)};
  if (editor_) editor_->setIsovalues(isovalues, bounds);
  if (!gradient_all_) dropInactive(*store_, grid_, bounds, isovalues);
}

Volume EngineParts::filtered(const VolumeFacts& facts) {
  if (editor_) editor_->refuseIfBroken();
  return volumeOf(field(), transfer_, facts);
}

void EngineParts::checkDraws() const {
  if (!draws_) {
    refuse("picture", "the plan does not draw", "this is a fault of Palpate: please report it");
  }
  if (editor_) editor_->refuseIfBroken();
}

RenderedImage EngineParts::draw(const Camera& camera, const std::function<void()>& between, const DrawStyle& style) {
  checkDraws();
  Drawing drawing(gpu_, transfer_, field(), *bounds_);
  drawing.show(camera, isovalue_, style);
  drawing.finish(between);
  return drawing.image();
}

void EngineParts::show(const Camera& camera, const DrawStyle& style, DrawOrder order) {
  checkDraws();
  if (!drawing_) {
    drawing_ = std::make_unique<Drawing>(gpu_, transfer_, field(), *bounds_);
    drawing_->changed({}, editVersion());
  }
  drawing_->show(camera, isovalue_, style, order);
}

bool EngineParts::pollPicture() {
  return !drawing_ || drawing_->poll();
}

bool EngineParts::drawPiece(double most_s) {
  if (!drawing_) return true;
  checkDraws();
  return drawing_->advance(most_s);
}

Drawing& EngineParts::shown() {
  if (!drawing_ || !drawing_->shows())
    refuse("picture", "nothing is shown yet", "this is a fault of Palpate: please report it");
  return *drawing_;
}

void EngineParts::copyPicture(std::vector<layout::PicturePixel>& pixels) {
  shown().copyTo(pixels);
}

RenderedImage EngineParts::picture() {
  return shown().image();
}

std::vector<MemoryFigure> EngineParts::memory() const {
  std::uint64_t windows = 0;
  for (const gpu::Buffer& buffer : window_buffers_) windows += buffer.bytes();
  return {{"gpu brick pool", pool_->bytes()},
          {"gpu filtered", filters_ ? filters_->result().bytes() + filters_->scratchBytes() : 0},
          {"gpu smoothed", smoothing_ ? smoothing_->result().bytes() + smoothing_->scratchBytes() : 0},
          {"gpu samples", store_->bytes()},
          {"gpu windows", windows},
          {"gpu picture", drawing_ ? drawing_->bytes() : 0},
          {"gpu total", gpu_.bytesInUse()}};
}

PlanFacts EngineParts::planFacts() const noexcept {
  PlanFacts facts;
  facts.bricks = pool_->brickCount();
  facts.stored_bricks = pool_->storedBricks();
  facts.filtered_bricks = field().storedBricks();
  facts.gradient_bricks = needs_gradient_.empty() ? store_->brickCount() : needed_bricks_;
  return facts;
}

}  // namespace palpate
