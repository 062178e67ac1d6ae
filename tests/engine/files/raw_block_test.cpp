// SPDX-License-Identifier: Apache-2.0
// Values read from where they lie, a row of bricks at a time.
#include "engine/files/raw_block.hpp"

#include <random>
#include <system_error>

#include "engine/vdb/vdb_grid.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace raw_block_test {

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

TEST(RawBlock, TurnsTheOtherByteOrder) {
  const TempFolder folder;
  for (const bool swapped : {false, true}) {
    writeFile(folder.file("raw"), bytesOf<std::int16_t>(rampValues(-30), swapped));
    const LayerSource layers = layersOf({folder.file("raw"), 0, swapped}, ValueType::kInt16, kSize, 1, 0);
    EXPECT_EQ(Volume(buildGridByLayers(kSize, Lattice{}, {}, layers)).toDense(), asFloats(rampValues(-30)));
  }
}

}  // namespace raw_block_test
}  // namespace palpate
