// SPDX-License-Identifier: Apache-2.0
// Values read whole from where headers say that they lie, and headers that say so wrongly.
#include "engine/files/stored_values.hpp"

#include <random>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/files/text_stored.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate {
namespace stored_values_test {

class Stored : public testing::Test {
 protected:
  [[nodiscard]] StoredValues nrrd(const std::string& header, std::size_t value_bytes = 2) const {
    writeFile(path_, header);
    return nrrdStored(readTextHeader(path_, path_, TextFormat::kNrrd), path_, value_bytes, path_);
  }
  [[nodiscard]] StoredValues meta(const std::string& header) const {
    writeFile(path_, header);
    return metaStored(readTextHeader(path_, path_, TextFormat::kMeta), path_, path_);
  }
  template <class Work>
  void refuses(const Work& work, const std::string& reason, Error::Code code = Error::Code::kBadInput) const {
    expectRefusal([&] { static_cast<void>(work()); }, path_, reason, code);
  }
  // The values as numbers, after both checks.
  template <class T>
  [[nodiscard]] std::vector<double> read(const StoredValues& stored, ValueType type, std::size_t count) const {
    std::vector<T> values(count);
    const std::span<char> bytes(reinterpret_cast<char*>(values.data()), count * sizeof(T));
    readStored(checkedBySize(stored, static_cast<double>(bytes.size()), path_), type, bytes);
    return {values.begin(), values.end()};
  }
  [[nodiscard]] std::vector<double> readShorts(const StoredValues& stored, std::size_t count = 60) const {
    return read<std::int16_t>(stored, ValueType::kInt16, count);
  }

  TempFolder folder_;
  std::string path_ = folder_.file("a");
  std::vector<double> values_ = rampValues(-30);
  std::string data_ = bytesOf<std::int16_t>(values_);
};

TEST_F(Stored, FollowAPlainHeader) {
  const std::string header = nrrdHeader("int16", "raw", "# a comment\nkey:=value\nkey:=other\nsizes:=9 9 9\n");
  EXPECT_EQ(nrrd(header + "\n" + data_).parts[0].offset, header.size() + 1);
  EXPECT_EQ(readShorts(nrrd(header + "\n" + data_)), values_);
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT") + data_)), values_);
  const auto block = rawBlockOf(nrrd(header + "\n" + data_));
  ASSERT_TRUE(block);
  EXPECT_EQ(block->offset, header.size() + 1);
}

TEST_F(Stored, LieInAFileBeside) {
  writeFile(folder_.file("b.raw"), data_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "data file: b.raw\n"))), values_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "datafile: " + folder_.file("b.raw") + "\n"))), values_);
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT", "", "b.raw"))), values_);
}

TEST_F(Stored, LieInFilesOfAListOrAPattern) {
  for (int n = 0; n < 3; ++n) {
    writeFile(folder_.file("s" + std::to_string(8 + n)), data_.substr(static_cast<std::size_t>(n) * 40, 40));
    writeFile(folder_.file("p00" + std::to_string(n)), data_.substr(static_cast<std::size_t>(n) * 40, 40));
  }
  const std::string names = "s8\ns9\ns10\n";
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "data file: LIST\n") + names)), values_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "data file: LIST 2\n") + "s8\r\ns9\r\ns10")), values_);
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT", "", "LIST") + names + "\n")), values_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "data file: p%03d 0 2 1\n\n"))), values_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "data file: s%d 8 10 1\n\n"))), values_);
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT", "", "p%03d 0 2 1"))), values_);
}

TEST_F(Stored, OfAListAreAllThere) {
  for (const std::string name : {"s0", "s1", "s2"}) writeFile(folder_.file(name), data_.substr(0, 40));
  const auto list = [&](const std::string& names) {
    return [&, names] { return readShorts(meta(metaHeader("MET_SHORT", "", "LIST") + names)); };
  };
  refuses(list(""), "names none");
  refuses(list("\n\n"), "names none");
  refuses(list("s0\n\ns1\ns2\n"), "empty line");
  refuses(list("s0\ns1\ns7\n"), "s7 is not there", Error::Code::kNotFound);
  refuses(list("s0\ns1\n"), "60 bytes");          // one slice short: the others would have to be larger
  refuses(list("s0\ns1\ns2\ns2\n"), "30 bytes");  // one too many
  writeFile(folder_.file("s1"), data_.substr(0, 39));
  refuses(list("s0\ns1\ns2\n"), "cannot hold");
  writeFile(folder_.file("s1"), data_.substr(0, 41));
  refuses(list("s0\ns1\ns2\n"), "there are 41");
}

TEST_F(Stored, OfAPatternAreAllThere) {
  writeFile(folder_.file("p0"), data_);
  const auto pattern = [&](const std::string& text) {
    return [&, text] { return readShorts(meta(metaHeader("MET_SHORT", "", text))); };
  };
  refuses(pattern("p%d 0 1 1"), "p1 is not there", Error::Code::kNotFound);
  for (const std::string text :
       {"p%d", "p%d 0 1", "p%d 0 1 0", "p%d 1 0 1", "p%d x 1 1", "p%d 0 1 -1", "p%d 0 9999999999 1"}) {
    refuses(pattern(text), "from which number to which");
  }
  // An image of 5 x 4 x 3 voxels has 12 rows: so many files it may have.
  for (const std::string text : {"p%d 0 999999999 1", "p%d 0 12 1", "p%d 999999999 -999999999 -1"}) {
    refuses(pattern(text), "12 are the most");
  }
  for (const std::string text :
       {"p%s 0 0 1", "p%n 0 0 1", "p%d%d 0 0 1", "p% 0 0 1", "p%9999d 0 0 1", "data.raw 0 0 1 %"}) {
    refuses(pattern(text), "no name with one %d");
  }
}

// INT64_MIN / -1 is no number (it ended the program), and beyond INT64_MAX counting goes on for ever.
TEST_F(Stored, OfAPatternHaveNumbersThatCanBeCounted) {
  for (const std::string text :
       {"a%d.raw 0 -9223372036854775808 -1", "a%d.raw 9223372036854775806 9223372036854775807 5",
        "a%d.raw -9223372036854775807 9223372036854775807 9223372036854775807", "a%d.raw 0 1 -9223372036854775808",
        "a%d.raw 0 99999999999999999999 1"}) {
    refuses([&] { return meta(metaHeader("MET_SHORT", "", text)); }, "from which number to which");
    refuses([&] { return nrrd(nrrdHeader("int16", "raw", "data file: " + text + "\n")); },
            "from which number to which");
  }
}

TEST_F(Stored, OfAListAreNoMoreThanRows) {
  std::string names;
  for (int n = 0; n < 13; ++n) names += "s\n";
  refuses([&] { return meta(metaHeader("MET_SHORT", "", "LIST") + names); }, "more than 12 files");
}

TEST_F(Stored, SkipLinesAndBytes) {
  writeFile(folder_.file("b"), "one\ntwo\nxy" + data_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "line skip: 2\nbyte skip: 2\ndata file: b\n"))), values_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "raw", "byte skip: -1\ndata file: b\n"))), values_);
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT", "HeaderSize = 10\n", "b"))), values_);
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT", "HeaderSize = -1\n", "b"))), values_);
  writeGzip(folder_.file("b"), "xy" + data_);
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "gzip", "byteskip: 2\ndata file: b\n"))), values_);
  for (const std::string skip : {"byte skip: -2", "line skip: -1", "line skip: x", "byte skip: 1e30", "line skip: 9"}) {
    EXPECT_THROW(static_cast<void>(nrrd(nrrdHeader("int16", "raw", skip + "\ndata file: b\n"))), Error) << skip;
  }
  EXPECT_THROW(static_cast<void>(nrrd(nrrdHeader("int16", "gzip", "byte skip: -1\ndata file: b\n"))), Error);
}

TEST_F(Stored, AreTurnedFromTheOtherByteOrder) {
  std::string header = nrrdHeader("int16", "raw");
  header.replace(header.find("little"), 6, "big");
  EXPECT_EQ(readShorts(nrrd(header + "\n" + bytesOf<std::int16_t>(values_, true))), values_);
  header = metaHeader("MET_SHORT", "ElementByteOrderMSB = True\n");
  refuses([&] { return meta(header); }, "contradict");
  header.erase(header.find("BinaryDataByteOrderMSB"), std::string("BinaryDataByteOrderMSB = False\n").size());
  EXPECT_EQ(readShorts(meta(header + bytesOf<std::int16_t>(values_, true))), values_);
  header = nrrdHeader("int16", "raw");
  header.erase(header.find("endian: little\n"), 15);
  refuses([&] { return nrrd(header + "\n" + data_); }, "neither little nor big");
  EXPECT_EQ((read<std::uint8_t>(nrrd(header + "\n" + bytesOf<std::uint8_t>(rampValues()), 1), ValueType::kUint8, 60)),
            rampValues());  // a byte has no order
}

TEST_F(Stored, AsTextAreReadToTheLast) {
  const std::string header = nrrdHeader("int16", "text") + "\n";
  EXPECT_EQ(readShorts(nrrd(header + "1 -2\t+3,\r\n 4\n"), 4), (std::vector<double>{1, -2, 3, 4}));
  EXPECT_EQ((read<float>(nrrd(header + "1.5 -2e3"), ValueType::kFloat32, 2)), (std::vector<double>{1.5, -2000}));
  EXPECT_EQ(readShorts(meta(metaHeader("MET_SHORT", "BinaryData = False\n").replace(29, 18, "") + "5 6"), 2),
            (std::vector<double>{5, 6}));
  const auto fails = [&](const std::string& text, const std::string& why) {
    try {
      static_cast<void>(readShorts(nrrd(header + text), 4));
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(why)) << text;
    }
  };
  fails("1 2 3", "fewer voxels");
  fails("1 2 3 4 5", "more voxels");
  fails("1 2 x 4", "\"x\"");
  fails("1 2 3.5 4", "\"3.5\"");
  fails("1 2 70000 4", "\"70000\"");
  fails("1 2 3 4x", "\"4x\"");
}

TEST_F(Stored, PackedAreAsManyAsTheHeaderSays) {
  writeGzip(folder_.file("gz"), data_);
  const std::string packed = readFile(folder_.file("gz"));
  const auto header = [&](const std::string& size) {
    std::string text = metaHeader("MET_SHORT", size);
    return text.replace(text.find("CompressedData = False"), 22, "CompressedData = True");
  };
  const std::string right = fmt::format("CompressedDataSize = {}\n", packed.size());
  EXPECT_EQ(readShorts(meta(header(right) + packed)), values_);
  EXPECT_EQ(readShorts(meta(header("") + packed)), values_);  // unknown: all that follows
  for (const int more : {-1, 1}) {
    const std::string wrong = fmt::format("CompressedDataSize = {}\n", packed.size() + static_cast<std::size_t>(more));
    refuses([&] { return readShorts(meta(header(wrong) + packed)); }, "are packed into");
  }
  refuses([&] { return meta(header("CompressedDataSize = -5\n") + packed); }, "no count");
  refuses([&] { return meta(header("CompressedDataSize = x\n") + packed); }, "no whole number");
  for (const std::size_t count : {59U, 61U}) {
    EXPECT_THROW(static_cast<void>(readShorts(meta(header(right) + packed), count)), std::runtime_error) << count;
  }
}

TEST_F(Stored, FromAHeaderWithAFaultAreRefused) {
  for (const std::string more : {"encoding: raw\n", "what is this\n"}) {
    refuses([&] { return nrrd(nrrdHeader("int16", "raw", more) + "\n" + data_); }, "cannot be relied on");
  }
  refuses([&] { return nrrd(nrrdHeader("int16", "raw")); }, "it has no end");
  for (const std::string more : {"DimSize = 5 4 3\n", "\n", "words\n"}) {
    refuses([&] { return meta(metaHeader("MET_SHORT", more) + data_); }, "cannot be relied on");
  }
  const std::string whole = metaHeader("MET_SHORT");
  refuses([&] { return meta(whole.substr(0, whole.find("ElementDataFile"))); }, "it has no end");
}

TEST_F(Stored, InHexAreReadToTheLastDigit) {
  const std::string header = nrrdHeader("int16", "hex") + "\n";
  EXPECT_EQ(readShorts(nrrd(header + "0100fEfF\n 03\t0\r\n0 00 80 \n"), 4), (std::vector<double>{1, -2, 3, -32768}));
  std::string big = header;
  big.replace(big.find("little"), 6, "big");
  EXPECT_EQ(readShorts(nrrd(big + "0001fffe"), 2), (std::vector<double>{1, -2}));
  writeFile(folder_.file("a.hex"), "xy01 00");
  EXPECT_EQ(readShorts(nrrd(nrrdHeader("int16", "hex", "byte skip: 2\ndata file: a.hex\n")), 1),
            (std::vector<double>{1}));
  const auto fails = [&](const std::string& text, const std::string& why) {
    try {
      static_cast<void>(readShorts(nrrd(header + text), 2));
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(why)) << text;
    }
  };
  fails("010002", "cannot hold");
  fails("0100020 ", "fewer voxels");
  fails("01000200f", "more voxels");
  fails("01000200ff", "more voxels");
  fails("0100020g", "no hexadecimal digit");
  fails("0x010002", "no hexadecimal digit");
  fails("01,000200", "no hexadecimal digit");
  refuses([&] { return nrrd(nrrdHeader("int16", "hex", "byte skip: -1\ndata file: a.hex\n")); }, "not raw");
}

TEST_F(Stored, InAnEncodingThatNobodyReadsAreRefused) {
  for (const std::string encoding : {"bzip2", "bz2", "gzipped", ""}) {
    refuses([&] { return nrrd(nrrdHeader("int16", encoding) + "\n" + data_); }, "cannot be read");
  }
}

}  // namespace stored_values_test
}  // namespace palpate
