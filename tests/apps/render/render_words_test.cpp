// SPDX-License-Identifier: Apache-2.0
// Every figure another, so that none stands for another.
#include "apps/render/render_words.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace render_words_test {

using testing::HasSubstr;

RenderRequest someRequest() {
  RenderRequest request;
  request.in = "scan";
  request.out = "o.png";
  request.width = 20;
  request.height = 10;
  return request;
}

Picture somePicture(const std::string& name) {
  Picture picture;
  picture.files.picture = name;
  picture.camera.position_W = {1, 2, 3};
  picture.camera.vertical_fov_rad = 0.25;
  picture.hit_pixels = 50;
  picture.nearest_m = 0.4;
  picture.farthest_m = 0.5;
  picture.draw_s = 0.125;
  picture.bytes = 1536;
  return picture;
}

RenderResult someResult() {
  RenderResult result;
  result.device = "a device";
  result.size = {21, 22, 23};
  result.extent = {{-0.09, -0.0, 0.5}, {0.07, 0.08, 0.6}};
  result.isovalue = 226;
  result.lowest = -1000;
  result.highest = 2000;
  result.target_W = {0.004, -0.005, -0.0};
  result.distance_m = 0.45;
  result.gpu_bytes = 4096;
  result.seconds = 1.5;
  result.pictures = {somePicture("o.png")};
  return result;
}

TEST(RenderWords, TellEveryFigure) {
  EXPECT_EQ(renderWords(someRequest(), someResult()),
            "Drew      scan (21 x 22 x 23 voxels) at isovalue 226 on a device\n"
            "Extent    -90,0,500 to 70,80,600 mm\n"
            "Camera    azimuth 0, elevation 0 degree, 450 mm from 4,-5,0 mm\n"
            "Picture   20 x 10 pixels; 50 pixels show something (25.0 %), 400 to 500 mm from the camera\n"
            "Time      a picture 125 ms; 1.50 s in all\n"
            "File      o.png, 1.5 KiB\n");
}

// Means, sums and extremes of two pictures, one of which shows nothing.
TEST(RenderWords, TellOfFramesDepthsSecondSurfacesAndSlices) {
  RenderRequest request = someRequest();
  request.depth = "d.pfm";
  request.json = "r.json";
  request.second = -300;
  request.second_opacity = 0.25;
  RenderResult result = someResult();
  result.slice_range = SliceRange{-100, 300};
  result.pictures = {somePicture("o_000.png"), somePicture("o_001.png")};
  result.pictures[0].hit_pixels = 0;
  result.pictures[0].nearest_m = result.pictures[0].farthest_m = 0;
  result.pictures[0].draw_s = 0.375;
  result.pictures[0].files.depth = "d_000.pfm";
  result.pictures[1].files.depth = "d_001.pfm";
  result.pictures[0].depth_bytes = result.pictures[1].depth_bytes = 512;
  EXPECT_EQ(renderWords(request, result),
            "Drew      scan (21 x 22 x 23 voxels) at isovalue 226 on a device\n"
            "Extent    -90,0,500 to 70,80,600 mm\n"
            "Second    isovalue -300, opacity 0.25\n"
            "Slices    -100 is black, 300 is white\n"
            "Camera    azimuth 0, elevation 0 degree, 450 mm from 4,-5,0 mm\n"
            "Picture   20 x 10 pixels; 50 pixels show something (12.5 %), 400 to 500 mm from the camera\n"
            "Time      a picture 250 ms; 1.50 s in all\n"
            "File      o_000.png to o_001.png, 3 KiB\n"
            "Depth     d_000.pfm to d_001.pfm, 1 KiB, metres along the ray\n"
            "JSON      r.json\n");
}

TEST(RenderWords, TellDistancesInMetres) {
  RenderRequest request = someRequest();
  request.second = -0.002;
  RenderResult result = someResult();
  result.is_distance = true;
  result.isovalue = 0;
  result.slice_range = SliceRange{-0.003, 0.003};
  const std::string words = renderWords(request, result);
  EXPECT_THAT(words, HasSubstr(" at isovalue 0 m on a device\n"));
  EXPECT_THAT(words, HasSubstr("Second    isovalue -0.002 m, opacity 0.35\n"));
  EXPECT_THAT(words, HasSubstr("Slices    -0.003 m is black, 0.003 m is white\n"));
  EXPECT_EQ(renderJson(request, result)["is_distance"], true);
}

TEST(RenderWords, TellOfOnePixel) {
  RenderResult result = someResult();
  result.pictures[0].hit_pixels = 1;
  EXPECT_THAT(renderWords(someRequest(), result), HasSubstr("; 1 pixel shows something (0.5 %), 400 to"));
}

TEST(RenderWords, TellWhereNothingIsSeen) {
  RenderResult result = someResult();
  result.pictures[0].hit_pixels = 0;
  EXPECT_THAT(renderWords(someRequest(), result), HasSubstr("20 x 10 pixels; nothing is seen: "));
  EXPECT_THAT(renderWords(someRequest(), result),
              HasSubstr("takes all of it; the volume reaches from -90,0,500 to 70,80,600 mm\n"));
  const auto picture = renderJson(someRequest(), result)["pictures"][0];
  EXPECT_TRUE(picture["nearest_m"].is_null());
  EXPECT_TRUE(picture["farthest_m"].is_null());
}

TEST(RenderWords, JsonHasTheCameraOfEachPicture) {
  RenderRequest request = someRequest();
  RenderResult result = someResult();
  auto json = renderJson(request, result);
  EXPECT_EQ(json["schema"], "palpate.render/1");
  EXPECT_EQ(json["in"], "scan");
  EXPECT_EQ(json["size_voxel"], nlohmann::ordered_json({21, 22, 23}));
  EXPECT_EQ(json["extent_m"], nlohmann::ordered_json::parse("[[-0.09, 0.0, 0.5], [0.07, 0.08, 0.6]]"));
  EXPECT_EQ(json["is_distance"], false);
  EXPECT_EQ(json["isovalue"], 226);
  EXPECT_EQ(json["density"], nlohmann::ordered_json({-1000.0, 2000.0}));
  EXPECT_EQ(json["vulkan_device"], "a device");
  EXPECT_EQ(json["gpu_bytes"], 4096);
  EXPECT_EQ(json["size_pixel"], nlohmann::ordered_json({20, 10}));
  EXPECT_EQ(json["target_m"], nlohmann::ordered_json({0.004, -0.005, 0.0}));
  EXPECT_EQ(json["distance_m"], 0.45);
  EXPECT_EQ(json["seconds"], 1.5);
  EXPECT_TRUE(json["second_isovalue"].is_null());
  EXPECT_TRUE(json["slice_range"].is_null());
  ASSERT_EQ(json["pictures"].size(), 1U);
  auto picture = json["pictures"][0];
  EXPECT_EQ(picture["picture"], "o.png");
  EXPECT_TRUE(picture["depth"].is_null());
  EXPECT_EQ(picture["camera"]["position_m"], nlohmann::ordered_json({1.0, 2.0, 3.0}));
  EXPECT_EQ(picture["camera"]["forward"], nlohmann::ordered_json({0.0, 0.0, -1.0}));
  EXPECT_EQ(picture["camera"]["right"], nlohmann::ordered_json({1.0, 0.0, 0.0}));
  EXPECT_EQ(picture["camera"]["up"], nlohmann::ordered_json({0.0, 1.0, 0.0}));
  EXPECT_EQ(picture["camera"]["vertical_fov_rad"], 0.25);
  EXPECT_EQ(picture["hit_pixels"], 50);
  EXPECT_EQ(picture["nearest_m"], 0.4);
  EXPECT_EQ(picture["farthest_m"], 0.5);
  EXPECT_EQ(picture["draw_s"], 0.125);
  EXPECT_EQ(json.dump().find("-0.0,"), std::string::npos);
  request.second = -300;
  result.slice_range = SliceRange{-100, 300};
  result.pictures[0].files.depth = "d.pfm";
  json = renderJson(request, result);
  EXPECT_EQ(json["second_isovalue"], -300);
  EXPECT_EQ(json["slice_range"], nlohmann::ordered_json({-100.0, 300.0}));
  EXPECT_EQ(json["pictures"][0]["depth"], "d.pfm");
}

}  // namespace render_words_test
}  // namespace palpate
