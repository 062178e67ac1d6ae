// SPDX-License-Identifier: Apache-2.0
#include "apps/render/render_job.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/render/asked_style.hpp"
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
#include "engine/passes/pool_volume.hpp"

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
  refuse(
      flag,
      fmt::format("isovalue {:g}{} gives no surface: the {} that are drawn are {:g} to {:g}{}", isovalue, field.unit(),
                  field.is_distance ? "distances" : "densities", field.lowest, field.highest, field.unit()),
      "choose one between them");
}

// Within the first surface nobody would see it.
void checkIsAround(double second, const RenderResult& field) {
  if (static_cast<float>(second) < static_cast<float>(field.isovalue)) return;
  refuse("--second",
         fmt::format("isovalue {:g}{} is not below that of the first surface, {:g}{}, so it lies within it", second,
                     field.unit(), field.isovalue, field.unit()),
         field.is_distance ? "give a distance below it: outside the object they are below 0"
                           : "give one below it, or choose another --iso");
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

// The volume on the device, drawn frame by frame.
class Job {
 public:
  Job(const RenderRequest& request, const Volume& volume, const std::vector<FilterSpec>& chain, Progress& progress)
      : request_(request),
        progress_(progress),
        style_(styleOf(request, volume.lattice(), volume.size())),
        gpu_(gpu::GpuRequest{.name = request.gpu}),
        transfer_(gpu_),
        pool_(gpu_, transfer_, volume, makeGpuBudget(request.gpu_memory_bytes)) {
    result_.device = gpu_.info().name;
    result_.size = volume.size();
    result_.extent = worldBoxOf(volume.lattice(), volume.size());
    const auto isovalue = static_cast<float>(request.isovalue ? *request.isovalue : defaultIsovalue(volume));
    checkIsovalue(volume, isovalue);
    result_.isovalue = isovalueAfter(chain, isovalue);
    result_.is_distance = hasDistance(chain);
    if (request.second) checkIsAround(*request.second, result_);
    std::vector<FilterStep> steps = lowerFilters(chain, volume.lattice().spacing_m, isovalue);
    if (!steps.empty()) progress.stage("filtering on Vulkan");
    filters_ = filteredBy(gpu_, transfer_, pool_, std::move(steps), [&](double done) {
      progress.fraction(done);
      stopIfInterrupted(0);
    });
    findBounds(volume);
    if (!request.slices.empty()) chooseSliceRange(volume);
  }

  // `first`: files of the first frame.
  RenderResult run(OutputFiles first) {
    Drawing drawing(gpu_, transfer_, field(), *bounds_);
    const std::vector<PictureFiles> files = pictureFiles(request_);
    progress_.stage("drawing");
    draw(drawing, 0, files.front(), std::move(first));
    for (std::size_t frame = 1; frame < files.size(); ++frame) {
      draw(drawing, static_cast<int>(frame), files[frame], OutputFiles(files[frame]));
    }
    result_.gpu_bytes = gpu_.bytesInUse();
    return std::move(result_);
  }

 private:
  [[nodiscard]] const BrickPool& field() const { return filters_ ? filters_->result() : pool_; }

  void findBounds(const Volume& volume) {
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
    const SeenExtent extent = request_.slices.empty() ? objectExtent(bounds, grid, field().lattice(), outermost,
                                                                     style_.clips, filters_ ? nullptr : &volume)
                                                      : wholeExtent(grid, field().lattice(), style_.clips);
    result_.target_W = targetOf(request_, extent);
    result_.distance_m =
        request_.distance_m ? *request_.distance_m : fittingDistance(request_, extent, [] { stopIfInterrupted(0); });
  }

  // Of the field that is drawn. The ends of a distance are the ends of its band, which most voxels hold.
  [[nodiscard]] SliceRange fieldRange(const Volume& volume) {
    if (result_.is_distance) return {result_.lowest, result_.highest};
    if (!filters_) return sliceRangeFor(statisticsOf(volume, kHistogramBins));
    progress_.stage("looking at the filtered densities");
    return sliceRangeFor(statisticsOf(volumeOf(field(), transfer_, volume.facts()), kHistogramBins));
  }

  void chooseSliceRange(const Volume& volume) {
    result_.slice_range = request_.slice_range ? *request_.slice_range : fieldRange(volume);
    style_.slice_black = result_.slice_range->black;
    style_.slice_white = result_.slice_range->white;
  }

  void draw(Drawing& drawing, int frame, const PictureFiles& files, OutputFiles outputs) {
    const auto stop = [this] { stopIfInterrupted(result_.pictures.size()); };
    Picture picture{.files = files, .camera = frameCamera(request_, result_.target_W, result_.distance_m, frame)};
    const Stopwatch watch;
    drawing.show(picture.camera, result_.isovalue, style_);
    drawing.finish([&] {
      stop();
      progress_.fraction((frame + drawing.share()) / request_.frames);
    });
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
  DrawStyle style_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickPool pool_;
  std::unique_ptr<FilterChain> filters_;
  std::unique_ptr<BrickBoundsPass> bounds_;
  RenderResult result_;
};

}  // namespace

RenderResult render(const RenderRequest& request, Progress& progress) {
  const Stopwatch watch;
  checkPictureFiles(request);
  checkPicturesWritable(request);
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
