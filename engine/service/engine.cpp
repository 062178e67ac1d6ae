// SPDX-License-Identifier: Apache-2.0
#include "engine/service/engine.hpp"

#include "engine/service/engine_parts.hpp"

namespace palpate {

Engine::Engine(const Volume& volume, const Plan& plan, double isovalue, const std::string& gpu_name,
               std::uint64_t gpu_memory_bytes, const StartProgress& progress)
    : parts_(std::make_unique<EngineParts>(volume, plan, isovalue, gpu_name, gpu_memory_bytes, progress)) {}
Engine::~Engine() = default;

bool Engine::publishAround(const Vec3& focus_W, std::int64_t now_ns) {
  return parts_->publishAround(focus_W, now_ns);
}
bool Engine::publishFor(const ToolPose& tool, std::int64_t now_ns) {
  return parts_->publishFor(tool, now_ns);
}

void Engine::confirmWindow(std::int64_t now_ns) noexcept {
  parts_->confirmWindow(now_ns);
}

void Engine::forgetWindow() noexcept {
  parts_->forgetWindow();
}

void Engine::allowEdits(const BrushProfile& profile, std::span<const EditKind> kinds, std::uint64_t version) {
  parts_->allowEdits(profile, kinds, version);
}
Engine::EditResult Engine::edit(std::span<const EditCommand> commands, std::int64_t now_ns,
                                const BeforeChange& before) {
  return parts_->edit(commands, now_ns, before);
}
Engine::EditResult Engine::replace(std::span<const BrickContent> bricks, std::int64_t now_ns) {
  return parts_->replace(bricks, now_ns);
}
std::size_t Engine::readBack(Volume& volume) {
  return parts_->readBack(volume);
}
std::uint64_t Engine::editVersion() const noexcept {
  return parts_->editVersion();
}

void Engine::timeKernels(bool on) noexcept {
  parts_->editor()->timeKernels(on);
}
bool Engine::broken() const noexcept {
  return parts_->deviceFailed() || parts_->editor()->broken();
}
const BrushProfile& Engine::profile() const noexcept {
  return parts_->editor()->profile();
}
BrickContent Engine::content(std::uint32_t brick) const {
  return parts_->editor()->content(brick);
}
bool Engine::isStored(std::uint32_t brick) const noexcept {
  return parts_->editor()->isStored(brick);
}
std::vector<std::uint32_t> Engine::bricksToChange(std::span<const EditCommand> commands) const {
  return parts_->editor()->bricksToChange(commands);
}
std::size_t Engine::changedBricks() const noexcept {
  return parts_->editor()->changedBricks();
}
std::vector<BrickContent> Engine::takeChanged(std::size_t most) {
  return parts_->editor()->takeChanged(most);
}

void Engine::beginIsovalue(double isovalue) {
  parts_->beginIsovalue(isovalue);
}
bool Engine::gatherIsovalue(std::size_t most, std::int64_t now_ns) {
  return parts_->gatherIsovalue(most, now_ns);
}
void Engine::endIsovalue(double keep) {
  parts_->endIsovalue(keep);
}

Volume Engine::filtered(const VolumeFacts& facts) {
  return parts_->filtered(facts);
}
bool Engine::filters() const noexcept {
  return parts_->filters();
}
double Engine::isovalue() const noexcept {
  return parts_->isovalue();
}

bool Engine::gradientEverywhere() const noexcept {
  return parts_->gradientEverywhere();
}
RenderedImage Engine::draw(const Camera& camera, const std::function<void()>& between, const DrawStyle& style) {
  return parts_->draw(camera, between, style);
}
void Engine::show(const Camera& camera, const DrawStyle& style, DrawOrder order) {
  parts_->show(camera, style, order);
}
std::vector<layout::BrickBounds> Engine::bounds() {
  return parts_->boundsNow();
}
bool Engine::pollPicture() {
  return parts_->pollPicture();
}
bool Engine::drawPiece(double most_s) {
  return parts_->drawPiece(most_s);
}
PictureState Engine::pictureState() const noexcept {
  return parts_->pictureState();
}
void Engine::copyPicture(std::vector<layout::PicturePixel>& pixels) {
  parts_->copyPicture(pixels);
}
RenderedImage Engine::picture() {
  return parts_->picture();
}

void Engine::shareWindows(const SharedWindows& shared) {
  parts_->shareWindows(shared);
}

std::size_t Engine::windowCapacity() const noexcept {
  return parts_->windowCapacity();
}

bool Engine::windowsInPlace() const noexcept {
  return parts_->windowsInPlace();
}

WindowExchange& Engine::exchange() noexcept {
  return parts_->exchange();
}
const gpu::GpuInfo& Engine::gpu() const noexcept {
  return parts_->gpu();
}
const std::vector<StageTime>& Engine::stages() const noexcept {
  return parts_->stages();
}
std::vector<MemoryFigure> Engine::memory() const {
  return parts_->memory();
}
gpu::GpuUse Engine::gpuUse() const {
  return parts_->gpuUse();
}
std::uint64_t Engine::budgetedBytes() const noexcept {
  return parts_->budgetedBytes();
}
PlanFacts Engine::planFacts() const noexcept {
  return parts_->planFacts();
}

}  // namespace palpate
