// SPDX-License-Identifier: Apache-2.0
#include "apps/render/render_job.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/render/depth_file.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/render/slice_range.hpp"
#include "apps/view/picture_png.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/draw/drawing.hpp"
#include "engine/field/statistics.hpp"
#include "engine/filter/filter_spec.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {
namespace {

constexpr int kHistogramBins = 4096;

void stopIfInterrupted(std::size_t finished) {
  throwIfInterrupted("palpate render",
                     finished == 0 ? "nothing was written; start it again"
                                   : "the pictures that it had finished are there; start it again for the rest");
}

// A file of a picture, opened before the long work, so that a folder without write permission is refused at once.
class OutputFile {
 public:
  explicit OutputFile(const std::string& name) {
    if (!name.empty()) file_ = std::make_unique<AtomicFile>(name);
  }
  // Returns the number of bytes.
  std::uint64_t write(const std::string& bytes) {
    file_->write(bytes);
    return bytes.size();
  }
  void commit() {
    if (file_) file_->commit();
  }
  [[nodiscard]] explicit operator bool() const noexcept { return file_ != nullptr; }

 private:
  std::unique_ptr<AtomicFile> file_;
};

struct OutputFiles {
  OutputFile picture, depth;
  explicit OutputFiles(const PictureFiles& files) : picture(files.picture), depth(files.depth) {}
};

// `flag`: of the isovalue. Bounds of the field that is drawn.
void checkGivesSurface(double isovalue, const RenderResult& field, const char* flag) {
  if (isovalue >= field.lowest && isovalue < field.highest) return;
  refuse(flag,
         fmt::format("isovalue {:g} gives no surface: the densities that are drawn are {:g} to {:g}", isovalue,
                     field.lowest, field.highest),
         "choose one between them");
}

void countHits(const RenderedImage& image, Picture& picture) {
  for (const float distance : image.distance_m) {
    if (!std::isfinite(distance)) continue;
    const double distance_m = distance;
    picture.nearest_m = picture.hit_pixels == 0 ? distance_m : std::min(picture.nearest_m, distance_m);
    picture.farthest_m = std::max(picture.farthest_m, distance_m);
    ++picture.hit_pixels;
  }
}

DrawStyle styleOf(const RenderRequest& request) {
  DrawStyle style;
  style.occlusion = request.occlusion && !request.normals;
  style.normals = request.normals;
  style.clips = request.clips;
  style.slices = request.slices;
  style.other_isovalue = request.second;
  style.other_opacity = request.second_opacity;
  return style;
}

// The volume on the device, drawn frame by frame.
class Job {
 public:
  Job(const RenderRequest& request, const Volume& volume, const std::vector<FilterSpec>& chain, Progress& progress)
      : request_(request),
        progress_(progress),
        gpu_(gpu::GpuRequest{.name = request.gpu}),
        transfer_(gpu_),
        pool_(gpu_, transfer_, volume, makeGpuBudget(request.gpu_memory_bytes)),
        style_(styleOf(request)) {
    result_.device = gpu_.info().name;
    result_.size = volume.size();
    const auto isovalue = static_cast<float>(request.isovalue ? *request.isovalue : defaultIsovalue(volume));
    checkIsovalue(volume, isovalue);
    std::vector<FilterStep> steps = lowerFilters(chain, volume.lattice().spacing_m, isovalue);
    if (!steps.empty()) progress.stage("filtering on Vulkan");
    filters_ = filteredBy(gpu_, transfer_, pool_, std::move(steps), [&](double done) {
      progress.fraction(done);
      stopIfInterrupted(0);
    });
    result_.isovalue = isovalueAfter(chain, isovalue);
    findBounds();
    if (!request.slices.empty()) chooseSliceRange(volume, hasDistance(chain));
  }

  // `first`: files of the first frame.
  RenderResult run(OutputFiles first) {
    Drawing drawing(gpu_, transfer_, field(), *bounds_);
    const std::vector<PictureFiles> files = pictureFiles(request_);
    progress_.stage("drawing");
    for (std::size_t frame = 0; frame < files.size(); ++frame) {
      OutputFiles outputs = frame == 0 ? std::move(first) : OutputFiles(files[frame]);
      draw(drawing, static_cast<int>(frame), files[frame], outputs);
      progress_.fraction(static_cast<double>(frame + 1) / static_cast<double>(files.size()));
    }
    result_.gpu_bytes = gpu_.bytesInUse();
    return std::move(result_);
  }

 private:
  [[nodiscard]] const BrickPool& field() const { return filters_ ? filters_->result() : pool_; }

  void findBounds() {
    bounds_ = std::make_unique<BrickBoundsPass>(gpu_, field());
    bounds_->run();
    const std::vector<layout::BrickBounds> bounds = bounds_->read(transfer_);
    result_.lowest = bounds.front().lowest;
    result_.highest = bounds.front().highest;
    for (const layout::BrickBounds& brick : bounds) {
      result_.lowest = std::min<double>(result_.lowest, brick.lowest);
      result_.highest = std::max<double>(result_.highest, brick.highest);
    }
    checkGivesSurface(result_.isovalue, result_, "--iso");
    if (request_.second) checkGivesSurface(*request_.second, result_, "--second");
    const auto outermost = static_cast<float>(std::min(result_.isovalue, request_.second.value_or(result_.isovalue)));
    const BrickGrid grid = field().grid();
    // A slice reaches to the volume's ends.
    const SeenExtent extent = request_.slices.empty() ? objectExtent(bounds, grid, field().lattice(), outermost)
                                                      : wholeExtent(grid, field().lattice());
    result_.target_W = targetOf(request_, extent);
    result_.distance_m = request_.distance_m ? *request_.distance_m : fittingDistance(request_, extent);
  }

  void chooseSliceRange(const Volume& volume, bool is_distance) {
    result_.slice_range = request_.slice_range;
    if (!result_.slice_range) {
      result_.slice_range = is_distance ? SliceRange{result_.lowest, result_.highest}
                                        : sliceRangeFor(statisticsOf(volume, kHistogramBins));
    }
    style_.slice_black = result_.slice_range->black;
    style_.slice_white = result_.slice_range->white;
  }

  void draw(Drawing& drawing, int frame, const PictureFiles& files, OutputFiles& outputs) {
    const auto stop = [this] { stopIfInterrupted(result_.pictures.size()); };
    Picture picture{.files = files, .camera = frameCamera(request_, result_.target_W, result_.distance_m, frame)};
    const Stopwatch watch;
    drawing.show(picture.camera, result_.isovalue, style_);
    drawing.finish(stop);
    const RenderedImage image = drawing.image();
    picture.draw_s = watch.seconds();
    countHits(image, picture);
    picture.bytes = outputs.picture.write(pngOf(image, stop));
    if (outputs.depth) picture.depth_bytes = outputs.depth.write(pfmOf(image));
    stop();
    outputs.depth.commit();  // the larger one first: where the disk gets full, there is neither
    outputs.picture.commit();
    result_.pictures.push_back(std::move(picture));
  }

  const RenderRequest& request_;
  Progress& progress_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickPool pool_;
  std::unique_ptr<FilterChain> filters_;
  std::unique_ptr<BrickBoundsPass> bounds_;
  DrawStyle style_;
  RenderResult result_;
};

}  // namespace

RenderResult render(const RenderRequest& request, Progress& progress) {
  const Stopwatch watch;
  checkPictureFiles(request);
  std::vector<FilterSpec> chain;
  if (!request.filter.empty()) chain = filterChain(request.filter);
  OutputFiles first(pictureFiles(request).front());
  progress.stage("loading " + request.in);
  const Volume volume = loadAndTell(request.in, progress);
  checkTouchable(volume);
  stopIfInterrupted(0);
  progress.stage("computing on Vulkan");
  RenderResult result = Job(request, volume, chain, progress).run(std::move(first));
  progress.done();
  result.seconds = watch.seconds();
  return result;
}

}  // namespace palpate
