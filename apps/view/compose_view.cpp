// SPDX-License-Identifier: Apache-2.0
#include "apps/view/compose_view.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/view/canvas.hpp"
#include "apps/view/force_arrows.hpp"
#include "apps/view/legend.hpp"
#include "apps/view/panel.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kLeastWidth = 480, kLeastHeight = 270, kMostSide = 16384;
constexpr double kTitle = 62, kLegend = 64, kBorder = 8;  // [pixel] at scale 1
constexpr double kOverviewShare = 0.4;                    // of the width
constexpr int kArrows = 14;
constexpr double kLongestArrow = 0.4;  // of the contact region's radius

int pixels(double value) {
  return static_cast<int>(std::lround(value));
}

void checkPicture(const RenderedImage& image, const Camera& camera, const PanelBox& box, const char* name) {
  const bool fits = image.complete() && image.width == box.width && image.height == box.height &&
                    camera.width == box.width && camera.height == box.height;
  if (fits) return;
  throw Error(Error::Code::kBadInput, name, fmt::format("the picture is not {} x {} pixels", box.width, box.height),
              "render it in the size of its panel");
}

double tolerance(const TouchRun& run, const Camera& camera, const ContactRegion& region) {
  const double depth_m = (region.centre_W - camera.position_W).dot(camera.forward_W);
  return std::max({2 * camera.pixelSize(std::max(depth_m, 0.0)), 0.5 * run.volume.spacing_m.minCoeff(), 1e-6});
}

void drawOverview(Canvas& canvas, const ViewLayout& layout, const ViewPictures& pictures, const ContactRegion& region,
                  const TouchRun& run) {
  const Camera& camera = pictures.overview_camera;
  canvas.image(pictures.overview, 0, 0);
  Panel panel(canvas, camera, pictures.overview, tolerance(run, camera, region), layout.scale);
  panel.drawObjects(run.object_outlines);
  panel.drawHipPath(run.records);
  panel.drawVhipPath(run.records);
  panel.drawScaleBar(region.centre_W);
  panel.drawCaption("Whole object");
  panel.drawBox(region, "close-up");
  panel.drawEnds(run.records);
}

void drawCloseUp(Canvas& canvas, const ViewLayout& layout, const ViewPictures& pictures, const ContactRegion& region,
                 const TouchRun& run, const ForceArrows& forces) {
  const Camera& camera = pictures.close_up_camera;
  canvas.image(pictures.close_up, 0, 0);
  Panel panel(canvas, camera, pictures.close_up, tolerance(run, camera, region), layout.scale);
  panel.drawObjects(run.object_outlines);
  panel.drawHipPath(run.records);
  panel.drawVhipPath(run.records);
  panel.drawForces(forces, kLongestArrow * region.radius_m);
  panel.drawScaleBar(region.centre_W);
  panel.drawCaption(region.touched ? "Contact, close up" : "The path: nothing was touched");
  panel.drawEnds(run.records);
}

}  // namespace

ViewLayout layOutView(int width, int height) {
  if (width < kLeastWidth || height < kLeastHeight || std::max(width, height) > kMostSide) {
    throw Error(Error::Code::kBadInput, "image size", fmt::format("{} x {} pixels cannot be drawn", width, height),
                fmt::format("ask for {} x {} to {} x {}", kLeastWidth, kLeastHeight, kMostSide, kMostSide));
  }
  ViewLayout layout;
  layout.width = width;
  layout.height = height;
  layout.scale = std::min(width / 1280.0, height / 720.0);
  const int top = pixels(kTitle * layout.scale), border = pixels(kBorder * layout.scale);
  const int panel_height = height - top - pixels(kLegend * layout.scale);
  const int split = pixels(kOverviewShare * width);
  layout.overview = {border, top, split - border - border / 2, panel_height};
  layout.close_up = {split + border / 2, top, width - split - border - border / 2, panel_height};
  return layout;
}

std::string composeView(const ViewLayout& layout, const ViewPictures& pictures, const ContactRegion& region,
                        const TouchRun& run, const std::function<void()>& between) {
  checkPicture(pictures.overview, pictures.overview_camera, layout.overview, "overview");
  checkPicture(pictures.close_up, pictures.close_up_camera, layout.close_up, "close-up");
  const RunFigures figures = figuresOf(run);
  const ForceArrows forces = chooseForceArrows(run.records, kArrows);
  const std::unique_ptr<Canvas> picture = makeCanvas(layout.width, layout.height);
  Canvas& canvas = *picture;
  const auto within = [&](const PanelBox& box, const auto& draw) {
    canvas.pushClip(box.x, box.y, box.width, box.height);
    draw();
    canvas.popClip();
    canvas.strokeRectangle(box.x + 0.5, box.y + 0.5, box.width - 1, box.height - 1, {0.75, 0.77, 0.80}, 1);
  };
  within(layout.overview, [&] { drawOverview(canvas, layout, pictures, region, run); });
  within(layout.close_up, [&] { drawCloseUp(canvas, layout, pictures, region, run, forces); });
  drawTitle(canvas, run, figures, layout.width, layout.scale);
  drawLegend(canvas, forces, layout.overview.y + layout.overview.height, layout.scale);
  return canvas.png(between);
}

}  // namespace palpate
