// SPDX-License-Identifier: Apache-2.0
// A whole run without engine and servo: an analytic body, a path built on it, an ideal tool, and ray-cast pictures.
#pragma once

#include <cmath>
#include <limits>
#include <memory>

#include "analytic_field.hpp"
#include "apps/path/surface_search.hpp"
#include "apps/path/touch_path.hpp"
#include "apps/view/compose_view.hpp"
#include "apps/view/framing.hpp"

namespace palpate {

inline constexpr double kSyntheticVoxel_m = 0.5e-3;

// A ball of 15 mm radius with waves of 1 mm. It is close enough to a distance field for sphere tracing.
inline AnalyticField bumpySphere() {
  return {[](const Vec3& p) {
            const double waves = std::sin(400 * p.x()) * std::sin(400 * p.y() + 1) * std::sin(400 * p.z() + 2);
            return 15e-3 - p.norm() + 1e-3 * waves;
          },
          22e-3, kSyntheticVoxel_m};
}

// An ideal tool: in contact wherever the HIP is inside, with the VHIP at the nearest surface point and a force of
// 500 N/m * depth.
inline std::vector<TickRecord> idealTouch(const SurfaceField& field, const TouchPath& path) {
  std::vector<TickRecord> records;
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const Vec3& hip_W = path.points[i].p_W;
    TickRecord r;
    r.tick = static_cast<std::int64_t>(i);
    r.time_s = path.points[i].time_s;
    r.tick_cost_ns = 1800 + static_cast<std::int32_t>(i * 7919 % 700) + (i % 611 == 0 ? 9000 : 0);
    r.lateness_ns = 30'000 + static_cast<std::int64_t>(i) * 104729 % 60'000 + (i == 1700 ? 2'500'000 : 0);
    r.in_contact = heightAt(field, hip_W).value_or(-1) > 0;
    const auto surface = r.in_contact ? snapToSurface(field, hip_W) : std::nullopt;
    r.in_contact = surface.has_value();
    for (int k = 0; k < 3; ++k) {
      r.hip_W[k] = hip_W[k];
      r.vhip_W[k] = surface ? surface->p_W[k] : hip_W[k];
      r.normal_W[k] = surface ? surface->normal_W[k] : 0;
      r.force_W[k] = surface ? 500 * (surface->p_W[k] - hip_W[k]) : 0;
    }
    records.push_back(r);
  }
  return records;
}

// Sphere tracing with a cautious step, shaded by a lamp beside the camera, on a light background.
inline RenderedImage castRays(const SurfaceField& field, const Camera& camera) {
  RenderedImage image{camera.width, camera.height, {}, {}};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vec3 ray_W = camera.rayThrough(x + 0.5, y + 0.5);
      double distance_m = std::numeric_limits<double>::infinity(), shade = 0.96;
      double density = 0;
      Vec3 gradient_W;
      for (double s = std::max(0.0, camera.position_W.norm() - 40e-3); s < camera.position_W.norm() + 40e-3;) {
        const bool inside = field.sample(camera.position_W + s * ray_W, density, gradient_W);
        if (inside && density > 0) {
          const Vec3 normal_W = -gradient_W.normalized();
          const Vec3 lamp_W = (-camera.forward_W + 0.6 * camera.up_W - 0.5 * camera.right_W).normalized();
          shade = 0.35 + 0.5 * std::max(0.0, normal_W.dot(lamp_W));
          distance_m = s;
          break;
        }
        s += inside ? std::max(0.05e-3, -0.6 * density) : 0.5e-3;
      }
      const auto grey = static_cast<std::uint8_t>(255 * shade);
      for (const double tint : {1.0, 0.97, 0.9}) image.rgba.push_back(static_cast<std::uint8_t>(grey * tint));
      image.rgba.push_back(255);
      image.distance_m.push_back(static_cast<float>(distance_m));
    }
  }
  return image;
}

struct SyntheticView {
  ViewLayout layout;
  ViewPictures pictures;
  ContactRegion region;
};

inline SyntheticView viewOf(const SurfaceField& field, const TouchRun& run, int width, int height) {
  SyntheticView view;
  view.layout = layOutView(width, height);
  view.region = findContactRegion(run.records, 4e-3);
  const PanelBox &a = view.layout.overview, &b = view.layout.close_up;
  view.pictures.overview_camera = overviewCamera(findObjectBounds(field), view.region, a.width, a.height);
  view.pictures.close_up_camera = closeUpCamera(field, view.region, b.width, b.height);
  view.pictures.overview = castRays(field, view.pictures.overview_camera);
  view.pictures.close_up = castRays(field, view.pictures.close_up_camera);
  return view;
}

inline TouchRun syntheticRun(const SurfaceField& field, const PathRequest& request) {
  TouchRun run;
  const TouchPath path = buildTouchPath(field, request);
  run.records = idealTouch(field, path);
  run.phases = path.phases;
  run.notes = path.notes;
  run.scene.rate_hz = 1 / kPathInterval_s;
  run.scene.volume = "phantom:bumpy-sphere?size=89";
  run.volume = {run.scene.volume, "phantom", field.size(), field.lattice().spacing_m, -0.02, 0.016, 0};
  run.machine = readMachineFacts();
  run.vulkan = {"llvmpipe (LLVM 15.0.6, 256 bits)", "Mesa 22.3.6", "1.3.230"};
  run.commit = "example";
  run.command = "palpate touch 'phantom:bumpy-sphere?size=89' --out out";
  run.stages = {{"load", 0.41}, {"upload", 0.02}, {"gradient", 0.11}, {"servo", 5.0}, {"picture", 0.3}};
  run.memory = {{"volume on the CPU", 3U << 20}, {"bricks on the GPU", 5U << 20}, {"window", 3ULL * 32 * 32 * 32 * 16}};
  run.plan = {"gradient of 610 of 1728 bricks: the others hold no surface; saves 8.7 MiB and 0.2 s",
              "no smoothing: the scene asks for none"};
  run.realtime = {"SCHED_FIFO not allowed: raise rtprio in /etc/security/limits.conf"};
  run.files = {"out/trace.csv", "out/summary.json", "out/report.html", "out/view.png"};
  run.exact = ExactErrors{0.01, 0.05, 0.3, 1.2};
  return run;
}

}  // namespace palpate
