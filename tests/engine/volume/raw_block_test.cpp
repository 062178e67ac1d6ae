// SPDX-License-Identifier: Apache-2.0
// Values read without ITK: that they are the same, and that this is done only where a header says all of it plainly.
#include "engine/volume/raw_block.hpp"

#include <random>
#include <system_error>

#include "engine/volume/grid.hpp"
#include "engine/volume/text_raw_block.hpp"
#include "tests/engine/volume/samples.hpp"

namespace palpate {
namespace {

std::vector<float> randomFloats(const Vec3i& size) {
  std::mt19937 random(3);
  std::vector<float> values(static_cast<std::size_t>(size.prod()));
  for (float& value : values) value = static_cast<float>(random());
  return values;
}

std::string bytesOfFloats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

// Sizes below, at and beyond multiples of a brick; the file goes on after the values.
TEST(RawBlock, GivesWhatFromDenseGivesOfTheSameValues) {
  const TempFolder folder;
  for (const Vec3i& size : {Vec3i(2, 3, 5), Vec3i(16, 8, 24), Vec3i(19, 17, 41), Vec3i(7, 33, 9)}) {
    const std::vector<float> values = randomFloats(size);
    writeFile(folder.file("raw"), "head" + bytesOfFloats(values) + "tail");
    const LayerSource layers = layersOf({folder.file("raw"), 4}, ValueType::kFloat32, size, 1, 0);
    const Volume volume(buildGridByLayers(size, Lattice{}, {}, layers));
    const Volume dense = Volume::fromDense(size, Lattice{}, values, {});
    EXPECT_EQ(volume.toDense(), values);
    EXPECT_EQ(volume.minimum(), dense.minimum());
    EXPECT_EQ(volume.maximum(), dense.maximum());
    EXPECT_EQ(volume.storedBytes(), dense.storedBytes());
    std::vector<float> brick(kBrickVoxels), dense_brick(kBrickVoxels);
    const Vec3i last = volume.brickCount() - Vec3i::Ones();  // reaches beyond the domain
    volume.readBrick(last, brick.data());
    dense.readBrick(last, dense_brick.data());
    EXPECT_EQ(brick, dense_brick);
  }
}

TEST(RawBlock, AppliesSlopeAndIntercept) {
  const TempFolder folder;
  writeFile(folder.file("raw"), bytesOf<std::int16_t>(rampValues(-30)));
  const LayerSource layers = layersOf({folder.file("raw"), 0}, ValueType::kInt16, kSize, 0.5, 100);
  std::vector<double> values = rampValues(-30);
  for (double& value : values) value = 0.5 * value + 100;
  EXPECT_EQ(Volume(buildGridByLayers(kSize, Lattice{}, {}, layers)).toDense(), asFloats(values));
}

TEST(RawBlock, ThrowsWhereTheFileEndsOrIsNotThere) {
  const TempFolder folder;
  const std::string path = folder.file("raw");
  EXPECT_THROW(static_cast<void>(layersOf({path, 0}, ValueType::kInt16, kSize, 1, 0)), std::system_error);
  writeFile(path, bytesOf<std::int16_t>(rampValues()).substr(1));
  const LayerSource layers = layersOf({path, 0}, ValueType::kInt16, kSize, 1, 0);
  EXPECT_THROW(static_cast<void>(buildGridByLayers(kSize, Lattice{}, {}, layers)), std::system_error);
}

class TextRawBlock : public testing::Test {
 protected:
  [[nodiscard]] std::optional<RawBlock> nrrd(const std::string& bytes) const {
    writeFile(path_, bytes);
    return nrrdRawBlock(readTextHeader(path_, path_, ':', ""), path_);
  }
  [[nodiscard]] std::optional<RawBlock> meta(const std::string& bytes) const {
    writeFile(path_, bytes);
    return metaRawBlock(readTextHeader(path_, path_, '=', "elementdatafile"), path_);
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a");
  std::string data_ = bytesOf<std::int16_t>(rampValues(-30));
};

TEST_F(TextRawBlock, IsFoundInAPlainNrrd) {
  const std::string header = nrrdHeader("int16", "raw", "# a comment\nkey:=value\n");
  const auto attached = nrrd(header + "\n" + data_);
  ASSERT_TRUE(attached);
  EXPECT_EQ(attached->path, path_);
  EXPECT_EQ(attached->offset, header.size() + 1);
  const auto detached = nrrd(header + "data file: a.raw\n\n");
  ASSERT_TRUE(detached);
  EXPECT_EQ(detached->path, folder_.file("a.raw"));
  EXPECT_EQ(detached->offset, 0U);
}

TEST_F(TextRawBlock, IsNotTakenFromANrrdThatSaysMore) {
  for (const std::string more :
       {"byte skip: 4\n", "line skip: 1\n", "lineskip: 1\n", "byteskip: -1\n", "data file: a%03d.raw 1 3 1\n",
        "data file: LIST\n", "kinds: domain domain list\n", "encoding: raw\n", "what is this\n"}) {
    EXPECT_FALSE(nrrd(nrrdHeader("int16", "raw", more) + "\n" + data_)) << more;
  }
  EXPECT_FALSE(nrrd(nrrdHeader("int16", "gzip") + "\n" + data_));
  EXPECT_FALSE(nrrd(nrrdHeader("int16", "raw")));  // the header does not end
  std::string header = nrrdHeader("int16", "raw");
  header.replace(header.find("little"), 6, "big");
  EXPECT_FALSE(nrrd(header + "\n" + data_));
  header = nrrdHeader("int16", "raw");
  header.replace(header.find("dimension: 3\nsizes: 5 4 3"), 25, "dimension: 4\nsizes: 5 4 3 1");
  EXPECT_FALSE(nrrd(header + "\n" + data_));
}

TEST_F(TextRawBlock, IsFoundInAPlainMetaImage) {
  const std::string header = metaHeader("MET_SHORT");
  const auto local = meta(header + data_);
  ASSERT_TRUE(local);
  EXPECT_EQ(local->path, path_);
  EXPECT_EQ(local->offset, header.size());
  const auto detached = meta(metaHeader("MET_SHORT", "", "a.raw"));
  ASSERT_TRUE(detached);
  EXPECT_EQ(detached->path, folder_.file("a.raw"));
  EXPECT_EQ(detached->offset, 0U);
}

TEST_F(TextRawBlock, IsNotTakenFromAMetaImageThatSaysMore) {
  for (const std::string more : {"HeaderSize = 7\n", "HeaderSize : 7\n", "ElementByteOrderMSB = True\n",
                                 "CompressedData = True\n", "DimSize = 5 4 3\n"}) {
    EXPECT_FALSE(meta(metaHeader("MET_SHORT", more) + data_)) << more;
  }
  for (const std::string said :
       {"BinaryDataByteOrderMSB = False\n", "CompressedData = False\n", "BinaryData = True\n"}) {
    std::string header = metaHeader("MET_SHORT");
    header.erase(header.find(said), said.size());
    EXPECT_FALSE(meta(header + data_)) << said;
  }
  for (const std::string data : {"LIST", "a%d.raw 1 3 1", "a.raw 2D"}) {
    EXPECT_FALSE(meta(metaHeader("MET_SHORT", "", data))) << data;
  }
}

// What the raw way refuses, ITK sees: its NIfTI reader puts 0 for what is no number, the others leave it to be refused.
TEST_F(TextRawBlock, ValuesThatAreNoNumbersAreTreatedAsByItk) {
  std::vector<double> values = rampValues();
  values[7] = std::nan("");
  NiftiFields fields;
  fields.datatype = 16;
  fields.bits = 32;
  writeFile(folder_.file("a.nii"), niftiHeader(fields) + bytesOf<float>(values));
  EXPECT_EQ(loadVolume(folder_.file("a.nii")).toDense()[7], 0);
  writeFile(folder_.file("a.nrrd"), nrrdHeader("float", "raw") + "\n" + bytesOf<float>(values));
  expectLoadRefusal(folder_.file("a.nrrd"), "1 of its 60 voxels are NaN or infinite, the first at index (2, 1, 0)");
}

}  // namespace
}  // namespace palpate
