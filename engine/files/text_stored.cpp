// SPDX-License-Identifier: Apache-2.0
#include "engine/files/text_stored.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr bool kLittleEndian = std::endian::native == std::endian::little;
constexpr std::size_t kMostFiles = 100'000;
constexpr std::int64_t kMostNumber = 1'000'000'000;  // the largest number in a file's name

void checkHeader(const TextHeader& header, const std::string& source) {
  if (!header.fault.empty()) refuseDamaged(source, fmt::format("its header cannot be relied on: {}", header.fault));
}

std::string beside(const std::string& path, const std::string& name) {
  return (fs::path(path).parent_path() / name).string();
}

// The whole number in a field, or `otherwise` if the field is missing.
std::int64_t wholeNumber(const TextHeader& header, const std::string& key, std::int64_t otherwise,
                         const std::string& source) {
  if (!header.fields.contains(key)) return otherwise;
  const std::vector<double> numbers = header.numbers(key);
  if (numbers.size() == 1 && std::abs(numbers[0]) < 1e15 && numbers[0] == std::floor(numbers[0])) {
    return static_cast<std::int64_t>(numbers[0]);
  }
  refuseDamaged(source, fmt::format("its {} \"{}\" is no whole number", key, header.text(key)));
}

bool isTrue(const TextHeader& header, const std::string& key) {
  const std::string value = lowerCase(header.text(key));
  return value == "true" || value == "1" || value == "t" || value == "yes";
}

// --- names of several files -----------------------------------------------------------------------------------------

// There cannot be more files than rows of voxels. `sizes_key`: the header's field of sizes; the first is that of a row.
std::size_t mostFiles(const TextHeader& header, const std::string& sizes_key) {
  const std::vector<double> sizes = header.numbers(sizes_key);
  double rows = 1;
  for (std::size_t axis = 1; axis < sizes.size(); ++axis) rows *= sizes[axis];
  return rows >= 1 && rows < static_cast<double>(kMostFiles) ? static_cast<std::size_t>(rows) : kMostFiles;
}

// The file names in the lines from `offset` on. An empty line before another name is damage; empty lines at the end are
// not.
std::vector<StoredPart> partsOfList(const std::string& path, std::uint64_t offset, std::size_t most_files,
                                    const std::string& source) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  std::vector<StoredPart> parts;
  bool was_empty = false;
  for (std::string line; std::getline(file, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t')) line.pop_back();
    if (!line.empty() && was_empty) refuseDamaged(source, "its list of files has an empty line");
    was_empty = line.empty();
    if (!line.empty()) parts.push_back({beside(path, line), 0});
    if (parts.size() > most_files) refuseDamaged(source, fmt::format("its list names more than {} files", most_files));
  }
  if (parts.empty()) refuseDamaged(source, "its list of files names none");
  return parts;
}

// "a%03d.raw" with 7 is "a007.raw". A pattern must have exactly one such number.
std::string numbered(const std::string& pattern, std::int64_t number, const std::string& source) {
  const std::size_t percent = std::min(pattern.find('%'), pattern.size());
  std::size_t at = percent + 1;
  const bool zeros = at < pattern.size() && pattern[at] == '0';
  int width = 0;
  for (; at < pattern.size() && std::isdigit(static_cast<unsigned char>(pattern[at])) != 0 && width < 100; ++at) {
    width = 10 * width + (pattern[at] - '0');
  }
  const bool is_number = at < pattern.size() && (pattern[at] == 'd' || pattern[at] == 'i' || pattern[at] == 'u');
  if (!is_number || width >= 100 || pattern.find('%', at) != std::string::npos) {
    refuseDamaged(source, fmt::format("its pattern of file names \"{}\" is no name with one %d", pattern));
  }
  const std::string digits = zeros ? fmt::format("{:0{}}", number, width) : fmt::format("{:{}}", number, width);
  return pattern.substr(0, percent) + digits + pattern.substr(at + 1);
}

bool isFileNumber(std::int64_t number) {
  return number >= -kMostNumber && number <= kMostNumber;
}

// "a%03d.raw 1 40 1": from, to, step. The dimension of each file may follow; it is known already.
std::vector<StoredPart> partsOfPattern(const std::string& text, const std::string& path, std::size_t most_files,
                                       const std::string& source) {
  std::istringstream words(text);
  std::string pattern;
  std::int64_t from = 0, to = 0, step = 0;
  words >> pattern >> from >> to >> step;
  const bool are_numbers = words && isFileNumber(from) && isFileNumber(to) && isFileNumber(step);
  if (!are_numbers || step == 0 || (to > from && step < 0) || (to < from && step > 0)) {
    refuseDamaged(source,
                  fmt::format("its pattern of file names \"{}\" does not say from which number to which", text));
  }
  const std::int64_t count = (to - from) / step + 1;
  if (count > static_cast<std::int64_t>(most_files)) {
    refuseDamaged(source,
                  fmt::format("its pattern \"{}\" names {} files, and {} are the most", text, count, most_files));
  }
  std::vector<StoredPart> parts;
  for (std::int64_t n = 0; n < count; ++n) {
    parts.push_back({beside(path, numbered(pattern, from + n * step, source)), 0});
  }
  return parts;
}

// The names of several data files; empty if `text` is the name of a single file.
std::vector<StoredPart> severalParts(const std::string& text, const TextHeader& header, const std::string& sizes_key,
                                     const std::string& path, const std::string& source) {
  const std::size_t most_files = mostFiles(header, sizes_key);
  if (text.starts_with("LIST")) return partsOfList(path, header.data_offset, most_files, source);
  if (text.find('%') != std::string::npos) return partsOfPattern(text, path, most_files, source);
  return {};
}

void checkFiles(const StoredValues& values, const std::string& source) {
  for (const StoredPart& part : values.parts) static_cast<void>(fileBytes(part.path, source));
}

// --- NRRD -----------------------------------------------------------------------------------------------------------

void applyEncoding(const std::string& encoding, StoredValues& values, const std::string& source) {
  if (encoding == "raw") return;
  if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    values.coding = Coding::kWords;
  } else if (encoding == "hex") {
    values.coding = Coding::kHex;
  } else if (encoding == "gzip" || encoding == "gz") {
    values.packing = Packing::kGzip;
  } else {
    throw Error(Error::Code::kBadInput, source, fmt::format("its encoding \"{}\" cannot be read", encoding),
                "write it raw or with gzip");
  }
}

// The offset of the data behind `lines` lines.
std::uint64_t afterLines(const StoredPart& part, std::int64_t lines, const std::string& source) {
  std::ifstream file(part.path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(part.offset));
  std::string line;
  for (std::int64_t n = 0; n < lines; ++n) {
    if (!std::getline(file, line) || file.eof())
      refuseDamaged(source, "its data end within the lines that are to be skipped");
  }
  return lines > 0 ? static_cast<std::uint64_t>(file.tellg()) : part.offset;
}

std::int64_t eitherKey(const TextHeader& header, const char* key, const char* other, const std::string& source) {
  return wholeNumber(header, header.fields.contains(key) ? key : other, 0, source);
}

void applySkips(const TextHeader& header, StoredValues& values, const std::string& source) {
  const std::int64_t lines = eitherKey(header, "line skip", "lineskip", source);
  const std::int64_t bytes = eitherKey(header, "byte skip", "byteskip", source);
  if (lines < 0 || bytes < -1) refuseDamaged(source, "its line skip or byte skip is negative");
  if (bytes == -1 && (values.packing != Packing::kNone || values.coding != Coding::kBinary)) {
    refuseDamaged(source, "its byte skip is -1, and its data are not raw");
  }
  for (StoredPart& part : values.parts) part.offset = afterLines(part, lines, source);
  values.from_end = bytes == -1;
  values.skip_bytes = static_cast<std::uint64_t>(std::max<std::int64_t>(bytes, 0));
}

// --- MetaImage ------------------------------------------------------------------------------------------------------

bool isBigEndian(const TextHeader& header, const std::string& source) {
  const char* const keys[] = {"binarydatabyteordermsb", "elementbyteordermsb"};
  if (header.fields.contains(keys[0]) && header.fields.contains(keys[1]) &&
      isTrue(header, keys[0]) != isTrue(header, keys[1])) {
    refuseDamaged(source, "its BinaryDataByteOrderMSB and ElementByteOrderMSB contradict each other");
  }
  return isTrue(header, keys[0]) || isTrue(header, keys[1]);
}

}  // namespace

StoredValues nrrdStored(const TextHeader& header, const std::string& path, std::size_t value_bytes,
                        const std::string& source) {
  checkHeader(header, source);
  StoredValues values;
  applyEncoding(lowerCase(header.text("encoding")), values, source);
  const std::string endian = lowerCase(header.text("endian"));
  if (values.coding != Coding::kWords && value_bytes > 1 && endian != "little" && endian != "big") {
    refuseDamaged(source, fmt::format("its endian \"{}\" is neither little nor big", endian));
  }
  values.swapped = value_bytes > 1 && (endian == "little") != kLittleEndian;
  const std::string data = header.text(header.fields.contains("data file") ? "data file" : "datafile");
  values.parts = severalParts(data, header, "sizes", path, source);
  if (values.parts.empty()) {
    values.parts = {data.empty() ? StoredPart{path, header.data_offset} : StoredPart{beside(path, data), 0}};
  }
  checkFiles(values, source);
  applySkips(header, values, source);
  return values;
}

StoredValues metaStored(const TextHeader& header, const std::string& path, const std::string& source) {
  checkHeader(header, source);
  const std::string data = header.text("elementdatafile");
  if (data.empty()) refuseDamaged(source, "its header has no ElementDataFile");
  StoredValues values;
  values.parts = severalParts(data, header, "dimsize", path, source);
  if (values.parts.empty()) {
    values.parts = {lowerCase(data) == "local" ? StoredPart{path, header.data_offset}
                                               : StoredPart{beside(path, data), 0}};
  }
  checkFiles(values, source);
  if (header.fields.contains("binarydata") && !isTrue(header, "binarydata")) values.coding = Coding::kWords;
  values.swapped = isBigEndian(header, source) == kLittleEndian;
  if (isTrue(header, "compresseddata")) values.packing = Packing::kZlib;
  const std::int64_t packed = wholeNumber(header, "compresseddatasize", 0, source);
  const std::int64_t skipped = wholeNumber(header, "headersize", 0, source);
  if (packed < 0 || skipped < -1) refuseDamaged(source, "its CompressedDataSize or HeaderSize is no count of bytes");
  if (values.packing != Packing::kNone && packed > 0) values.packed_bytes = static_cast<std::uint64_t>(packed);
  if (skipped > 0) {
    for (StoredPart& part : values.parts) part.offset = static_cast<std::uint64_t>(skipped);
  }
  if (skipped == -1 && values.packing != Packing::kNone)
    refuseDamaged(source, "its HeaderSize is -1, and its data are packed");
  values.from_end = skipped == -1;
  return values;
}

}  // namespace palpate
