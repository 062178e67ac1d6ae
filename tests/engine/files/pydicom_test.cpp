// SPDX-License-Identifier: Apache-2.0
// Random DICOM files against pydicom, where /usr/bin/python3 has it (python3-pydicom, python3-numpy); skipped with a
// word elsewhere.
//
// Both compute stored value x slope + intercept in double and round it once to float, or take an entry of a table. So
// every value is equal.
#include <cstdlib>
#include <random>

#include <fmt/format.h>

#include "engine/files/volume_file.hpp"
#include "tests/engine/files/dicom_writer.hpp"

namespace palpate {
namespace pydicom_test {

constexpr const char* kPython = "/usr/bin/python3";
constexpr const char* kInstead = "-77.25";  // of padding; a value that floats hold and no table has
constexpr int kFolders = 300;

// A scan of random form and values. What is drawn does not depend on the library.
class RandomScan {
 public:
  explicit RandomScan(unsigned seed) : random_(seed) {
    syntax_ = pick<std::string>(
        {kImplicitDicom, kLittleEndianDicom, kLittleEndianDicom, kBigEndianDicom, kDeflatedDicom, kRleDicom});
    image_.rows = below(1, 6);
    image_.columns = below(1, 8);
    image_.bits_allocated = pick<int>({8, 16, 16, 32});
    image_.bits_stored = one(3) ? image_.bits_allocated : below(1, image_.bits_allocated);
    image_.high_bit = one(2) ? image_.bits_stored - 1 : below(image_.bits_stored - 1, image_.bits_allocated - 1);
    image_.is_signed = one(2);
    image_.meaning = pick<std::string>({"MONOCHROME1", "MONOCHROME2"});
    image_.as_words = one(4);
    frames_ = below(2, 4);
    order_.resize(static_cast<std::size_t>(frames_));
    for (std::size_t n = 0; n < order_.size(); ++n) order_[n] = static_cast<int>(n);
    for (std::size_t n = order_.size(); n > 1; --n)
      std::swap(order_[n - 1], order_[static_cast<std::size_t>(below(0, static_cast<int>(n) - 1))]);
    scaling_ = below(0, 3);
  }

  // The bytes of its files.
  [[nodiscard]] std::vector<std::string> files() {
    addCommon();
    return one(3) ? std::vector{enhanced()} : slices();
  }

 private:
  int below(int low, int high) { return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1)); }
  bool one(int of) { return random_() % static_cast<unsigned>(of) == 0; }
  template <class T>
  T pick(const std::vector<T>& of) {
    return of[random_() % of.size()];
  }

  [[nodiscard]] std::vector<std::int64_t> words(int frames) {
    std::vector<std::int64_t> all;
    const std::uint64_t mask = (std::uint64_t{1} << image_.bits_allocated) - 1;
    for (int n = 0; n < frames * image_.rows * image_.columns; ++n) {
      std::uint64_t word = one(4) && padding_word_ ? *padding_word_ : random_();
      all.push_back(static_cast<std::int64_t>(word & mask));
    }
    return all;
  }
  std::int64_t storedValue() {
    const std::int64_t range = std::int64_t{1} << std::min(image_.bits_stored, 16);
    const auto value = static_cast<std::int64_t>(random_()) % range;
    return image_.is_signed ? value - range / 2 : value;
  }
  std::pair<std::string, std::string> scale() {
    return {
        pick<std::string>({"1", "2", "0.1", "-1", "1.7E-03", "-0.333333333", "12345.678", "3.0517578125e-5", "+.5"}),
        pick<std::string>({"0", "-1024", "0.1", "1e6", "-8192.5", "1000"})};
  }

  void addCommon() {
    const std::string type = image_.is_signed ? "SS" : "US";
    if (one(3)) {
      const std::int64_t value = storedValue();
      common_[0x00280120] = numbersOf(type, {value});
      if (one(2)) common_[0x00280121] = numbersOf(type, {storedValue()});
      padding_word_ = static_cast<std::uint64_t>(value) << (image_.high_bit + 1 - image_.bits_stored);
    }
    if (scaling_ != 3) return;
    const int bits = pick<int>({8, 16});  // the only two that pydicom knows, 8 in words
    const int entries = below(1, 300);
    std::vector<std::int64_t> table;
    for (int n = 0; n < entries; ++n) table.push_back(static_cast<std::int64_t>(random_()) % (1 << bits));
    common_[0x00283000] = itemsOf({{{0x00283002, numbersOf(type, {entries, storedValue(), bits})},
                                    {0x00283006, numbersOf(pick<std::string>({"OW", "US"}), table)}}},
                                  one(2));
  }

  // Scaled all alike (1), or each in its own way (2).
  std::pair<std::string, std::string> nextScale() {
    if (!scale_ || scaling_ == 2) scale_ = scale();
    return *scale_;
  }

  std::vector<std::string> slices() {
    std::vector<std::string> files;
    for (const int place : order_) {
      WrittenImage image = image_;
      image.words = words(1);
      WrittenItem set = imageSet(image);
      placeAt(set, fmt::format("1.5\\-2\\{}", 2 * place));
      set.insert(common_.begin(), common_.end());
      if (scaling_ == 1 || scaling_ == 2) {
        const auto [slope, intercept] = nextScale();
        set[0x00281052] = textOf("DS", intercept);
        set[0x00281053] = textOf("DS", slope);
      }
      pack(set, image, 1);
      files.push_back(DicomWriter(syntax_).file(set));
    }
    return files;
  }

  std::string enhanced() {
    WrittenImage image = image_;
    image.words = words(frames_);
    WrittenItem set = imageSet(image);
    set.insert(common_.begin(), common_.end());
    set[0x00280008] = textOf("IS", std::to_string(frames_));
    WrittenItem shared;
    std::vector<WrittenItem> frames(order_.size());
    const bool own = one(2);
    if (!own) addOrientation(shared);
    if (!own) addMeasures(shared);
    if (scaling_ == 1) addTransformation(shared, nextScale().first, nextScale().second);
    for (std::size_t n = 0; n < frames.size(); ++n) {
      addFrameContent(frames[n], "1", 1);
      addPosition(frames[n], fmt::format("1.5\\-2\\{}", 2 * order_[n]));
      if (own) addOrientation(frames[n]);
      if (own) addMeasures(frames[n]);
      if (scaling_ != 2) continue;
      const auto [slope, intercept] = nextScale();
      addTransformation(frames[n], slope, intercept);
    }
    const bool open = one(2);
    set[0x52009229] = itemsOf({shared}, open);
    set[0x52009230] = itemsOf(frames, open);
    pack(set, image, order_.size());
    return DicomWriter(syntax_).file(set);
  }

  void pack(WrittenItem& set, const WrittenImage& image, std::size_t frames) const {
    if (syntax_ != kRleDicom) return;
    WrittenElement pixels = textOf("OB", "");
    const std::size_t each = image.words.size() / frames;
    for (std::size_t n = 0; n < frames; ++n) {
      const auto first = image.words.begin() + static_cast<std::ptrdiff_t>(n * each);
      pixels.fragments.push_back(rleFrame({first, first + static_cast<std::ptrdiff_t>(each)},
                                          static_cast<std::size_t>(image.bits_allocated) / 8));
    }
    set[0x7fe00010] = pixels;
  }

  std::mt19937 random_;
  std::string syntax_;
  WrittenImage image_;
  int frames_ = 2;
  std::vector<int> order_;  // the place of each
  int scaling_ = 0;         // none, all alike, each in its own way, by a table
  WrittenItem common_;
  std::optional<std::uint64_t> padding_word_;
  std::optional<std::pair<std::string, std::string>> scale_;
};

TEST(Pydicom, ReadsEveryValueAsPalpateDoes) {
  const std::string ask = fmt::format("{} -c 'import numpy, pydicom' > /dev/null 2>&1", kPython);
  if (std::system(ask.c_str()) != 0) GTEST_SKIP() << kPython << " has no pydicom (package python3-pydicom)";
  const TempFolder folder;
  std::string jobs;
  for (int n = 0; n < kFolders; ++n) {
    const std::string name = folder.file(fmt::format("f{}", n));
    std::filesystem::create_directory(name);
    const std::vector<std::string> files = RandomScan(static_cast<unsigned>(1000 + n)).files();
    for (std::size_t k = 0; k < files.size(); ++k) writeFile(fmt::format("{}/s{}.dcm", name, k), files[k]);
    jobs += fmt::format("{} {} {}\n", name, files.size(), kInstead);
  }
  writeFile(folder.file("jobs"), jobs);
  const std::string command =
      fmt::format("{} {} {} > {} 2>&1", kPython, PALPATE_READ_PYDICOM, folder.file("jobs"), folder.file("said"));
  ASSERT_EQ(std::system(command.c_str()), 0) << readFile(folder.file("said"));
  int equal = 0;
  std::map<std::string, int> refused;
  for (int n = 0; n < kFolders; ++n) {
    const std::string name = folder.file(fmt::format("f{}", n));
    const std::string bytes = readFile(name + ".f32");
    std::vector<float> want(bytes.size() / sizeof(float));
    std::memcpy(want.data(), bytes.data(), bytes.size());
    try {
      EXPECT_EQ(loadVolume(name + "?nan=" + kInstead).toDense(), want) << "seed " << 1000 + n;
      ++equal;
    } catch (const Error& error) {
      EXPECT_EQ(error.input(), name);
      ++refused[error.remedy()];
    }
  }
  // What is not read: two pixels of 8 bits in a big-endian word, and scans that are all padding.
  for (const auto& [remedy, count] : refused) {
    EXPECT_THAT(remedy, testing::AnyOf("convert the series to little-endian order", "give another series"));
    EXPECT_LE(count, kFolders / 20) << remedy;
  }
  EXPECT_GE(equal, kFolders * 9 / 10);
  RecordProperty("equal", equal);
}

}  // namespace pydicom_test
}  // namespace palpate
