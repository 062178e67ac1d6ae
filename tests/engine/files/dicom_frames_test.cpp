// SPDX-License-Identifier: Apache-2.0
// DICOM files of many frames (PS3.3, C.7.6.16): what the frames share, and what each has for itself.
#include <fmt/format.h>

#include "engine/files/dicom_values.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/engine/files/dicom_writer.hpp"
#include "tests/engine/files/packed_dicom.hpp"

namespace palpate {
namespace dicom_frames_test {

// Frames of 2 x 3 pixels. Frame n has the stored values 10 n to 10 n + 5.
class DicomFrames : public testing::Test {
 protected:
  static std::vector<std::int64_t> words(int frames) {
    std::vector<std::int64_t> all;
    for (int n = 0; n < frames; ++n)
      for (int p = 0; p < 6; ++p) all.push_back(10 * n + p);
    return all;
  }
  static WrittenItem scan(const WrittenItem& shared, const std::vector<WrittenItem>& frames, bool open = false) {
    WrittenImage image;
    image.words = words(static_cast<int>(frames.size()));
    WrittenItem set = imageSet(image);
    set[0x00280008] = textOf("IS", std::to_string(frames.size()));
    set[0x52009229] = itemsOf({shared}, open);
    set[0x52009230] = itemsOf(frames, open);
    return set;
  }
  // Frames at these heights, in this order, with all else shared.
  static WrittenItem scanAt(const std::vector<double>& z_mm, bool open = false) {
    WrittenItem shared;
    addOrientation(shared);
    addMeasures(shared);
    std::vector<WrittenItem> frames(z_mm.size());
    for (std::size_t n = 0; n < z_mm.size(); ++n) addPosition(frames[n], fmt::format("10\\-20\\{}", z_mm[n]));
    return scan(shared, frames, open);
  }
  void write(const WrittenItem& set, const std::string& syntax = kLittleEndianDicom) const {
    writeFile(folder_.file("scan.dcm"), DicomWriter(syntax).file(set));
  }
  void refuses(const std::string& reason) const { expectLoadRefusal(folder_.path(), reason); }
  // The first value of each slice.
  static std::vector<float> firsts(const Volume& volume) {
    std::vector<float> values;
    for (int k = 0; k < volume.size().z(); ++k) values.push_back(volume.value({0, 0, k}));
    return values;
  }
  using Floats = std::vector<float>;

  TempFolder folder_;
};

TEST_F(DicomFrames, AreSlicesInTheOrderOfTheirPlaces) {
  for (const char* syntax : {kLittleEndianDicom, kBigEndianDicom, kImplicitDicom, kDeflatedDicom}) {
    for (const bool open : {false, true}) {
      SCOPED_TRACE(fmt::format("{} {}", syntax, open));
      write(scanAt({34, 30, 36, 32}, open), syntax);
      const Volume volume = loadVolume(folder_.path());
      EXPECT_EQ(volume.size(), Vec3i(3, 2, 4));
      EXPECT_EQ(firsts(volume), (Floats{10, 30, 0, 20}));
      EXPECT_EQ(volume.value({2, 1, 3}), 25);
      Lattice lattice = plainLattice();
      lattice.origin_W = Vec3(0.010, -0.020, 0.030);
      expectLattice(volume.lattice(), lattice, 1e-12);
    }
  }
}

TEST_F(DicomFrames, MayHaveEverythingForThemselves) {
  std::vector<WrittenItem> frames(3);
  for (int n = 0; n < 3; ++n) {
    WrittenItem& frame = frames[static_cast<std::size_t>(n)];
    addOrientation(frame);
    addMeasures(frame);
    addPosition(frame, fmt::format("0\\0\\{}", 2 * n));
    addTransformation(frame, std::to_string(n + 1), std::to_string(100 * n));
  }
  write(scan({}, frames));
  const Volume volume = loadVolume(folder_.path());
  EXPECT_EQ(firsts(volume), (Floats{0, 2 * 10 + 100, 3 * 20 + 200}));
  EXPECT_EQ(volume.facts().rescale_in_words, "slope * stored + intercept, by slice: slope 1 to 3, intercept 0 to 200");
}

TEST_F(DicomFrames, ShareATransformation) {
  WrittenItem set = scanAt({0, 2, 4});
  addTransformation(set[0x52009229].items[0], "0.5", "-3");
  write(set);
  EXPECT_EQ(firsts(loadVolume(folder_.path())), (Floats{-3, 2, 7}));
  // What a frame has for itself counts more.
  addTransformation(set[0x52009230].items[1], "2", "1");
  write(set);
  EXPECT_EQ(firsts(loadVolume(folder_.path())), (Floats{-3, 21, 7}));
}

TEST_F(DicomFrames, AreRefusedWhereOnlySomeAreScaled) {
  WrittenItem set = scanAt({0, 2, 4});
  addTransformation(set[0x52009230].items[1], "2", "1");
  write(set);
  refuses("frame 2 of scan.dcm has a RescaleSlope, and frame 1 of scan.dcm has none");
}

// Each is a volume of its own, and the list says which it is.
TEST_F(DicomFrames, OfSeveralStacksAndPhasesMustBeChosen) {
  WrittenItem set = scanAt({0, 2, 0, 2, 10, 12});
  auto& frames = set[0x52009230].items;
  for (std::size_t n = 0; n < frames.size(); ++n)
    addFrameContent(frames[n], n < 4 ? "A" : "B", n < 2 || n >= 4 ? 1 : 2);
  write(set);
  refuses(
      "the folder holds 3 series: 1: 1.2.3.4.5/0001 stack A phase 1 (2 slices), 2: 1.2.3.4.5/0002 stack A phase 2 (2 "
      "slices), 3: 1.2.3.4.5/0003 stack B phase 1 (2 slices); choose one: --series 1, or");
  EXPECT_EQ(firsts(loadVolume(folder_.path() + "#1")), (Floats{0, 10}));
  EXPECT_EQ(firsts(loadVolume(folder_.path() + "#2")), (Floats{20, 30}));
  EXPECT_EQ(firsts(loadVolume(folder_.path() + "#1.2.3.4.5/0003")), (Floats{40, 50}));
  EXPECT_EQ(loadVolume(folder_.path() + "#2").facts().part, "series 2 of 3: 1.2.3.4.5/0002 stack A phase 2");
  // One stack and one phase need no choice.
  set = scanAt({0, 2, 4});
  for (WrittenItem& frame : set[0x52009230].items) addFrameContent(frame, "A", 1);
  write(set);
  EXPECT_EQ(loadVolume(folder_.path()).facts().part, "series 1.2.3.4.5");
}

TEST_F(DicomFrames, OfSeveralVolumesAreListedByTheUidOfTheirSeries) {
  WrittenItem set = scanAt({0, 2, 0, 2});
  auto& frames = set[0x52009230].items;
  for (std::size_t n = 0; n < frames.size(); ++n) addFrameContent(frames[n], "A", n < 2 ? 1 : 2);
  write(set);
  WrittenItem other = scanAt({0, 2});
  other[0x0020000e] = textOf("UI", "1.2.3.4");  // its UID begins as that of the other, and is another
  writeFile(folder_.file("other.dcm"), DicomWriter(kLittleEndianDicom).file(other));
  expectLoadRefusal(folder_.path() + "#1.2.3.4.5",
                    "the series 1.2.3.4.5 holds several volumes; choose one of 2: 1.2.3.4.5/0001 stack A phase 1 (2 "
                    "slices), 3: 1.2.3.4.5/0002 stack A phase 2 (2 slices)");
  EXPECT_EQ(firsts(loadVolume(folder_.path() + "#1.2.3.4")), (Floats{0, 10}));
}

// Dimensions of a scan (PS3.3, C.7.6.17): what each counts, and how the file calls it.
void addDimensions(WrittenItem& set, const std::vector<std::pair<std::uint32_t, std::string>>& dimensions) {
  std::vector<WrittenItem> items;
  for (const auto& [pointer, label] : dimensions) {
    WrittenItem item;
    item[0x00209165] = numbersOf("AT", {pointer >> 16U, pointer & 0xffffU});
    if (!label.empty()) item[0x00209421] = textOf("LO", label);
    items.push_back(item);
  }
  set[0x00209222] = itemsOf(items);
}
void addIndices(WrittenItem& groups, const std::vector<std::int64_t>& indices) {
  groups[0x00209111] = itemsOf({{{0x00209157, numbersOf("UL", indices, 4)}}});
}

// Two echoes of two directions at two places. A dimension that counts places divides nothing, even if it counts on from
// echo to echo, nor does one that goes with the places, nor one that counts all frames where others tell them apart.
TEST_F(DicomFrames, ThatLieAtOnePlaceAreDividedByTheirDimensions) {
  for (const char* syntax : {kLittleEndianDicom, kBigEndianDicom, kImplicitDicom}) {
    SCOPED_TRACE(syntax);
    WrittenItem set = scanAt({0, 2, 0, 2, 0, 2, 0, 2});
    addDimensions(set, {{0x00200032, "place"},
                        {0x00209156, "frame"},
                        {0x00189082, "echo"},
                        {0x00189076, ""},
                        {0x00181060, "trigger time"}});
    auto& frames = set[0x52009230].items;
    for (std::int64_t n = 0; n < 8; ++n)
      addIndices(frames[static_cast<std::size_t>(n)], {n + 1, n + 1, n / 2 % 2 + 1, n / 4 + 1, n % 2 + 1});
    write(set, syntax);
    refuses(
        "the folder holds 4 series: 1: 1.2.3.4.5/0001 echo 1 (0018,9076) 1 (2 slices), 2: 1.2.3.4.5/0002 echo 1 "
        "(0018,9076) 2 (2 slices), 3: 1.2.3.4.5/0003 echo 2 (0018,9076) 1 (2 slices), 4: 1.2.3.4.5/0004 echo 2 "
        "(0018,9076) 2 (2 slices); choose one");
    EXPECT_EQ(firsts(loadVolume(folder_.path() + "#1")), (Floats{0, 10}));
    EXPECT_EQ(firsts(loadVolume(folder_.path() + "#2")), (Floats{40, 50}));
    EXPECT_EQ(firsts(loadVolume(folder_.path() + "#3")), (Floats{20, 30}));
    EXPECT_EQ(firsts(loadVolume(folder_.path() + "#1.2.3.4.5/0004")), (Floats{60, 70}));
    EXPECT_EQ(loadVolume(folder_.path() + "#3").facts().part, "series 3 of 4: 1.2.3.4.5/0003 echo 2 (0018,9076) 1");
  }
}

// Dimensions that differ from place to place are no reason: the frames are one volume, as they lie.
TEST_F(DicomFrames, ThatLieApartAreNotDividedByDimensions) {
  WrittenItem set = scanAt({0, 2, 4, 6});
  addDimensions(set, {{0x00189082, "echo"}, {0x00181060, "trigger time"}});
  auto& frames = set[0x52009230].items;
  for (std::int64_t n = 0; n < 4; ++n) addIndices(frames[static_cast<std::size_t>(n)], {n / 2 + 1, n + 1});
  write(set);
  EXPECT_EQ(firsts(loadVolume(folder_.path())), (Floats{0, 10, 20, 30}));
  EXPECT_EQ(loadVolume(folder_.path()).facts().part, "series 1.2.3.4.5");
}

// Indices of another number than there are dimensions say nothing.
TEST_F(DicomFrames, WithIndicesThatFitNoDimensionsAreRefusedAsTheyLie) {
  for (const std::vector<std::int64_t>& indices : {std::vector<std::int64_t>{}, {1}, {1, 2, 3}}) {
    WrittenItem set = scanAt({0, 0, 2, 2});
    addDimensions(set, {{0x00200032, "place"}, {0x00189082, "echo"}});
    auto& frames = set[0x52009230].items;
    for (std::int64_t n = 0; n < 4; ++n) addIndices(frames[static_cast<std::size_t>(n)], {n / 2 + 1, n % 2 + 1});
    addIndices(frames[1], indices);
    write(set);
    refuses("frame 1 of scan.dcm and frame 2 of scan.dcm lie at one place");
  }
}

TEST_F(DicomFrames, OfOneFileShareItsTable) {
  WrittenItem set = scanAt({0, 2, 4});
  const auto with = [&](std::int64_t entry) {
    set[0x00283000] = itemsOf({{{0x00283002, numbersOf("SS", {2, 0, 16})}, {0x00283006, numbersOf("OW", {7, entry})}}});
    return DicomWriter(kLittleEndianDicom).file(set);
  };
  const std::string path = folder_.file("scan.dcm");
  writeFile(path, with(9));
  DicomSeries series = slicesOfFile(path, "source");
  writeFile(path, with(11));
  for (DicomSlice& slice : slicesOfFile(path, "source")) series.push_back(slice);
  const std::vector<DicomValueRule> rules = valueRulesOf(series, "source");
  ASSERT_EQ(rules.size(), 6U);
  for (std::size_t n = 0; n < 6; ++n) {
    EXPECT_EQ(rules[n].table, rules[n / 3 * 3].table);  // the same object
    EXPECT_EQ(rules[n].table->at(1), n < 3 ? 9 : 11);
  }
}

// Words of packed files are held while they are read: each file's once, however its slices lie among those of others.
TEST_F(DicomFrames, OfPackedFilesCountOnceForMemory) {
  WrittenElement pixels = textOf("OB", "");
  WrittenImage image;
  image.rows = image.columns = 16;
  image.words = std::vector<std::int64_t>(256, 5);
  WrittenItem slice = imageSet(image);
  placeAt(slice, "0\\0\\0");
  const std::string packed = packedDicom(DicomWriter(kLittleEndianDicom).file(slice), DicomPacking::kJpegLs);
  const Fragment at = fragmentOf(packed);
  for (int n = 0; n < 8; ++n) pixels.fragments.push_back(packed.substr(at.first, at.end - at.first));
  for (int file = 0; file < 2; ++file) {
    std::vector<double> z_mm;
    for (int n = 0; n < 8; ++n) z_mm.push_back(2 * n + file);
    WrittenItem set = scanAt(z_mm);
    set[0x00280010] = set[0x00280011] = numbersOf("US", {16});
    set[0x7fe00010] = pixels;
    writeFile(folder_.file(fmt::format("f{}.dcm", file)), DicomWriter("1.2.840.10008.1.2.4.80").file(set));
  }
  // 4096 voxels of 2 bytes of words, 4 of floats, 4.2 of the grid and 8 on the GPU. Counted with every change from one
  // file to the other, words would take 2 x 8 bytes a voxel.
  EXPECT_EQ(loadVolume(folder_.path(), 4096 * 19).size(), Vec3i(16, 16, 16));
  expectRefusal([&] { static_cast<void>(loadVolume(folder_.path(), 4096 * 18)); }, folder_.path(), "GiB",
                Error::Code::kOutOfMemory);
}

TEST_F(DicomFrames, AreRefusedAsSlicesAre) {
  write(scanAt({0, 2, 2, 4}));  // two echoes, say, that the file does not tell apart
  refuses(
      "slices frame 2 of scan.dcm and frame 3 of scan.dcm lie at one place; write each time point or echo into files "
      "of its own, in another program");
  write(scanAt({0, 2, 6, 8}));
  refuses("1 slice is missing between frame 2 of scan.dcm and frame 3 of scan.dcm");
  write(scanAt({0, 2, 4.5, 6.5}));
  refuses("2.5 mm apart, others 2 mm");
  write(scanAt({0}));
  refuses("the series has one slice");
  for (const char* gone : {"position", "orientation", "spacing"}) {
    WrittenItem set = scanAt({0, 2, 4});
    if (gone == std::string("position")) set[0x52009230].items[1].erase(0x00209113);
    if (gone == std::string("orientation")) set[0x52009229].items[0].erase(0x00209116);
    if (gone == std::string("spacing")) set[0x52009229].items[0].erase(0x00289110);
    write(set);
    refuses(gone == std::string("spacing")    ? "the PixelSpacing \"\" of frame 1 of scan.dcm is not positive"
            : gone == std::string("position") ? "frame 2 of scan.dcm has no position or orientation"
                                              : "frame 1 of scan.dcm has no position or orientation");
  }
}

TEST_F(DicomFrames, MustBeDescribed) {
  WrittenItem set = scanAt({0, 2, 4});
  set[0x52009230].items.pop_back();
  write(set);
  refuses("scan.dcm holds 3 frames and describes 2; convert it to NIfTI or NRRD");
  set.erase(0x52009229);
  set.erase(0x52009230);
  placeAt(set, "0\\0\\0");
  write(set);
  refuses("scan.dcm holds 3 frames and does not say where each lies");
  // Beside a series that is chosen it does no harm.
  for (int n = 0; n < 2; ++n) {
    WrittenImage image;
    image.words = words(1);
    WrittenItem slice = imageSet(image, "1.1");
    placeAt(slice, fmt::format("0\\0\\{}", n));
    writeFile(folder_.file(fmt::format("s{}.dcm", n)), DicomWriter(kLittleEndianDicom).file(slice));
  }
  EXPECT_EQ(loadVolume(folder_.path() + "#1").size(), Vec3i(3, 2, 2));
}

// Parts of a scan in several files, and slices of one frame each, make one series.
TEST_F(DicomFrames, OfSeveralFilesAreOneSeries) {
  write(scanAt({0, 4}));
  writeFile(folder_.file("more.dcm"), DicomWriter(kLittleEndianDicom).file(scanAt({2, 6})));
  EXPECT_EQ(firsts(loadVolume(folder_.path())), (Floats{0, 0, 10, 10}));
}

// Frames that GDCM packed one by one, put together by us: 16 x 16 pixels of 10 n and more.
TEST_F(DicomFrames, MayBePacked) {
  for (const auto& [packing, syntax] : {std::pair{DicomPacking::kRle, "1.2.840.10008.1.2.5"},
                                        {DicomPacking::kJpegLossless, "1.2.840.10008.1.2.4.70"},
                                        {DicomPacking::kJpegLs, "1.2.840.10008.1.2.4.80"},
                                        {DicomPacking::kJpeg2000, "1.2.840.10008.1.2.4.90"}}) {
    SCOPED_TRACE(syntax);
    WrittenElement pixels = textOf("OB", "");
    for (int n = 0; n < 4; ++n) {
      WrittenImage image;
      image.rows = image.columns = 16;
      for (int p = 0; p < 256; ++p) image.words.push_back(10 * n + p - 40);
      WrittenItem slice = imageSet(image);
      placeAt(slice, "0\\0\\0");
      const std::string packed = packedDicom(DicomWriter(kLittleEndianDicom).file(slice), packing);
      const Fragment at = fragmentOf(packed);
      pixels.fragments.push_back(packed.substr(at.first, at.end - at.first));
    }
    WrittenItem set = scanAt({34, 30, 36, 32});
    set[0x00080016] = textOf("UI", "1.2.840.10008.5.1.4.1.1.2.1");  // enhanced CT
    set[0x00280010] = set[0x00280011] = numbersOf("US", {16});
    set[0x7fe00010] = pixels;
    write(set, syntax);
    const Volume volume = loadVolume(folder_.path());
    EXPECT_EQ(firsts(volume), (Floats{-30, -10, -40, -20}));
    EXPECT_EQ(volume.value({15, 15, 3}), 20 + 255 - 40);
  }
}

// Software that does not know the groups writes them on as bytes of unknown type, in implicit form (PS3.5, 6.2.2).
TEST_F(DicomFrames, AreReadFromGroupsOfUnknownType) {
  const std::string known = DicomWriter(kLittleEndianDicom).file(scanAt({34, 30, 36, 32}));
  const WrittenItem set = scanAt({34, 30, 36, 32});
  WrittenItem groups;
  for (const std::uint32_t tag : {0x52009229U, 0x52009230U}) groups[tag] = set.at(tag);
  const std::string implicit = DicomWriter(kImplicitDicom).file(groups);
  const std::string explicit_groups = DicomWriter(kLittleEndianDicom).file(groups);
  DicomFields head;
  const std::size_t implicit_head = [&] {
    head.syntax = kImplicitDicom;
    return dicomHead(head).size();
  }();
  head.syntax = kLittleEndianDicom;
  const std::string from = explicit_groups.substr(dicomHead(head).size());
  // Each element gets the type UN and a length of four bytes before its implicit content.
  std::string to;
  for (std::size_t at = implicit_head; at < implicit.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, implicit.data() + at + 4, sizeof length);
    to += implicit.substr(at, 4) + std::string("UN\0\0", 4) + implicit.substr(at + 4, 4 + length);
    at += 8 + length;
  }
  std::string unknown = known;
  const std::size_t begin = unknown.find(from);
  ASSERT_NE(begin, std::string::npos);
  unknown.replace(begin, from.size(), to);
  writeFile(folder_.file("scan.dcm"), unknown);
  EXPECT_EQ(firsts(loadVolume(folder_.path())), (Floats{10, 30, 0, 20}));
}

}  // namespace dicom_frames_test
}  // namespace palpate
