// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/formats.hpp"

#include "engine/volume/memory_budget.hpp"
#include "tests/engine/volume/files.hpp"

namespace palpate {
namespace {

TEST(Formats, AreAllNamedOnce) {
  std::vector<std::string> names;
  for (const VolumeFormat& format : volumeFormats()) {
    names.push_back(format.name);
    EXPECT_FALSE(format.description.empty());
    EXPECT_NE(format.read, nullptr);
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("NRRD", "NIfTI", "MetaImage", "OpenVDB", "InVesalius",
                                                   "DICOM series", "phantom"));
}

TEST(LoadVolume, RefusesWhatIsNotThere) {
  expectLoadRefusal("/nowhere/a.nrrd", "no such file", Error::Code::kNotFound);
  expectLoadRefusal("", "no such file", Error::Code::kNotFound);
}

TEST(LoadVolume, SaysWhatAFileIsWhoseSuffixLies) {
  const TempFolder folder;
  const auto refuses = [&](const std::string& name, const std::string& bytes, const std::string& reason) {
    writeFile(folder.file(name), bytes);
    expectLoadRefusal(folder.file(name), reason);
  };
  refuses("a.nii", "NRRD0004\ntype: float\n", "NRRD data");
  refuses("a.nrrd", std::string(" BDV\0\0\0\0", 8) + std::string(100, 'x'), "OpenVDB data");
  refuses("a.mha", std::string(344, '\0') + std::string("n+1\0", 4), "NIfTI data");
  refuses("a.vdb", "ObjectType = Image\n", "MetaImage data");
  refuses("a.nrrd", std::string(128, '\0') + "DICM", "give the folder");
  refuses("a.inv3", "NRRD0004\n", "rename it to .nrrd");
  refuses("a.dat", "NRRD0004\n", "NRRD data");
  refuses("a.stl", "solid", "use one of .nrrd");
  refuses("a.nrrd", "", "");
}

TEST(LoadVolume, RefusesGarbageUnderEverySuffix) {
  const TempFolder folder;
  for (const VolumeFormat& format : volumeFormats()) {
    for (const std::string& suffix : format.suffixes) {
      for (const std::string& bytes : {std::string(), std::string("x"), std::string(5000, '\377')}) {
        writeFile(folder.file("a" + suffix), bytes);
        EXPECT_THROW(static_cast<void>(loadVolume(folder.file("a" + suffix))), Error) << suffix;
      }
    }
  }
}

TEST(MemoryBudget, CountsEveryCopyOfAVoxel) {
  const double per_voxel = 2 + kDenseBytesPerVoxel + kGridBytesPerVoxel + kGpuBytesPerVoxel;
  const auto need = static_cast<std::size_t>(per_voxel * 1000);
  EXPECT_NO_THROW(checkMemory("a", 10, 10, 10, 2, need + 1));
  expectRefusal([&] { checkMemory("a", 10, 10, 10, 2, need - 1); }, "a", "GiB", Error::Code::kOutOfMemory);
}

TEST(MemoryBudget, RefusesAbsurdDimensions) {
  expectRefusal([] { checkMemory("a", 100000, 100000, 100000, 2, 0); }, "a", "GiB", Error::Code::kOutOfMemory);
  expectRefusal([] { checkMemory("a", 20000, 2, 2, 2, 0); }, "a", "16384");
  expectRefusal([] { checkMemory("a", 0, 2, 2, 2, 0); }, "a", "0 x 2 x 2");
  expectRefusal([] { checkMemory("a", -1, 2, 2, 2, 0); }, "a", "-1 x 2 x 2");
}

TEST(MemoryBudget, KnowsWhatTheMachineHas) {
  EXPECT_GT(availableMemoryBytes(), std::size_t{1} << 20U);
}

}  // namespace
}  // namespace palpate
