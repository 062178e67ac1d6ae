// SPDX-License-Identifier: Apache-2.0
// Files cut short or changed at random, in every format (.vdb: vdb_test.cpp). A file that is cut gives an Error, or,
// where only a checksum is gone, the whole volume; a changed one gives an Error or some volume; none crashes or hangs.
#include <functional>
#include <random>

#include <fmt/format.h>

#include "tests/engine/volume/known_leaks.hpp"
#include "tests/engine/volume/samples.hpp"

namespace palpate {
namespace {

struct Format {
  std::string name;
  std::string file;                                     // inside the folder; the one that is damaged
  std::string volume;                                   // what is loaded; "" for the folder itself
  std::function<void(const TempFolder& folder)> write;  // the whole thing, undamaged
  std::size_t unseen = 0;                               // bytes at the end whose loss cannot be seen
};

std::string data() {
  return bytesOf<std::int16_t>(rampValues(-30));
}

std::string gzipped(const TempFolder& folder, const std::string& bytes) {
  writeGzip(folder.file("gz"), bytes);
  return readFile(folder.file("gz"));
}

void writeDicomFolder(const TempFolder& folder) {
  for (int n = 0; n < 3; ++n) {
    DicomFields fields;
    fields.position = fmt::format("0\\0\\{}", 2 * n);
    fields.sop += std::to_string(n);
    fields.pixels = std::vector<double>(20, n);
    fields.pixels[3] = 100;
    writeFile(folder.file(fmt::format("s{}.dcm", n)), dicomBytes(fields));
  }
}

std::vector<Format> formats() {
  return {
      {"NrrdRaw", "a.nrrd", "a.nrrd",
       [](const TempFolder& f) { writeFile(f.file("a.nrrd"), nrrdHeader("int16", "raw") + "\n" + data()); }},
      {"NrrdGzip", "a.nrrd", "a.nrrd",
       [](const TempFolder& f) {
         writeFile(f.file("a.nrrd"), nrrdHeader("int16", "gzip") + "\n" + gzipped(f, data()));
       }},
      {"NrrdText", "a.nrrd", "a.nrrd",
       [](const TempFolder& f) {
         std::string text;
         for (const double value : rampValues(100)) text += fmt::format("{} ", value);
         writeFile(f.file("a.nrrd"), nrrdHeader("int16", "ascii") + "\n" + text);
       },
       4},  // "159 " cut to "15" is a number too
      {"Nifti", "a.nii", "a.nii", [](const TempFolder& f) { writeFile(f.file("a.nii"), niftiHeader({}) + data()); }},
      {"NiftiGzip", "a.nii.gz", "a.nii.gz",
       [](const TempFolder& f) { writeGzip(f.file("a.nii.gz"), niftiHeader({}) + data()); }},
      {"NiftiPairData", "a.img", "a.hdr",
       [](const TempFolder& f) {
         NiftiFields pair;
         pair.one_file = false;
         writeFile(f.file("a.hdr"), niftiHeader(pair));
         writeFile(f.file("a.img"), data());
       }},
      {"Meta", "a.mha", "a.mha",
       [](const TempFolder& f) { writeFile(f.file("a.mha"), metaHeader("MET_SHORT") + data()); }},
      {"MetaCompressed", "a.mha", "a.mha",
       [](const TempFolder& f) {
         writeWithItk(ItkWriter::kMeta, f.file("a.mha"), itkImageOf(plainLattice(), rampValues()), true);
       }},
      {"Invesalius", "a.inv3", "a.inv3",
       [](const TempFolder& f) {
         writeTarGz(f.file("a.inv3"), {{"main.plist", invesaliusPlist()}, {"matrix.dat", data()}});
       }},
      {"Dicom", "s1.dcm", "", writeDicomFolder},
  };
}

class Damage : public testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    GetParam().write(folder_);
    whole_ = readFile(folder_.file(GetParam().file));
    intact_ = load();
  }

  [[nodiscard]] std::vector<float> load() const {
    return loadVolume(GetParam().volume.empty() ? folder_.path() : folder_.file(GetParam().volume)).toDense();
  }
  void damage(const std::string& bytes) const { writeFile(folder_.file(GetParam().file), bytes); }

  TempFolder folder_;
  std::string whole_;
  std::vector<float> intact_;
};

TEST_P(Damage, CutFilesGiveNoHalfVolume) {
  int errors = 0;
  constexpr int kCuts = 120;
  for (int n = 0; n < kCuts; ++n) {
    // A third of the cuts lie in the last bytes, where only data are missing.
    const std::size_t length = n % 3 == 0 ? whole_.size() - static_cast<std::size_t>(n / 3) - 1
                                          : whole_.size() * static_cast<std::size_t>(n) / kCuts;
    damage(whole_.substr(0, length));
    if (length + GetParam().unseen >= whole_.size()) {
      ++errors;
      continue;
    }
    try {
      EXPECT_EQ(load(), intact_) << "cut to " << length << " of " << whole_.size();
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, kCuts * 3 / 4);
}

TEST_P(Damage, ChangedFilesGiveAVolumeOrAnError) {
  std::mt19937_64 random(5);
  for (int n = 0; n < 200; ++n) {
    std::string bytes = whole_;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int change = 0; change < changes; ++change) {
      bytes[random() % std::min<std::size_t>(bytes.size(), 900)] = static_cast<char>(random());
    }
    damage(bytes);
    try {
      EXPECT_FALSE(load().empty());
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

// Numbers in text headers grow, lose their sign and become words.
TEST_P(Damage, ChangedNumbersGiveAVolumeOrAnError) {
  std::mt19937_64 random(6);
  const std::vector<std::string> numbers = {"0",  "-1", "99999999999999999999", "nan", "1e400", "", "3", "1",
                                            "%d", "a b"};
  for (int n = 0; n < 200; ++n) {
    std::string bytes = whole_;
    const std::size_t digit = bytes.find_first_of("0123456789", random() % std::min<std::size_t>(bytes.size(), 400));
    if (digit == std::string::npos) continue;
    bytes.replace(digit, 1, numbers[random() % numbers.size()]);
    damage(bytes);
    try {
      EXPECT_FALSE(load().empty());
    } catch (const Error&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, Damage, testing::ValuesIn(formats()),
                         [](const auto& format) { return format.param.name; });

}  // namespace
}  // namespace palpate
