// SPDX-License-Identifier: Apache-2.0
#include "apps/render/render_words.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "apps/render/view_words.hpp"
#include "base/byte_size.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

// Of all pictures.
struct Sums {
  std::size_t hit_pixels = 0;
  double draw_s = 0, nearest_m = 0, farthest_m = 0;
  std::uint64_t bytes = 0, depth_bytes = 0;
};

Sums sumsOf(const RenderResult& result) {
  Sums sums;
  for (const Picture& picture : result.pictures) {
    if (picture.hit_pixels > 0) {
      sums.nearest_m = sums.hit_pixels == 0 ? picture.nearest_m : std::min(sums.nearest_m, picture.nearest_m);
      sums.farthest_m = std::max(sums.farthest_m, picture.farthest_m);
    }
    sums.hit_pixels += picture.hit_pixels;
    sums.draw_s += picture.draw_s;
    sums.bytes += picture.bytes;
    sums.depth_bytes += picture.depth_bytes;
  }
  return sums;
}

// "out.png", "out_000.png to out_059.png"
std::string nameWords(const RenderResult& result, std::string PictureFiles::*name) {
  const std::string& first = result.pictures.front().files.*name;
  return result.pictures.size() == 1 ? first : first + " to " + result.pictures.back().files.*name;
}

std::string seenWords(const RenderRequest& request, const RenderResult& result, const Sums& sums) {
  if (sums.hit_pixels == 0)
    return "nothing is seen: the camera looks beside the object, or a clip plane takes all of it; the volume reaches "
           "from " +
           boxWords(result.extent);
  const double pixels =
      static_cast<double>(request.width) * request.height * static_cast<double>(result.pictures.size());
  return fmt::format("{} something ({:.1f} %), {:.4g} to {:.4g} mm from the camera",
                     sums.hit_pixels == 1 ? "1 pixel shows" : fmt::format("{} pixels show", sums.hit_pixels),
                     100 * static_cast<double>(sums.hit_pixels) / pixels, sums.nearest_m * kMillimetresPerMetre,
                     sums.farthest_m * kMillimetresPerMetre);
}

nlohmann::ordered_json vectorJson(const Vec3& vector) {
  return {vector.x() + 0.0, vector.y() + 0.0, vector.z() + 0.0};  // no -0
}

nlohmann::ordered_json pictureJson(const Picture& picture) {
  const Camera& camera = picture.camera;
  nlohmann::ordered_json json = {{"picture", picture.files.picture},
                                 {"depth", nullptr},
                                 {"camera",
                                  {{"position_m", vectorJson(camera.position_W)},
                                   {"forward", vectorJson(camera.forward_W)},
                                   {"right", vectorJson(camera.right_W)},
                                   {"up", vectorJson(camera.up_W)},
                                   {"vertical_fov_rad", camera.vertical_fov_rad}}},
                                 {"hit_pixels", picture.hit_pixels},
                                 {"nearest_m", nullptr},
                                 {"farthest_m", nullptr},
                                 {"draw_s", picture.draw_s}};
  if (!picture.files.depth.empty()) json["depth"] = picture.files.depth;
  if (picture.hit_pixels > 0) {
    json["nearest_m"] = picture.nearest_m;
    json["farthest_m"] = picture.farthest_m;
  }
  return json;
}

}  // namespace

std::string renderWords(const RenderRequest& request, const RenderResult& result) {
  const Sums sums = sumsOf(result);
  const Vec3 target_mm = (result.target_W * kMillimetresPerMetre).array() + 0.0;  // no -0
  const auto count = static_cast<double>(result.pictures.size());
  const char* unit = result.unit();
  std::string text =
      fmt::format("Drew      {} ({} x {} x {} voxels) at isovalue {:g}{} on {}\n", request.in, result.size.x(),
                  result.size.y(), result.size.z(), result.isovalue, unit, result.device);
  text += fmt::format("Extent    {}\n", boxWords(result.extent));
  if (request.second)
    text += fmt::format("Second    isovalue {:g}{}, opacity {:g}\n", *request.second, unit, request.second_opacity);
  if (result.slice_range) {
    text += fmt::format("Slices    {:g}{} is black, {:g}{} is white\n", result.slice_range->black, unit,
                        result.slice_range->white, unit);
  }
  text += fmt::format("Camera    azimuth {:g}, elevation {:g} degree, {:.4g} mm from {:.4g},{:.4g},{:.4g} mm\n",
                      request.view.azimuth_rad * kDegreesPerRadian, request.view.elevation_rad * kDegreesPerRadian,
                      result.distance_m * kMillimetresPerMetre, target_mm.x(), target_mm.y(), target_mm.z());
  text +=
      fmt::format("Picture   {} x {} pixels; {}\n", request.width, request.height, seenWords(request, result, sums));
  text += fmt::format("Time      a picture {:.3g} ms; {:.2f} s in all\n", 1e3 * sums.draw_s / count, result.seconds);
  text += fmt::format("File      {}, {}\n", nameWords(result, &PictureFiles::picture), bytesInWords(sums.bytes));
  if (!request.depth.empty()) {
    text += fmt::format("Depth     {}, {}, metres along the ray\n", nameWords(result, &PictureFiles::depth),
                        bytesInWords(sums.depth_bytes));
  }
  if (!request.json.empty()) text += fmt::format("JSON      {}\n", request.json);
  return text;
}

nlohmann::ordered_json renderJson(const RenderRequest& request, const RenderResult& result) {
  const Vec3i& size = result.size;
  nlohmann::ordered_json json = {{"schema", "palpate.render/1"},
                                 {"in", request.in},
                                 {"size_voxel", {size.x(), size.y(), size.z()}},
                                 {"extent_m", {vectorJson(result.extent.low_W), vectorJson(result.extent.high_W)}},
                                 {"is_distance", result.is_distance},
                                 {"isovalue", result.isovalue},
                                 {"second_isovalue", nullptr},
                                 {"density", {result.lowest, result.highest}},
                                 {"slice_range", nullptr},
                                 {"vulkan_device", result.device},
                                 {"gpu_bytes", result.gpu_bytes},
                                 {"size_pixel", {request.width, request.height}},
                                 {"target_m", vectorJson(result.target_W)},
                                 {"distance_m", result.distance_m},
                                 {"seconds", result.seconds},
                                 {"pictures", nlohmann::ordered_json::array()}};
  if (request.second) json["second_isovalue"] = *request.second;
  if (result.slice_range) json["slice_range"] = {result.slice_range->black, result.slice_range->white};
  for (const Picture& picture : result.pictures) json["pictures"].push_back(pictureJson(picture));
  return json;
}

}  // namespace palpate
