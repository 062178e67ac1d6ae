// SPDX-License-Identifier: Apache-2.0
// The test image (files.hpp) as bytes of each format, made without the libraries that read them.
#pragma once

#include <utility>

#include <archive.h>
#include <archive_entry.h>

#include "tests/engine/files/files.hpp"
#include "tests/engine/files/itk_writer.hpp"

namespace palpate {

// --- gzip and tar, by libarchive ------------------------------------------------------------------------------------

inline void writeGzip(const std::string& path, const std::string& bytes) {
  archive* out = archive_write_new();
  archive_write_set_format_raw(out);
  archive_write_add_filter_gzip(out);
  archive_write_open_filename(out, path.c_str());
  archive_entry* entry = archive_entry_new();
  archive_entry_set_filetype(entry, AE_IFREG);
  archive_write_header(out, entry);
  archive_write_data(out, bytes.data(), bytes.size());
  archive_entry_free(entry);
  archive_write_close(out);
  archive_write_free(out);
}

// A bare deflate stream: what gzip has between its header of 10 bytes and its trailer of 8.
inline std::string deflated(const std::string& bytes) {
  const TempFolder folder;
  writeGzip(folder.file("gz"), bytes);
  const std::string packed = readFile(folder.file("gz"));
  return packed.substr(10, packed.size() - 18);
}

using Members = std::vector<std::pair<std::string, std::string>>;  // name, bytes

inline void writeTarGz(const std::string& path, const Members& members) {
  archive* out = archive_write_new();
  archive_write_set_format_ustar(out);
  archive_write_add_filter_gzip(out);
  archive_write_open_filename(out, path.c_str());
  for (const auto& [name, bytes] : members) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_write_header(out, entry);
    archive_write_data(out, bytes.data(), bytes.size());
    archive_entry_free(entry);
  }
  archive_write_close(out);
  archive_write_free(out);
}

// --- NRRD -----------------------------------------------------------------------------------------------------------

inline std::string nrrdHeader(const std::string& type, const std::string& encoding, const std::string& more = "",
                              const std::string& geometry = "spacings: 0.5 0.75 2\n") {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 5 4 3\n" + geometry +
         "endian: little\nencoding: " + encoding + "\n" + more;
}

// --- NIfTI-1 --------------------------------------------------------------------------------------------------------

struct NiftiFields {
  std::vector<int> dim = {3, 5, 4, 3, 1, 1, 1, 1};
  int datatype = 4;  // int16
  int bits = 16;
  std::vector<float> pixdim = {1, 0.5F, 0.75F, 2, 1, 1, 1, 1};
  float slope = 0;
  float intercept = 0;
  int units = 2;  // millimetres
  int qform_code = 1;
  int sform_code = 0;
  std::vector<float> quaternion = {0, 0, 0};  // b, c, d
  std::vector<float> offset = {0, 0, 0};      // RAS [units]
  std::vector<float> sform = std::vector<float>(12, 0.0F);
  bool big_endian = false;
  bool one_file = true;
};

inline void overwrite(std::string& bytes, std::size_t offset, const std::string& with) {
  std::copy(with.begin(), with.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
}

inline std::string niftiHeader(const NiftiFields& fields) {
  std::string bytes(352, '\0');
  const auto put = [&](std::size_t offset, auto value) {
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    if (fields.big_endian) std::reverse(raw.begin(), raw.end());
    overwrite(bytes, offset, raw);
  };
  put(0, std::int32_t{348});
  for (std::size_t n = 0; n < 8; ++n) put(40 + 2 * n, static_cast<std::int16_t>(fields.dim[n]));
  put(70, static_cast<std::int16_t>(fields.datatype));
  put(72, static_cast<std::int16_t>(fields.bits));
  for (std::size_t n = 0; n < 8; ++n) put(76 + 4 * n, fields.pixdim[n]);
  put(108, fields.one_file ? 352.0F : 0.0F);
  put(112, fields.slope);
  put(116, fields.intercept);
  bytes[123] = static_cast<char>(fields.units);
  put(252, static_cast<std::int16_t>(fields.qform_code));
  put(254, static_cast<std::int16_t>(fields.sform_code));
  for (std::size_t n = 0; n < 3; ++n) put(256 + 4 * n, fields.quaternion[n]);
  for (std::size_t n = 0; n < 3; ++n) put(268 + 4 * n, fields.offset[n]);
  for (std::size_t n = 0; n < 12; ++n) put(280 + 4 * n, fields.sform[n]);
  overwrite(bytes, 344, fields.one_file ? std::string("n+1\0", 4) : std::string("ni1\0", 4));
  if (!fields.one_file) bytes.resize(348);
  return bytes;
}

// --- MetaImage ------------------------------------------------------------------------------------------------------

inline std::string metaHeader(const std::string& type, const std::string& geometry = "ElementSpacing = 0.5 0.75 2\n",
                              const std::string& data_file = "LOCAL", const std::string& size = "5 4 3") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n" +
         geometry + "DimSize = " + size + "\nElementType = " + type + "\nElementDataFile = " + data_file + "\n";
}

// --- DICOM, explicit VR ---------------------------------------------------------------------------------------------

inline constexpr const char* kLittleEndianDicom = "1.2.840.10008.1.2.1";
inline constexpr const char* kBigEndianDicom = "1.2.840.10008.1.2.2";
inline constexpr const char* kDeflatedDicom = "1.2.840.10008.1.2.1.99";

struct DicomFields {
  std::string syntax = kLittleEndianDicom;
  std::string series = "1.2.3.4.5";
  std::string sop = "1.2.3.4.5.1";
  std::string position = "0\\0\\0";
  std::string orientation = "1\\0\\0\\0\\1\\0";
  std::string pixel_spacing = "0.75\\0.5";  // between rows, then between columns
  std::string slope = "2";
  std::string intercept = "-100";
  int rows = 4;
  int columns = 5;
  int samples = 1;
  std::string frames;                  // empty: no such element
  std::string description;             // of the series; empty: no such element
  std::string spacing_between_slices;  // empty: no such element
  std::vector<double> pixels;          // stored values, int16
};

inline std::string dicomElement(int group, int element, const std::string& vr, std::string value,
                                bool big_endian = false) {
  if (value.size() % 2 != 0) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
  const auto length = static_cast<double>(value.size());
  std::string bytes =
      bytesOf<std::uint16_t>({static_cast<double>(group), static_cast<double>(element)}, big_endian) + vr;
  if (vr == "OW" || vr == "OB") {
    bytes += std::string(2, '\0') + bytesOf<std::uint32_t>({length}, big_endian);
  } else {
    bytes += bytesOf<std::uint16_t>({length}, big_endian);
  }
  return bytes + value;
}

// What precedes the data set; always little-endian.
inline std::string dicomHead(const DicomFields& fields) {
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2";
  const std::string meta = dicomElement(2, 0x0001, "OB", std::string("\0\1", 2)) + dicomElement(2, 0x0002, "UI", ct) +
                           dicomElement(2, 0x0003, "UI", fields.sop) + dicomElement(2, 0x0010, "UI", fields.syntax) +
                           dicomElement(2, 0x0012, "UI", "1.2.3");
  return std::string(128, '\0') + "DICM" +
         dicomElement(2, 0, "UL", bytesOf<std::uint32_t>({static_cast<double>(meta.size())})) + meta;
}

inline std::string dicomBytes(const DicomFields& fields) {
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2";
  const bool big_endian = fields.syntax == kBigEndianDicom;
  const auto us = [&](int value) { return bytesOf<std::uint16_t>({static_cast<double>(value)}, big_endian); };
  const auto element = [&](int group, int number, const std::string& vr, const std::string& value) {
    return dicomElement(group, number, vr, value, big_endian);
  };
  std::string set;
  set += element(0x0008, 0x0016, "UI", ct);
  set += element(0x0008, 0x0018, "UI", fields.sop);
  set += element(0x0008, 0x0060, "CS", "CT");
  if (!fields.description.empty()) set += element(0x0008, 0x103e, "LO", fields.description);
  set += element(0x0018, 0x0050, "DS", "9");  // slice thickness: must not be taken for the spacing
  if (!fields.spacing_between_slices.empty()) {
    set += element(0x0018, 0x0088, "DS", fields.spacing_between_slices);
  }
  set += element(0x0020, 0x000d, "UI", "1.2.3.4");
  set += element(0x0020, 0x000e, "UI", fields.series);
  if (!fields.position.empty()) set += element(0x0020, 0x0032, "DS", fields.position);
  set += element(0x0020, 0x0037, "DS", fields.orientation);
  set += element(0x0028, 0x0002, "US", us(fields.samples));
  set += element(0x0028, 0x0004, "CS", fields.samples == 1 ? "MONOCHROME2" : "RGB");
  if (fields.samples != 1) set += element(0x0028, 0x0006, "US", us(0));
  if (!fields.frames.empty()) set += element(0x0028, 0x0008, "IS", fields.frames);
  set += element(0x0028, 0x0010, "US", us(fields.rows));
  set += element(0x0028, 0x0011, "US", us(fields.columns));
  if (!fields.pixel_spacing.empty()) set += element(0x0028, 0x0030, "DS", fields.pixel_spacing);
  set += element(0x0028, 0x0100, "US", us(16));
  set += element(0x0028, 0x0101, "US", us(16));
  set += element(0x0028, 0x0102, "US", us(15));
  set += element(0x0028, 0x0103, "US", us(1));
  set += element(0x0028, 0x1052, "DS", fields.intercept);
  set += element(0x0028, 0x1053, "DS", fields.slope);
  set += element(0x7fe0, 0x0010, "OW", bytesOf<std::int16_t>(fields.pixels, big_endian));
  return dicomHead(fields) + (fields.syntax == kDeflatedDicom ? deflated(set) : set);
}

// --- InVesalius -----------------------------------------------------------------------------------------------------

inline std::string invesaliusPlist(
    const std::string& shape = "<integer>3</integer><integer>4</integer><integer>5</integer>",
    const std::string& type = "int16",
    const std::string& spacing = "<real>0.5</real><real>0.75</real><real>2.0</real>") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<plist version=\"1.0\"><dict><key>matrix</key><dict>"
         "<key>dtype</key><string>" +
         type +
         "</string><key>filename</key><string>matrix.dat</string>"
         "<key>shape</key><array>" +
         shape + "</array></dict><key>spacing</key><array>" + spacing + "</array></dict></plist>\n";
}

// --- by ITK ---------------------------------------------------------------------------------------------------------

inline ItkImage itkImageOf(const Lattice& lattice, const std::vector<double>& values) {
  ItkImage image;
  image.size = {5, 4, 3};
  for (int axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<std::size_t>(axis);
    image.origin_mm[n] = lattice.origin_W[axis] * 1e3;
    image.spacing_mm[n] = lattice.spacing_m[axis] * 1e3;
    for (int row = 0; row < 3; ++row) image.direction[n][static_cast<std::size_t>(row)] = lattice.R_WL(row, axis);
  }
  for (const double value : values) image.values.push_back(static_cast<std::int16_t>(value));
  return image;
}

// --- one file, written and loaded again and again ------------------------------------------------------------------

class OneFile : public testing::Test {
 protected:
  explicit OneFile(const char* name) : path_(folder_.file(name)) {}
  [[nodiscard]] Volume load(const std::string& bytes) const {
    writeFile(path_, bytes);
    return loadVolume(path_);
  }
  void refuses(const std::string& bytes, const std::string& reason, Error::Code code = Error::Code::kBadInput) const {
    writeFile(path_, bytes);
    expectLoadRefusal(path_, reason, code);
  }

  TempFolder folder_;
  std::string path_;
  std::string data_ = bytesOf<std::int16_t>(rampValues(-30));
};

}  // namespace palpate
