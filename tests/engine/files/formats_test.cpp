// SPDX-License-Identifier: Apache-2.0
#include "engine/files/formats.hpp"

#include <set>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "engine/field/memory_budget.hpp"
#include "engine/files/magic.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/engine/files/files.hpp"
#include "tests/engine/files/samples.hpp"
#include "tests/support/few_descriptors.hpp"

namespace palpate {
namespace formats_test {

TEST(Formats, AreAllNamedOnce) {
  std::set<std::string> names, suffixes;
  std::size_t all_suffixes = 0;
  for (const VolumeFormat& format : volumeFormats()) {
    names.insert(format.name);
    suffixes.insert(format.suffixes.begin(), format.suffixes.end());
    all_suffixes += format.suffixes.size();
    EXPECT_FALSE(format.description.empty());
    EXPECT_NE(format.read, nullptr);
  }
  EXPECT_EQ(names.size(), volumeFormats().size());
  EXPECT_EQ(suffixes.size(), all_suffixes);
}

TEST(LoadVolume, RefusesWhatIsNotThere) {
  expectLoadRefusal("/nowhere/a.nrrd", "no such file", Error::Code::kNotFound);
  expectLoadRefusal("", "no such file", Error::Code::kNotFound);
  expectLoadRefusal("/dev/null", "it is no file; give a volume's file");
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
  refuses("a.dat", "NRRD0004\n", "it holds NRRD data, which its suffix does not say; rename it to .nrrd or .nhdr");
  refuses("a.nrrd", std::string(344, '\0') + std::string("ni1\0", 4), "rename it to .nii or .nii.gz or .hdr or .img");
  refuses("a.nrrd", "NDims = 3\n", "MetaImage data");
  refuses("a.nrrd", std::string(257, 'x') + "ustar",
          "InVesalius data, which its suffix does not say; rename it to .inv3");
  refuses("a.stl", "solid",
          "its suffix names no known format and its content does not either; use one of .nrrd .nhdr .nii ");
  refuses("a.stl", "solid", ".inv3, a DICOM folder or phantom:NAME");
}

// Of every format alike, and of what is none: nothing can be said of the content.
TEST(LoadVolume, SaysThatAFileIsEmpty) {
  const TempFolder folder;
  std::vector<std::string> suffixes = {".dcm", ".stl", ""};
  for (const VolumeFormat& format : volumeFormats()) {
    suffixes.insert(suffixes.end(), format.suffixes.begin(), format.suffixes.end());
  }
  for (const std::string& suffix : suffixes) {
    const std::string file = folder.file("empty" + suffix);
    writeFile(file, "");
    expectRefusal([&] { static_cast<void>(loadVolume(file)); }, file,
                  ": it is empty: a file of 0 bytes; copy or write the file again");
  }
  // The data of a pair are there, and its header is empty.
  writeFile(folder.file("empty.img"), "x");
  expectLoadRefusal(folder.file("empty.img"), "its header empty.hdr is empty: a file of 0 bytes");
}

TEST(LoadVolume, RefusesAPartOfAFileThatHasNone) {
  const TempFolder folder;
  const Volume volume = loadVolume("phantom:sphere?size=8");
  for (const auto& [file, format] : {std::pair("s.nrrd", "NRRD"), std::pair("s.nii", "NIfTI"),
                                     std::pair("s.nii.gz", "NIfTI"), std::pair("s.mha", "MetaImage")}) {
    saveVolume(volume, folder.file(file));
    const std::string reason = fmt::format("it names a part, \"x\", and {} files have none", format);
    expectLoadRefusal(folder.file(file) + "#x", reason);
    expectRefusal([&, name = file] { static_cast<void>(loadVolume(folder.file(name) + "#x?nan=0")); },
                  folder.file(file) + "#x", reason);
  }
  writeFile(folder.file("a#x.nrrd"), readFile(folder.file("s.nrrd")));  // a name of its own
  EXPECT_NO_THROW(static_cast<void>(loadVolume(folder.file("a#x.nrrd"))));
}

// What the system does not open or read is not damaged.
TEST(LoadVolume, SaysThatAFileCannotBeOpened) {
  const TempFolder folder;
  std::vector<std::string> files;
  for (const VolumeFormat& format : volumeFormats()) {
    for (const std::string& suffix : format.suffixes) {
      files.push_back(folder.file("a" + suffix));
      writeFile(files.back(), "x");
    }
  }
  for (const std::string& file : files) {
    std::string words;
    Error::Code code = Error::Code::kBadInput;
    try {
      const FewDescriptors none;
      static_cast<void>(loadVolume(file));
    } catch (const Error& error) {
      words = error.what();
      code = error.code();
    }
    EXPECT_THAT(words, testing::HasSubstr(": it cannot be opened or read: Too many open files; raise the limit"));
    EXPECT_EQ(code, Error::Code::kIo) << file;
  }
}

TEST(LoadVolume, SaysThatItsReaderCanOpenNothing) {
  const TempFolder folder;
  const Volume ball = loadVolume("phantom:sphere?size=16");
  for (const char* name : {"a.nrrd", "a.mha"}) {  // those whose header ITK reads, in a child
    static_cast<void>(saveVolume(ball, folder.file(name)));
    EXPECT_GT(refusalsForDescriptors(folder.file(name)), 1) << name;
  }
  const std::string raw = bytesOf<short>(rampValues());
  writeFile(folder.file("a.raw"), raw);
  writeFile(folder.file("b.mhd"), metaHeader("MET_SHORT", "ElementSpacing = 0.5 0.75 2\n", "a.raw"));
  writeFile(folder.file("b.nhdr"), nrrdHeader("short", "raw") + "data file: a.raw\n");
  for (const char* name : {"b.mhd", "b.nhdr"}) EXPECT_GT(refusalsForDescriptors(folder.file(name)), 1) << name;
}

TEST(HeadOf, SaysThatAFileCannotBeRead) {
  const TempFolder folder;
  expectRefusal([&] { static_cast<void>(headOf(folder.path(), 10, "scan")); }, "scan", "Is a directory",
                Error::Code::kIo);
  expectRefusal([&] { static_cast<void>(headOf(folder.file("none"), 10, "scan")); }, "scan", "No such file",
                Error::Code::kIo);
  writeFile(folder.file("damaged"), "\x1f\x8b and no more");
  EXPECT_EQ(headOf(folder.file("damaged"), 10, "scan"), "");
}

// Of every format, by its length; what a reader remarks stays.
TEST(LoadVolume, RemarksOnWhatNoFingerCouldFeel) {
  const TempFolder folder;
  for (const auto& [spacing_mm, told] :
       {std::pair{0.0666, false}, std::pair{0.0625, false}, std::pair{0.06, true}, std::pair{1e-6, true}}) {
    const std::string name = fmt::format("phantom:sphere?size=16&spacing={}mm", spacing_mm);
    const Volume volume = loadVolume(name);
    const auto remark = fmt::format("it is {:.3g} mm long", 16 * spacing_mm);
    EXPECT_EQ(volume.facts().remark.find(remark) != std::string::npos, told) << volume.facts().remark;
    saveVolume(volume, folder.file("a.nrrd"));
    EXPECT_EQ(loadVolume(folder.file("a.nrrd")).facts().remark, volume.facts().remark);
  }
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
  expectRefusal([] { checkMemory("a", 2, 0, 2, 2, 0); }, "a",
                "its header claims 2 x 0 x 2 voxels; write the file again");
  expectRefusal([] { checkMemory("a", 2, 2, 0, 2, 0); }, "a", "its header claims 2 x 2 x 0 voxels");
  EXPECT_NO_THROW(checkMemory("a", 1, 1, 1, 2, 0));
  EXPECT_NO_THROW(checkMemory("a", 16384, 1, 2, 2, 0));
  const std::string most = " voxels, and an axis may have 16384; crop or resample it";
  expectRefusal([] { checkMemory("a", 16385, 2, 3, 2, 0); }, "a", "it has 16385 x 2 x 3" + most);
  expectRefusal([] { checkMemory("a", 2, 16385, 3, 2, 0); }, "a", "it has 2 x 16385 x 3" + most);
  expectRefusal([] { checkMemory("a", 2, 3, 16385, 2, 0); }, "a", "it has 2 x 3 x 16385" + most);
}

TEST(MemoryBudget, HoldsWhatIsNotMore) {
  EXPECT_NO_THROW(checkMemory("a", 1000.0, 1000));
  EXPECT_THROW(checkMemory("a", 1000.5, 1000), Error);
  constexpr std::size_t kGiB = std::size_t{1} << 30U;
  expectRefusal([] { checkMemory("a", 3.0 * kGiB, kGiB); }, "a",
                "it needs 3 GiB with its copy for the GPU, and 1 GiB are free; "
                "crop or resample it, or use a machine with more memory",
                Error::Code::kOutOfMemory);
  // 256^3 bricks are 2^24, the most.
  EXPECT_NO_THROW(checkBricks("a", 2048, 2048, 2048));
  expectRefusal([] { checkBricks("a", 2048, 2049, 2047); }, "a",
                "its box of 2048 x 2049 x 2047 voxels has more than 16777216 bricks of 8 x 8 x 8; crop or resample it",
                Error::Code::kOutOfMemory);
}

TEST(MemoryBudget, KnowsWhatTheMachineHas) {
  EXPECT_GT(availableMemoryBytes(), std::size_t{1} << 20U);
}

}  // namespace formats_test
}  // namespace palpate
