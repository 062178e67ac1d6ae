// SPDX-License-Identifier: Apache-2.0
#include "apps/render/picture_files.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace picture_files_test {

using testing::HasSubstr;

RenderRequest asked(const std::string& out, const std::string& depth = "", int frames = 1) {
  RenderRequest request;
  request.in = "phantom:sphere";
  request.out = out;
  request.depth = depth;
  request.frames = frames;
  return request;
}

TEST(PictureFiles, OnePictureHasTheNameThatWasGiven) {
  const auto files = pictureFiles(asked("a.b/out.png", "d.pfm"));
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].picture, "a.b/out.png");
  EXPECT_EQ(files[0].depth, "d.pfm");
}

TEST(PictureFiles, FramesHaveNumbersOfAsManyDigitsAsTheLastOneNeeds) {
  const auto files = pictureFiles(asked("a.b/out.x.png", "d.pfm", 60));
  ASSERT_EQ(files.size(), 60U);
  EXPECT_EQ(files[0].picture, "a.b/out.x_000.png");
  EXPECT_EQ(files[59].picture, "a.b/out.x_059.png");
  EXPECT_EQ(files[7].depth, "d_007.pfm");
  EXPECT_EQ(pictureFiles(asked("o.png", "", 1000))[999].picture, "o_999.png");
  EXPECT_EQ(pictureFiles(asked("o.png", "", 1001))[7].picture, "o_0007.png");
  EXPECT_EQ(pictureFiles(asked("o.png", "", 2))[1].depth, "");
}

TEST(PictureFiles, RefusesWhatCannotBeWritten) {
  const auto words = [](const RenderRequest& request) { return refusalOf([&] { checkPictureFiles(request); }); };
  EXPECT_EQ(words(asked("out.png", "out.pfm", 3)), kNoRefusal);
  EXPECT_EQ(words(asked("out.jpg")), "out.jpg: a picture is written as .png only; give a name like picture.png");
  EXPECT_THAT(words(asked("")), HasSubstr("'': a picture is written as .png only"));
  EXPECT_THAT(words(asked("a/.png")), HasSubstr("a/.png: a picture is"));
  EXPECT_EQ(words(asked("out.png", "out.exr")),
            "out.exr: a depth image is written as .pfm only; give a name like depth.pfm");
  RenderRequest request = asked("out.png");
  request.json = "./out.png";
  EXPECT_THAT(words(request), HasSubstr("two of the outputs"));
  request = asked("out.png", "", 3);
  request.json = "out_002.png";
  EXPECT_THAT(words(request), HasSubstr("two of the outputs"));
}

// A folder in the place of a later frame, a link to nowhere, a file of a folder that is not there.
TEST(PictureFiles, EveryNameMustBeWritable) {
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder.path() / name).string(); };
  const auto words = [](const RenderRequest& request) {
    return refusalOf([&] { checkPicturesWritable(request); }, Error::Code::kIo);
  };
  std::ofstream(file("o_001.png")) << "an older frame";
  EXPECT_EQ(words(asked(file("o.png"), file("d.pfm"), 9)), kNoRefusal);
  EXPECT_EQ(contentsOf(file("o_001.png")), "an older frame");
  EXPECT_EQ(folder.files(), 1);
  EXPECT_THAT(words(asked(file("none/o.png"))), HasSubstr("none/o.png: cannot be created"));
  EXPECT_THAT(words(asked(file("o.png"), file("none/d.pfm"), 2)), HasSubstr("none/d_000.pfm: cannot be created"));
  RenderRequest request = asked(file("o.png"));
  request.json = file("none/o.json");
  EXPECT_THAT(words(request), HasSubstr("none/o.json: cannot be created"));
  std::filesystem::create_directory(file("o_007.png"));
  EXPECT_THAT(words(asked(file("o.png"), "", 8)), HasSubstr("o_007.png: it is not a plain file"));
  EXPECT_EQ(words(asked(file("o.png"), "", 7)), kNoRefusal);
  std::filesystem::create_symlink(file("none/x"), file("d_003.pfm"));
  EXPECT_THAT(words(asked(file("p.png"), file("d.pfm"), 4)), HasSubstr("d_003.pfm: cannot be created"));
}

// A volume may have any name, and a link to it any other.
TEST(PictureFiles, RefusesTheInput) {
  const TemporaryFolder folder;
  const std::string volume = (folder.path() / "v.nrrd").string();
  std::ofstream(volume) << "NRRD0004";
  const std::string link = (folder.path() / "o_001.png").string(), depth_link = (folder.path() / "d_001.pfm").string();
  std::filesystem::create_symlink(volume, link);
  std::filesystem::create_symlink(volume, depth_link);
  RenderRequest request = asked((folder.path() / "o.png").string(), "", 2);
  request.in = volume;
  EXPECT_THAT(refusalOf([&] { checkPictureFiles(request); }), HasSubstr("it is the input"));
  request.out = "p.png";
  EXPECT_EQ(refusalOf([&] { checkPictureFiles(request); }), kNoRefusal);
  request.depth = (folder.path() / "d.pfm").string();
  EXPECT_THAT(refusalOf([&] { checkPictureFiles(request); }), HasSubstr("it is the input"));
  request.depth = "";
  request.json = volume;
  EXPECT_THAT(refusalOf([&] { checkPictureFiles(request); }), HasSubstr("it is the input"));
}

}  // namespace picture_files_test
}  // namespace palpate
