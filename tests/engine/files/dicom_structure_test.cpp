// SPDX-License-Identifier: Apache-2.0
// The walk over a DICOM file's elements, on files made byte by byte (PS3.5, chapter 7 and annexes A and G).
#include "engine/files/dicom_structure.hpp"

#include <set>

#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace dicom_structure_test {

constexpr const char* kImplicit = "1.2.840.10008.1.2";
constexpr const char* kRle = "1.2.840.10008.1.2.5";
constexpr const char* kJpeg = "1.2.840.10008.1.2.4.70";
constexpr double kUndefined = 4294967295.0;  // a length that a delimiter ends

std::string u16(int value, bool big_endian = false) {
  return bytesOf<std::uint16_t>({static_cast<double>(value)}, big_endian);
}
std::string u32(double value, bool big_endian = false) {
  return bytesOf<std::uint32_t>({value}, big_endian);
}
std::string tag(int group, int element) {
  return u16(group) + u16(element);
}

// An element of a long type, whatever its length says.
std::string longElement(int group, int element, const std::string& type, double length, const std::string& value) {
  return tag(group, element) + type + std::string(2, '\0') + u32(length) + value;
}
std::string sequence(int group, int element, const std::string& items) {
  return longElement(group, element, "SQ", static_cast<double>(items.size()), items);
}
std::string openSequence(int group, int element, const std::string& items) {
  return longElement(group, element, "SQ", kUndefined, items + tag(0xfffe, 0xe0dd) + u32(0));
}
std::string item(const std::string& content) {
  return tag(0xfffe, 0xe000) + u32(static_cast<double>(content.size())) + content;
}
std::string openItem(const std::string& content) {
  return tag(0xfffe, 0xe000) + u32(kUndefined) + content + tag(0xfffe, 0xe00d) + u32(0);
}

// What comes before the first element of a data set, and its parts: up to where and from where elements go.
std::vector<std::string> headParts(const std::string& syntax,
                                   const std::string& object_class = "1.2.840.10008.5.1.4.1.1.2") {
  return {std::string(128, '\0') + "DICM", dicomElement(2, 0x0002, "UI", object_class),
          dicomElement(2, 0x0010, "UI", syntax), dicomElement(2, 0x0012, "UI", "1.2.3")};
}
std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += part;
  return all;
}
std::string fileOf(const std::vector<std::string>& elements, const std::string& syntax = kLittleEndianDicom) {
  return joined(headParts(syntax)) + joined(elements);
}
bool isWhole(const std::vector<std::string>& elements, const std::string& syntax = kLittleEndianDicom) {
  return dicomIsWhole(fileOf(elements, syntax));
}

// A file is whole where it ends with an element, and nowhere else.
void expectWholeAtElementsOnly(const std::vector<std::string>& elements, const std::string& syntax) {
  std::vector<std::string> parts = headParts(syntax);
  parts.insert(parts.end(), elements.begin(), elements.end());
  std::set<std::size_t> ends;
  std::size_t end = parts[0].size();
  for (std::size_t n = 1; n < parts.size(); ++n) ends.insert(end += parts[n].size());
  const std::string whole = joined(parts);
  for (std::size_t size = 0; size <= whole.size(); ++size)
    ASSERT_EQ(dicomIsWhole(std::string_view(whole).substr(0, size)), ends.contains(size)) << syntax << " " << size;
}

TEST(DicomIsWhole, WhereAFileEndsWithAnElement) {
  for (const bool big : {false, true}) {
    expectWholeAtElementsOnly(
        {dicomElement(8, 0x16, "UI", "1.2", big), dicomElement(0x10, 0x10, "PN", "", big),
         dicomElement(0x28, 0x10, "US", u16(2, big), big), dicomElement(0x28, 0x11, "US", u16(3, big), big),
         dicomElement(0x28, 0x100, "US", u16(16, big), big),
         dicomElement(0x7fe0, 0x10, "OW", std::string(12, 'x'), big)},
        big ? kBigEndianDicom : kLittleEndianDicom);
  }
  // Implicit: no types, lengths of four bytes.
  const auto plain = [](int group, int element, const std::string& value) {
    return tag(group, element) + u32(static_cast<double>(value.size())) + value;
  };
  expectWholeAtElementsOnly(
      {plain(8, 0x16, std::string("1.2\0", 4)), plain(0x28, 0x10, u16(2)), plain(0x28, 0x11, u16(3)),
       plain(0x28, 0x100, u16(16)), plain(0x7fe0, 0x10, std::string(12, 'x'))},
      kImplicit);
}

TEST(DicomIsWhole, KnowsEveryType) {
  std::vector<std::string> elements;
  int number = 0;
  for (const char* type : {"OB", "OD", "OF", "OL", "OV", "OW", "SQ", "SV", "UC", "UN", "UR", "UT", "UV"})
    elements.push_back(
        longElement(9, ++number, type, std::string(type) == "SQ" ? 0 : 4, std::string(type) == "SQ" ? "" : "abcd"));
  for (const char* type : {"AE", "AS", "AT", "CS", "DA", "DS", "DT", "FD", "FL", "IS", "LO",
                           "LT", "PN", "SH", "SL", "SS", "ST", "TM", "UI", "UL", "US"})
    elements.push_back(tag(9, ++number) + type + u16(4) + "abcd");
  expectWholeAtElementsOnly(elements, kLittleEndianDicom);
  EXPECT_FALSE(isWhole({tag(9, 1) + "ZZ" + u16(4) + "abcd"}));
  EXPECT_FALSE(isWhole({tag(9, 1) + "BO" + u16(4) + "abcd"}));
}

TEST(DicomIsWhole, WhereTagsAscend) {
  const std::string a = dicomElement(8, 0x16, "UI", "1.2"), b = dicomElement(8, 0x18, "UI", "1.2"),
                    c = dicomElement(9, 0x01, "UI", "1.2");
  EXPECT_TRUE(isWhole({a, b, c}));
  EXPECT_FALSE(isWhole({b, a, c}));
  EXPECT_FALSE(isWhole({a, c, b}));
  EXPECT_FALSE(isWhole({a, a}));
}

// Numbers that the pixels need: 0 and "" leave an element out.
struct Pixels {
  int samples, rows, columns, bits;
  const char* frames;
  std::size_t bytes;  // as many as they need
};
std::vector<std::string> pixelElements(const Pixels& p, std::size_t bytes) {
  std::vector<std::string> elements;
  if (p.samples >= 0) elements.push_back(dicomElement(0x28, 0x02, "US", u16(p.samples)));
  if (*p.frames != '\0') elements.push_back(dicomElement(0x28, 0x08, "IS", p.frames));
  elements.push_back(dicomElement(0x28, 0x10, "US", u16(p.rows)));
  elements.push_back(dicomElement(0x28, 0x11, "US", u16(p.columns)));
  if (p.bits >= 0) elements.push_back(dicomElement(0x28, 0x100, "US", u16(p.bits)));
  elements.push_back(dicomElement(0x7fe0, 0x10, "OW", std::string(bytes, 'x')));
  return elements;
}

TEST(DicomIsWhole, WherePixelsAreAsManyAsTheyMustBe) {
  for (const Pixels& p :
       {Pixels{1, 2, 3, 16, "", 12}, Pixels{3, 2, 3, 16, "", 36}, Pixels{1, 2, 3, 16, "2", 24},
        Pixels{3, 2, 3, 8, "5", 90}, Pixels{1, 2, 3, 8, "", 6}, Pixels{1, 6, 8, 1, "", 6}, Pixels{1, 5, 8, 12, "", 60},
        Pixels{0, 6, 8, 0, "0", 6},         // one sample, bit and frame at least
        Pixels{-1, 4, 3, -1, "-2", 12}}) {  // where nothing is said: one sample of 8 bits
    SCOPED_TRACE(testing::Message() << p.samples << " " << p.bits << " '" << p.frames << "'");
    EXPECT_TRUE(isWhole(pixelElements(p, p.bytes)));
    EXPECT_TRUE(isWhole(pixelElements(p, p.bytes + 2)));
    EXPECT_FALSE(isWhole(pixelElements(p, p.bytes - 2)));
  }
  // 18 bits need more than two bytes.
  EXPECT_FALSE(isWhole(pixelElements({1, 6, 3, 1, "", 4}, 2)));
}

TEST(DicomIsWhole, WithSequencesOfEveryForm) {
  const std::string inner = dicomElement(8, 0x18, "UI", "1.2"), last = dicomElement(0x7fe0, 0x10, "OW", "pixels");
  for (const std::string& content : {item(inner), openItem(inner), item(inner) + openItem(inner) + item(""),
                                     openItem(sequence(9, 1, openItem(inner)) + openSequence(9, 2, item(inner)))}) {
    EXPECT_TRUE(isWhole({sequence(8, 0x1140, content), last}));
    EXPECT_TRUE(isWhole({openSequence(8, 0x1140, content), last}));
    expectWholeAtElementsOnly({openSequence(8, 0x1140, content), last}, kLittleEndianDicom);
  }
  expectWholeAtElementsOnly({sequence(8, 0x1140, ""), openSequence(8, 0x1150, ""), last}, kLittleEndianDicom);
  // A length that ends within an item, and one that its delimiter does not fill.
  const std::string delimiter = tag(0xfffe, 0xe0dd) + u32(0);
  EXPECT_FALSE(isWhole({longElement(8, 0x1140, "SQ", static_cast<double>(item(inner).size() - 2), item(inner)), last}));
  EXPECT_TRUE(isWhole({sequence(8, 0x1140, item(inner) + delimiter), last}));
  EXPECT_FALSE(isWhole({sequence(8, 0x1140, delimiter + item(inner)), last}));
  // What is no item in a sequence; delimiters where nothing is open.
  EXPECT_FALSE(isWhole({sequence(8, 0x1140, inner), last}));
  EXPECT_FALSE(isWhole({openSequence(8, 0x1140, inner), last}));
  EXPECT_FALSE(isWhole({tag(0xfffe, 0xe00d) + u32(0)}));
  EXPECT_FALSE(isWhole({openSequence(8, 0x1140, openItem(inner + inner)), last}));  // its tags ascend, too
}

// Items of a given length that Palpate reads are looked into: what is in them ends in them, and their tags ascend.
TEST(DicomIsWhole, WhereItemsThatAreReadHoldWholeElements) {
  const std::string place = dicomElement(0x20, 0x32, "DS", "1\\2\\3");
  const std::string later = dicomElement(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0");
  const auto frames = [&](const std::string& content) {
    const std::string file = fileOf({sequence(0x5200, 0x9230, item(sequence(0x20, 0x9113, item(content))))});
    return readDicomDataSet(file);
  };
  const auto set = frames(place + later);
  ASSERT_TRUE(set);
  const DicomElement& groups = set->root.element(DicomTag::kPerFrameFunctionalGroupsSequence);
  ASSERT_EQ(groups.items.size(), 1U);
  const DicomItem* position = groups.items[0].item(DicomTag::kPlanePositionSequence);
  ASSERT_NE(position, nullptr);
  EXPECT_EQ(position->text(DicomTag::kImagePositionPatient), "1\\2\\3");
  EXPECT_FALSE(position->has(DicomTag::kPixelSpacing));
  EXPECT_FALSE(frames(later + place));
  EXPECT_FALSE(frames(place.substr(0, place.size() - 2)));
  EXPECT_FALSE(frames(place + "x"));
}

TEST(DicomIsWhole, WithSequencesNoDeeperThan32) {
  for (const bool open : {true, false}) {  // until a delimiter, or of a given length
    const auto nested = [open](int depth) {
      std::string content;
      for (int n = 0; n < depth; ++n) {
        content = openItem(content);
        content = open ? openSequence(8, 0x1140, content) : sequence(8, 0x1140, content);
      }
      return content;
    };
    EXPECT_TRUE(isWhole({nested(32)})) << open;
    EXPECT_FALSE(isWhole({nested(33)})) << open;
  }
}

// An icon in a sequence has a size of its own, which says nothing of the pixels.
TEST(DicomIsWhole, CountsPixelsOfTheImageOnly) {
  const std::string icon = joined(pixelElements({1, 50, 50, 16, "", 0}, 2));
  const std::vector<std::string> image = pixelElements({1, 2, 3, 16, "", 12}, 12);
  std::vector<std::string> both(image.begin(), image.end() - 1);
  both.push_back(openSequence(0x88, 0x200, openItem(icon)));
  both.push_back(image.back());
  EXPECT_TRUE(isWhole(both));
}

// --- RLE ------------------------------------------------------------------------------------------------------------

// Sixteen words: how many byte planes there are, and where each begins; then these.
std::string rleFrame(const std::vector<std::string>& planes) {
  std::string head = u32(static_cast<double>(planes.size())), body;
  for (const std::string& plane : planes) {
    head += u32(static_cast<double>(64 + body.size()));
    body += plane;
  }
  head.resize(64, '\0');
  return head + body;
}
// The elements of an image of 2 x 3 pixels, `bits` each, whose frames are these fragments.
bool rleIsWhole(const std::vector<std::string>& fragments, int bits, const char* frames = "", int samples = 1) {
  std::vector<std::string> elements = pixelElements({samples, 2, 3, bits, frames, 0}, 0);
  std::string items = item("");  // says where frames begin, or nothing
  for (const std::string& fragment : fragments) items += item(fragment);
  elements.back() = longElement(0x7fe0, 0x10, "OB", kUndefined, items + tag(0xfffe, 0xe0dd) + u32(0));
  return isWhole(elements, kRle);
}

const std::string kLiteral = std::string("\x05") + "abcdef";  // six bytes as they are
const std::string kRun = std::string("\xfb") + "a";           // 257 - 251: six times one
const std::string kMixed = std::string("\x80\x01") +
                           "ab\xfd"
                           "c";  // nothing, two, and four times one

TEST(DicomIsWhole, WhereEveryByteOfAnRleFrameIsThere) {
  for (const std::string& plane : {kLiteral, kRun, kMixed, kLiteral + std::string(1, '\0')}) {
    EXPECT_TRUE(rleIsWhole({rleFrame({plane})}, 8));
    EXPECT_TRUE(rleIsWhole({rleFrame({plane, kLiteral})}, 16));
    EXPECT_TRUE(rleIsWhole({rleFrame({kRun, plane})}, 12));  // of bytes there are whole ones only
    EXPECT_TRUE(rleIsWhole({rleFrame({kMixed, kRun, plane})}, 8, "", 3));
  }
  const std::string five = std::string("\x04") + "abcde", seven = std::string("\x06") + "abcdefg";
  for (const std::string& plane : {five, seven, std::string("\xfc") + "a", std::string("\xfa") + "a",
                                   kLiteral.substr(0, 6), kRun.substr(0, 1), std::string("\x80"), std::string()}) {
    EXPECT_FALSE(rleIsWhole({rleFrame({plane})}, 8));
    EXPECT_FALSE(rleIsWhole({rleFrame({plane, kRun})}, 16));
    EXPECT_FALSE(rleIsWhole({rleFrame({kRun, plane})}, 16));
  }
}

TEST(DicomIsWhole, WhereAnRleFrameHasItsPlanes) {
  const std::string good = rleFrame({kLiteral, kRun});
  ASSERT_TRUE(rleIsWhole({good}, 16));
  EXPECT_FALSE(rleIsWhole({good}, 8));
  EXPECT_FALSE(rleIsWhole({good}, 17));
  EXPECT_FALSE(rleIsWhole({good}, 8, "", 3));
  const auto with = [&](std::size_t word, double value) {
    std::string bytes = good;
    overwrite(bytes, 4 * word, u32(value));
    return rleIsWhole({bytes}, 16);
  };
  EXPECT_TRUE(with(1, 64));
  EXPECT_FALSE(with(1, 63));  // in the words themselves
  EXPECT_FALSE(with(1, 72));  // behind the second
  EXPECT_FALSE(with(2, 63));
  EXPECT_FALSE(with(2, static_cast<double>(good.size() + 1)));
  EXPECT_FALSE(rleIsWhole({good.substr(0, 63)}, 16));
  EXPECT_FALSE(rleIsWhole({std::string(64, '\0')}, 16));
}

TEST(DicomIsWhole, WhereEveryRleFrameIsThere) {
  const std::string frame = rleFrame({kRun});
  EXPECT_FALSE(rleIsWhole({}, 8));
  EXPECT_TRUE(rleIsWhole({frame}, 8));
  EXPECT_FALSE(rleIsWhole({frame}, 8, "2"));
  EXPECT_TRUE(rleIsWhole({frame, frame}, 8, "2"));
  EXPECT_FALSE(rleIsWhole({frame, frame.substr(0, 65)}, 8, "2"));
}

// The longest runs of either kind: 128 bytes.
TEST(DicomIsWhole, KnowsTheLongestRunsOfRle) {
  for (const std::string& plane : {std::string("\x7f") + std::string(128, 'a'), std::string("\x81") + "a"}) {
    for (const int columns : {127, 128, 129}) {
      std::vector<std::string> elements = pixelElements({1, 1, columns, 8, "", 0}, 0);
      elements.back() = longElement(0x7fe0, 0x10, "OB", kUndefined,
                                    item("") + item(rleFrame({plane})) + tag(0xfffe, 0xe0dd) + u32(0));
      EXPECT_EQ(isWhole(elements, kRle), columns == 128) << columns;
    }
  }
}

// Other packings say for themselves what is missing.
TEST(DicomIsWhole, WhateverIsInFragmentsOfOtherPackings) {
  std::vector<std::string> elements = pixelElements({1, 200, 300, 16, "7", 0}, 0);
  const std::string items = item("") + item("anything");
  elements.back() = longElement(0x7fe0, 0x10, "OB", kUndefined, items + tag(0xfffe, 0xe0dd) + u32(0));
  EXPECT_TRUE(isWhole(elements, kJpeg));
  expectWholeAtElementsOnly(elements, kJpeg);
}

// --- classes --------------------------------------------------------------------------------------------------------

TEST(DicomIsNoImage, OfTheClassesThatHoldNone) {
  const auto isNone = [](const std::string& object_class) {
    return dicomIsNoImage(joined(headParts(kLittleEndianDicom, object_class)));
  };
  const std::string stored = "1.2.840.10008.5.1.4.1.1.";
  EXPECT_TRUE(isNone("1.2.840.10008.1.3.10"));
  for (const char* kind :
       {"9.1.1", "11.1", "88.11", "104.1", "66", "66.1", "66.2", "66.3", "66.5", "481.3", "481.5", "481.8"})
    EXPECT_TRUE(isNone(stored + kind)) << kind;
  for (const char* kind : {"2", "4", "1.1", "7", "12.1", "66.4", "128", "481.1", "481.2", "481.4", "481.50"})
    EXPECT_FALSE(isNone(stored + kind)) << kind;
  EXPECT_FALSE(isNone("1.2.840.10008.5.1.4.1.2.88.11"));
  EXPECT_FALSE(isNone(""));
  EXPECT_FALSE(dicomIsNoImage(""));
  EXPECT_FALSE(dicomIsNoImage(std::string(128, '\0') + "DICM"));
  // Cut within the class, nobody knows.
  const std::string report = joined(headParts(kLittleEndianDicom, stored + "88.11"));
  EXPECT_FALSE(dicomIsNoImage(report.substr(0, 132 + 8 + 20)));
}

}  // namespace dicom_structure_test
}  // namespace palpate
