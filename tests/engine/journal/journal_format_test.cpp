// SPDX-License-Identifier: Apache-2.0
// What is written is read again, to the bit; what is no such thing is refused.
#include "engine/journal/journal_format.hpp"

#include <cstring>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "engine/journal/byte_stream.hpp"
#include "journal_samples.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace journal_format_test {

using ::testing::HasSubstr;

JournalHeader header() {
  return sampleHeader(sampleVolume());
}

std::string refusal(const std::string& bytes) {
  JournalHeader read;
  return refusalOf([&] { static_cast<void>(readHeader(bytes, "FILE", read)); });
}

TEST(JournalFormat, HeaderComesBack) {
  JournalHeader written = header();
  written.volume.source = "phantom:knot?size=64";
  const std::string bytes = headerBytes(written);
  JournalHeader read;
  EXPECT_EQ(readHeader(bytes + "more", "FILE", read), bytes.size());
  EXPECT_EQ(headerBytes(read), bytes);
  EXPECT_EQ(read.volume.source, written.volume.source);
  EXPECT_EQ(read.volume.content, written.volume.content);
  EXPECT_EQ(read.profile.slope_per_m, written.profile.slope_per_m);
}

// The order of docs/journal.md, spelt out: what was written by an older program must come back for ever.
TEST(JournalFormat, IsWhatTheDocumentSays) {
  EditCommand c;
  c.from_W = {1, 2, 3};
  c.to_W = {4, 5, 6};
  c.radius_m = 7;
  c.strength = 0.5;
  c.falloff = 0.25;
  c.value = 8;
  c.plane_W = {9, 10, 11};
  c.normal_W = {12, 13, 14};
  c.R_WS << 1, 4, 7, 2, 5, 8, 3, 6, 9;  // written axis after axis
  const std::uint32_t number = 77;
  const auto expectContent = [&](EditKind kind, std::uint8_t flags, const std::vector<double>& before_number,
                                 const std::vector<double>& after_number) {
    c.kind = kind;
    ByteWriter want;
    want.add(std::uint32_t{1});
    want.add(static_cast<std::uint8_t>(kind));
    want.add(flags);
    for (const double member : before_number) want.add(member);
    if (isStamp(kind)) want.add(number);
    for (const double member : after_number) want.add(member);
    EXPECT_EQ(editContent({&c, 1}, {&number, 1}), want.bytes()) << editName(kind);
  };
  expectContent(EditKind::kSmooth, 0, {0.5, 1, 2, 3, 4, 5, 6, 7, 0.25}, {});
  expectContent(EditKind::kPaint, 0, {0.5, 1, 2, 3, 4, 5, 6, 7, 0.25, 8}, {});
  expectContent(EditKind::kCut, 0, {0.5, 9, 10, 11, 12, 13, 14}, {});
  expectContent(EditKind::kStampRemove, 0, {0.5}, {1, 2, 3, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  c.object = 15;
  expectContent(EditKind::kFlatten, 1, {0.5, 1, 2, 3, 4, 5, 6, 7, 0.25, 9, 10, 11, 12, 13, 14, 15}, {});
  c.material = {16, 17, 0.75};
  expectContent(EditKind::kRemove, 3, {0.5, 1, 2, 3, 4, 5, 6, 7, 0.25, 15, 16, 17, 0.75}, {});
  expectContent(EditKind::kStampAdd, 3, {0.5}, {1, 2, 3, 1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 0.75});
}

Lattice numberedLattice() {
  Lattice lattice;
  lattice.origin_W = {1, 2, 3};
  lattice.R_WL << 4, 7, 10, 5, 8, 11, 6, 9, 12;  // written axis after axis
  lattice.spacing_m = {13, 14, 15};
  return lattice;
}

TEST(JournalFormat, OfTheHeaderIsWhatTheDocumentSays) {
  const JournalHeader header{
      {"phantom:x", {21, 22, 23}, numberedLattice(), 0x0123456789abcdefU}, {31, 32, 33, 34, 35}, 0xfedcba9876543210U};
  ByteWriter content;
  content.add(std::string_view("phantom:x"));
  for (const std::int32_t size : {21, 22, 23}) content.add(size);
  for (int n = 1; n <= 15; ++n) content.add(static_cast<double>(n));
  content.add(std::uint64_t{0x0123456789abcdefU});
  for (int n = 31; n <= 35; ++n) content.add(static_cast<double>(n));
  content.add(std::uint64_t{0xfedcba9876543210U});
  ByteWriter want;
  want.addRaw("PALPJRNL");
  want.add(std::uint32_t{4});
  want.add(std::string_view(content.bytes()));
  want.add(crc32c(want.bytes()));
  EXPECT_EQ(headerBytes(header), want.bytes());
  JournalHeader read;
  EXPECT_EQ(readHeader(want.bytes(), "FILE", read), want.bytes().size());
  EXPECT_EQ(read.volume.source, "phantom:x");
  EXPECT_EQ(read.volume.size, Vec3i(21, 22, 23));
  EXPECT_EQ(read.volume.lattice.R_WL, header.volume.lattice.R_WL);
  EXPECT_EQ(read.volume.content, header.volume.content);
  EXPECT_EQ(read.profile.isovalue, 31);
  EXPECT_EQ(read.profile.background, 32);
  EXPECT_EQ(read.profile.object, 33);
  EXPECT_EQ(read.profile.slope_per_m, 34);
  EXPECT_EQ(read.profile.band_m, 35);
  EXPECT_EQ(read.id, 0xfedcba9876543210U);
}

TEST(JournalFormat, OfAStampIsWhatTheDocumentSays) {
  Stamp stamp;
  stamp.size = {2, 3, 4};
  stamp.lattice = numberedLattice();
  ByteWriter want;
  for (const std::int32_t size : {2, 3, 4}) want.add(size);
  for (int n = 1; n <= 15; ++n) want.add(static_cast<double>(n));
  for (int n = 0; n < 24; ++n) {
    stamp.distance_m.push_back(static_cast<float>(n) - 0.5F);
    want.add(stamp.distance_m.back());
  }
  EXPECT_EQ(stampContent(stamp), want.bytes());
}

// A record is its length, kind and number, what it holds, and a checksum of all of that.
TEST(JournalFormat, OfARecordIsWhatTheDocumentSays) {
  ByteWriter want;
  want.add(std::uint32_t{5});
  want.add(std::uint32_t{3});
  want.add(std::uint64_t{99});
  want.addRaw("bytes");
  want.add(crc32c(want.bytes()));
  EXPECT_EQ(recordBytes(RecordKind::kRedo, 99, "bytes"), want.bytes());
}

TEST(JournalFormat, KnowsItsLongestCommand) {
  EditCommand c;
  c.object = 1;
  c.material.emplace();
  const std::uint32_t number = 1;
  std::size_t longest = 0;
  for (unsigned kind = 0; kind < kEditKinds; ++kind) {
    c.kind = static_cast<EditKind>(kind);
    longest = std::max(longest, editContent({&c, 1}, {&number, 1}).size() - sizeof(std::uint32_t));
  }
  EXPECT_EQ(longest, kLongestCommand);
}

TEST(JournalFormat, RefusesWhatIsNoJournal) {
  EXPECT_THAT(refusal(""), HasSubstr("no journal"));
  EXPECT_THAT(refusal("not at all a journal, but long enough"), HasSubstr("--journal"));
}

TEST(JournalFormat, RefusesAnotherVersionAndSaysWhatToDo) {
  std::string bytes = headerBytes(header());
  for (const char version : {char{1}, char{5}}) {
    bytes[kJournalMagic.size()] = version;
    const std::string reason = fmt::format("format version {}, and this program knows versions 2 to 4", int{version});
    EXPECT_THAT(refusal(bytes), HasSubstr(reason + "; recover it with"));
  }
}

// Versions 2 and 3 have no number of the journal at the header's end, and fewer kinds of records.
TEST(JournalFormat, ReadsTheVersionsBefore) {
  const std::string present = headerBytes(header());
  const std::size_t front = kJournalMagic.size() + sizeof(std::uint32_t);
  for (const std::uint32_t version : {2U, 3U}) {
    ByteWriter older;
    older.addRaw(kJournalMagic);
    older.add(version);
    older.add(present.substr(front + 4, present.size() - front - 4 - 4 - sizeof(std::uint64_t)));
    older.add(crc32c(older.bytes()));
    JournalHeader read;
    read.id = 5;
    EXPECT_EQ(readHeader(older.bytes(), "FILE", read), older.bytes().size());
    EXPECT_EQ(read.volume.content, header().volume.content);
    EXPECT_EQ(read.id, 0U);
  }
}

TEST(JournalFormat, BricksComeBack) {
  const Volume volume = sampleVolume();
  const std::vector<std::uint32_t> bricks = {0, 1, 7, 20};
  const std::string content = bricksContent({9, 77}, true, volume, bricks);
  KeptBricks read;
  const auto record = bricksOf(content, read);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->mark, (EditMark{9, 77}));
  EXPECT_TRUE(record->is_last);
  EXPECT_EQ(read.bricks, bricks);
  Volume empty = Volume::fromDense(volume.size(), volume.lattice(),
                                   std::vector<float>(static_cast<std::size_t>(volume.size().prod())), {});
  ASSERT_TRUE(fit(read, empty));
  putBricks(read, empty);
  EXPECT_EQ(bricksContent({9, 77}, true, empty, bricks), content);
  EXPECT_FALSE(bricksOf(content, read));  // the same once more: they are not ascending
  for (std::size_t size = 0; size < content.size(); size += 13) {
    KeptBricks cut;
    EXPECT_FALSE(bricksOf(content.substr(0, size), cut)) << size;
  }
  KeptBricks longer;
  EXPECT_FALSE(bricksOf(content + "x", longer));
}

TEST(JournalFormat, RefusesADamagedHeaderWhereverItIsDamaged) {
  const std::string sound = headerBytes(header());
  for (std::size_t at = kJournalMagic.size() + 4; at < sound.size(); ++at) {
    std::string bytes = sound;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_THAT(refusal(bytes), HasSubstr("header is damaged")) << at;
    EXPECT_THAT(refusal(sound.substr(0, at)), HasSubstr("header is damaged")) << at;
  }
}

// Equal bytes say that nothing was lost, as every member goes into them; a few are compared by value.
TEST(JournalFormat, EveryKindOfCommandComesBack) {
  RandomEdits random({27, 22, 19}, sampleLattice(), kLow, kHigh, 5);
  for (int i = 0; i < 300; ++i) {
    EditCommand command = random.next();
    if (i % 4 == 0) command.object = random.between(50, 100);
    const std::vector<std::shared_ptr<const Stamp>> stamps = {nullptr, command.stamp};
    const std::vector<std::uint32_t> numbers = {2};
    const std::string content = editContent({&command, 1}, numbers);
    const auto read = editOf(content, stamps);
    ASSERT_TRUE(read && read->size() == 1);
    EXPECT_EQ(editContent(*read, numbers), content);
    const EditCommand& back = read->front();
    EXPECT_EQ(back.kind, command.kind);
    EXPECT_EQ(back.strength, command.strength);
    EXPECT_EQ(back.object, command.object);
    EXPECT_EQ(back.material.has_value(), command.material.has_value());
    EXPECT_EQ(back.stamp, isStamp(command.kind) ? command.stamp : nullptr);
    if (isBrush(command.kind)) {
      EXPECT_EQ(back.from_W, command.from_W);
      EXPECT_EQ(back.to_W, command.to_W);
      EXPECT_EQ(back.radius_m, command.radius_m);
      EXPECT_EQ(back.falloff, command.falloff);
    }
    if (hasValue(command.kind)) {
      EXPECT_EQ(back.value, command.value);
    }
    if (hasPlane(command.kind)) {
      EXPECT_EQ(back.plane_W, command.plane_W);
      EXPECT_EQ(back.normal_W, command.normal_W);
    }
    if (isStamp(command.kind)) {
      EXPECT_EQ(back.R_WS, command.R_WS);
    }
  }
}

TEST(JournalFormat, StampsComeBack) {
  const auto stamp = RandomEdits::ball(2e-3);
  const auto read = stampOf(stampContent(*stamp));
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->size, stamp->size);
  EXPECT_EQ(read->lattice.origin_W, stamp->lattice.origin_W);
  EXPECT_EQ(read->distance_m, stamp->distance_m);
}

TEST(JournalFormat, ContentThatIsCutOrLongerIsNone) {
  const std::string stamp = stampContent(*RandomEdits::ball(2e-3));
  EXPECT_EQ(stampOf(stamp.substr(0, stamp.size() - 1)), nullptr);
  const EditCommand command = dab(0);
  const std::vector<std::uint32_t> numbers = {0};
  const std::string edit = editContent({&command, 1}, numbers);
  for (std::size_t size = 0; size < edit.size(); ++size) EXPECT_FALSE(editOf(edit.substr(0, size), {})) << size;
  EXPECT_FALSE(editOf(edit + "x", {}));
}

// From 2 to 1024 samples along an axis.
TEST(JournalFormat, StampsHaveASize) {
  const auto comesBack = [](const Vec3i& size) {
    Stamp stamp;
    stamp.size = size;
    stamp.distance_m.assign(static_cast<std::size_t>(size.prod()), 0.25F);
    const auto read = stampOf(stampContent(stamp));
    return read != nullptr && read->distance_m == stamp.distance_m;
  };
  EXPECT_TRUE(comesBack({2, 2, 1024}));
  EXPECT_TRUE(comesBack({1024, 2, 2}));
  EXPECT_FALSE(comesBack({2, 1025, 2}));
  EXPECT_FALSE(comesBack({2, 2, 1}));
  EXPECT_FALSE(comesBack({1, 2, 2}));
}

TEST(JournalFormat, KindsAndFlagsThatThereAreNotAreRefused) {
  const EditCommand command = dab(0);
  const std::uint32_t number = 0;
  const std::string sound = editContent({&command, 1}, {&number, 1});
  const auto with = [&](std::size_t at, int byte) {
    std::string bytes = sound;
    bytes[at] = static_cast<char>(byte);
    return editOf(bytes, {}).has_value();
  };
  EXPECT_TRUE(with(4, static_cast<int>(EditKind::kDeflate)));  // another brush, as long
  EXPECT_FALSE(with(4, static_cast<int>(kEditKinds)));
  EXPECT_FALSE(with(5, 4));
  EXPECT_FALSE(editOf(std::string(4, '\0'), {}));  // no command at all
}

TEST(JournalFormat, AStampThatWasNeverWrittenIsRefused) {
  EditCommand command;
  command.kind = EditKind::kStampAdd;
  const std::vector<std::uint32_t> numbers = {3};
  EXPECT_FALSE(editOf(editContent({&command, 1}, numbers), {}));
  const std::vector<std::shared_ptr<const Stamp>> two = {RandomEdits::ball(2e-3), RandomEdits::ball(3e-3)};
  for (const std::uint32_t number : {0U, 3U}) EXPECT_FALSE(editOf(editContent({&command, 1}, {&number, 1}), two));
  const std::uint32_t first = 1;
  EXPECT_EQ(editOf(editContent({&command, 1}, {&first, 1}), two).value().at(0).stamp, two[0]);
}

}  // namespace journal_format_test
}  // namespace palpate
