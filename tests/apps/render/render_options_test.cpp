// SPDX-License-Identifier: Apache-2.0
#include "apps/render/render_options.hpp"

#include <gmock/gmock.h>

#include "tests/support/refusal.hpp"

namespace palpate {
namespace render_options_test {

using testing::HasSubstr;
using testing::StartsWith;

struct Given {
  const char* flag;
  const char* text = "";
};

RenderRequest requestOf(const std::vector<Given>& all) {
  const auto& rows = renderOptions();
  std::vector<std::vector<std::string>> given(rows.size());
  for (const Given& one : all) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].flag == one.flag) given[i].emplace_back(one.text);
    }
  }
  RenderRequest request;
  setRenderOptions(given, request);
  return request;
}

std::string refusal(const std::vector<Given>& all) {
  return refusalOf([&] { (void)requestOf(all); });
}

std::string helpOf(const std::string& flag) {
  for (const RenderOption& row : renderOptions()) {
    if (row.flag == flag) return optionHelp(row);
  }
  return "no such option";
}

TEST(RenderOptions, SetMembersInSiUnits) {
  const RenderRequest request = requestOf({{"--iso", "-226.5"},
                                           {"--size", "640x480"},
                                           {"--from", "90,45"},
                                           {"--target", "1,-2,3"},
                                           {"--distance", "400"},
                                           {"--fov", "60"},
                                           {"--zoom", "2.5"},
                                           {"--frames", "60"},
                                           {"--clip", "x=12"},
                                           {"--clip", "-y=3"},
                                           {"--slice", "z=25%"},
                                           {"--slice-range", "-5,7"},
                                           {"--second", "-300"},
                                           {"--second-opacity", "0.5"},
                                           {"--occlusion", "off"},
                                           {"--filter", "median:1"},
                                           {"--gpu", "llvm"},
                                           {"--gpu-memory", "2GiB"}});
  EXPECT_EQ(request.isovalue, -226.5);
  EXPECT_EQ(request.width, 640);
  EXPECT_EQ(request.height, 480);
  EXPECT_NEAR(request.view.azimuth_rad, 1.5707963267948966, 1e-15);
  EXPECT_NEAR(request.view.elevation_rad, 0.7853981633974483, 1e-15);
  ASSERT_TRUE(request.target_W);
  EXPECT_TRUE(request.target_W->isApprox(Vec3(0.001, -0.002, 0.003), 1e-15));
  EXPECT_NEAR(request.distance_m.value_or(0), 0.4, 1e-15);
  EXPECT_NEAR(request.fov_rad, 1.0471975511965976, 1e-15);
  EXPECT_EQ(request.zoom, 2.5);
  EXPECT_EQ(request.frames, 60);
  ASSERT_EQ(request.clips.size(), 2U);
  EXPECT_EQ(request.clips[1].normal_W, -Vec3::UnitY());
  ASSERT_EQ(request.slices.size(), 1U);
  EXPECT_EQ(request.slices[0].normal_W, Vec3::UnitZ());
  EXPECT_EQ(request.slices[0].place, 0.25);
  EXPECT_TRUE(request.slices[0].is_share);
  ASSERT_TRUE(request.slice_range);
  EXPECT_EQ(request.slice_range->black, -5);
  EXPECT_EQ(request.slice_range->white, 7);
  EXPECT_EQ(request.second, -300);
  EXPECT_EQ(request.second_opacity, 0.5);
  EXPECT_FALSE(request.occlusion);
  EXPECT_FALSE(request.normals);
  EXPECT_EQ(request.filter, "median:1");
  EXPECT_EQ(request.gpu, "llvm");
  EXPECT_EQ(request.gpu_memory_bytes, std::uint64_t{2} << 30U);
  EXPECT_TRUE(requestOf({{"--normals"}}).normals);
  EXPECT_TRUE(requestOf({{"--occlusion", "on"}}).occlusion);
  EXPECT_NEAR(requestOf({{"--view", "back"}}).view.azimuth_rad, 3.141592653589793, 1e-15);
}

// What a help text calls the default is what the request has without the option.
TEST(RenderOptions, TellTheirDefaults) {
  const RenderRequest plain;
  for (const RenderOption& row : renderOptions()) {
    if (row.standard.empty()) continue;
    EXPECT_THAT(optionHelp(row), HasSubstr("default " + row.standard)) << row.flag;
    RenderRequest request;
    EXPECT_TRUE(row.set(row.standard, request)) << row.flag;
    EXPECT_EQ(request.width, plain.width);
    EXPECT_EQ(request.height, plain.height);
    EXPECT_EQ(request.frames, plain.frames);
    EXPECT_EQ(request.view.azimuth_rad, plain.view.azimuth_rad);
    EXPECT_EQ(request.view.elevation_rad, plain.view.elevation_rad);
    EXPECT_EQ(request.fov_rad, plain.fov_rad);
    EXPECT_EQ(request.zoom, plain.zoom);
    EXPECT_EQ(request.second_opacity, plain.second_opacity);
    EXPECT_EQ(request.occlusion, plain.occlusion);
    EXPECT_EQ(request.gpu_memory_bytes, plain.gpu_memory_bytes);
  }
  EXPECT_EQ(helpOf("--fov"),
            "angle of view from the lower to the upper edge [degree] (a number from 1 to 120; default 30)");
  EXPECT_EQ(helpOf("--gpu"), "part of the Vulkan device's name; the best one if not given");
  EXPECT_THAT(helpOf("--clip"), HasSubstr("; at most 6)"));
  EXPECT_THAT(helpOf("--slice"), HasSubstr("; at most 3)"));
}

// In the words of a help text a value has a name, and no limit that only a float has.
TEST(RenderOptions, TellWhatStandsForAValue) {
  for (const RenderOption& row : renderOptions()) {
    EXPECT_EQ(row.placeholder.empty(), row.isBare() || !row.words.empty()) << row.flag;
    EXPECT_THAT(row.placeholder, testing::Not(HasSubstr(" "))) << row.flag;
    EXPECT_THAT(optionHelp(row), testing::Not(HasSubstr("e+"))) << row.flag;
  }
  EXPECT_THAT(helpOf("--second"), HasSubstr("[density] (a number that a 32-bit float holds)"));
}

TEST(RenderOptions, RefuseWhatTheyDoNotTake) {
  const Given bad[] = {{"--iso", "nan"},      {"--iso", "1e39"},      {"--iso", ""},           {"--size", "640"},
                       {"--size", "16385x1"}, {"--size", "1x16385"},  {"--size", "4097x4096"}, {"--view", "side"},
                       {"--from", "0,91"},    {"--target", "1,2"},    {"--target", "0,0,2e6"}, {"--distance", "0"},
                       {"--distance", "2e6"}, {"--fov", "0"},         {"--fov", "121"},        {"--zoom", "0"},
                       {"--zoom", "1001"},    {"--frames", "0"},      {"--frames", "1.5"},     {"--frames", "3601"},
                       {"--clip", "x=101%"},  {"--slice", "0,0,0@1"}, {"--second", "inf"},     {"--occlusion", "no"},
                       {"--filter", ""},      {"--gpu", ""}};
  for (const Given& one : bad) {
    const std::string words = refusal({one});
    EXPECT_THAT(words, StartsWith(std::string(one.flag) + ": '" + one.text + "' is not what it takes; ")) << one.text;
  }
  EXPECT_THAT(refusal({{"--second", "0"}, {"--second-opacity", "1.1"}}), StartsWith("--second-opacity: '1.1'"));
  EXPECT_THAT(refusal({{"--slice", "x=0"}, {"--slice-range", "1,1"}}), StartsWith("--slice-range: '1,1'"));
  EXPECT_THAT(refusal({{"--gpu-memory", "much"}}), StartsWith("--gpu-memory: "));
  EXPECT_THAT(refusal({{"--view", "frnt"}}), HasSubstr("did you mean front?"));
  EXPECT_THAT(refusal({{"--distance", "x"}}), HasSubstr("give a number from 0.001 to 1000000, in mm"));
}

// The largest that are allowed: 4096 x 4096 pixels of 8 bytes are 128 MiB.
TEST(RenderOptions, TakeTheirLimits) {
  for (const Given& one : {Given{"--size", "4096x4096"}, Given{"--size", "16384x1024"}, Given{"--size", "1x1"},
                           Given{"--frames", "3600"}, Given{"--fov", "120"}, Given{"--distance", "1e6"}})
    EXPECT_EQ(refusal({one}), kNoRefusal) << one.text;
}

TEST(RenderOptions, RefuseWhatHasNoEffect) {
  EXPECT_EQ(refusal({{"--second-opacity", "0.5"}}),
            "--second-opacity: it has no effect without --second; give --second too, or leave it out");
  EXPECT_THAT(refusal({{"--slice-range", "0,1"}}), HasSubstr("no effect without --slice;"));
  EXPECT_EQ(refusal({{"--view", "left"}, {"--from", "0,0"}}), "--from: --view is given too; leave one of them out");
  for (const Given& other : {Given{"--occlusion", "off"}, Given{"--second", "0"}, Given{"--slice", "x=0"}}) {
    EXPECT_EQ(refusal({{"--normals"}, other}),
              std::string("--normals: ") + other.flag + " is given too; leave one of them out");
  }
  EXPECT_THAT(refusal({{"--normals"}, {"--second", "0"}, {"--second-opacity", "1"}}), StartsWith("--normals: "));
}

TEST(RenderOptions, RefuseMorePlanesThanCanBeDrawn) {
  EXPECT_EQ(refusal(std::vector<Given>(6, {"--clip", "x=0"})), kNoRefusal);
  EXPECT_EQ(refusal(std::vector<Given>(7, {"--clip", "x=0"})), "--clip: 7 are given; give at most 6");
  EXPECT_EQ(refusal(std::vector<Given>(4, {"--slice", "x=0"})), "--slice: 4 are given; give at most 3");
}

}  // namespace render_options_test
}  // namespace palpate
