// SPDX-License-Identifier: Apache-2.0
#include "tests/damage/whole_files.hpp"

#include <fmt/format.h>

#include "apps/mesh/mesh_writer.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/damage/vdb_grids.hpp"
#include "tests/engine/files/dicom_writer.hpp"
#include "tests/engine/files/packed_dicom.hpp"
#include "tests/engine/files/samples.hpp"

namespace palpate::damage {
namespace {

// A small sphere with noise: its values differ, so that bricks are stored and streams are not all zeros.
Volume sample() {
  return loadVolume("phantom:sphere?size=20&spacing=1mm&noise=0.1&seed=3");
}

std::string in(const std::string& folder, const std::string& name) {
  return folder + "/" + name;
}

std::vector<double> shorts() {
  std::vector<double> values;
  std::uint32_t random = 5;
  for (int n = 0; n < 60; ++n) values.push_back(static_cast<double>((random = random * 1664525U + 1013904223U) >> 22));
  return values;
}

std::string data() {
  return bytesOf<std::int16_t>(shorts());
}

std::string gzipped(const std::string& folder, const std::string& bytes) {
  writeGzip(in(folder, "gz.tmp"), bytes);
  std::string packed = readFile(in(folder, "gz.tmp"));
  std::filesystem::remove(in(folder, "gz.tmp"));
  return packed;
}

void writeSlices(const std::string& folder) {
  for (int n = 0; n < 3; ++n) {
    writeFile(in(folder, fmt::format("s{}.raw", n)), data().substr(static_cast<std::size_t>(n) * 40, 40));
  }
}

std::string hexOf(const std::string& bytes) {
  std::string digits;
  for (const char c : bytes) digits += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return digits;
}

// Replaces `word`, which occurs once, by `with`.
std::string replaced(std::string text, const std::string& word, const std::string& with) {
  return text.replace(text.find(word), word.size(), with);
}

std::string dicomSlice(int n, const std::string& syntax) {
  const std::vector<double> values = shorts();
  DicomFields fields;
  fields.syntax = syntax;
  fields.position = fmt::format("0\\0\\{}", 2 * n);
  fields.sop += std::to_string(n);
  fields.pixels = std::vector<double>(values.begin() + 20 * n, values.begin() + 20 * n + 20);
  return dicomBytes(fields);
}

// `values`: number of bytes at the end that do not belong to the header.
WholeFile dicom(const std::string& name, const std::string& syntax, std::size_t values) {
  return {name,
          "s1.dcm",
          "",
          false,
          false,
          ':',
          {.length = true},
          dicomSlice(1, syntax).size() - values,
          [syntax](const std::string& f) {
            for (int n = 0; n < 3; ++n) writeFile(in(f, fmt::format("s{}.dcm", n)), dicomSlice(n, syntax));
          }};
}

// The same series with packed pixels. Damage goes into the packed frame.
WholeFile packedDicomFile(const std::string& name, DicomPacking packing) {
  const auto slice = [packing](int n) {
    std::uint32_t random = 5;
    DicomFields fields;
    fields.rows = fields.columns = 32;
    fields.position = fmt::format("0\\0\\{}", 2 * n);
    fields.sop += std::to_string(n);
    for (int p = 0; p < 32 * 32; ++p)
      fields.pixels.push_back(p % 32 * 20 + static_cast<int>((random = random * 1664525U + 1013904223U) >> 27U));
    return packedDicom(dicomBytes(fields), packing);
  };
  const std::string one = slice(1);
  return {
      name, "s1.dcm", "", false, false, ':', {.length = true}, fragmentOf(one).first, [slice](const std::string& f) {
        for (int n = 0; n < 3; ++n) writeFile(in(f, fmt::format("s{}.dcm", n)), slice(n));
      }};
}

// Three frames in one file, which says of each where it lies.
std::string dicomFrames() {
  WrittenImage image;
  image.rows = 4;
  image.columns = 5;
  for (const double value : shorts()) image.words.push_back(static_cast<std::int64_t>(value));
  WrittenItem set = imageSet(image);
  set[0x00280008] = textOf("IS", "3");
  WrittenItem shared;
  addOrientation(shared);
  addMeasures(shared);
  addTransformation(shared, "2", "-100");
  std::vector<WrittenItem> frames(3);
  for (std::size_t n = 0; n < frames.size(); ++n) addPosition(frames[n], fmt::format("0\\0\\{}", 2 * n));
  set[0x52009229] = itemsOf({shared});
  set[0x52009230] = itemsOf(frames);
  return DicomWriter(kLittleEndianDicom).file(set);
}

// A slice file that a list names: it holds values and nothing else.
WholeFile listedFile(const std::string& name, const std::string& header, const std::string& text) {
  WholeFile slice;
  slice.name = name;
  slice.damaged = "s1.raw";
  slice.loaded = header;
  slice.promise.length = true;
  slice.has_header = false;
  slice.write = [=](const std::string& f) {
    writeSlices(f);
    writeFile(in(f, header), text + "s0.raw\ns1.raw\ns2.raw\n");
  };
  return slice;
}

// Length of the deflated part: all of the file but its head.
std::size_t deflatedBytes() {
  DicomFields fields;
  fields.syntax = kDeflatedDicom;
  fields.sop += "1";
  return dicomSlice(1, kDeflatedDicom).size() - dicomHead(fields).size();
}

void writeMeshTo(const std::string& path) {
  const TriangleMesh mesh = isosurfaceMesh(loadVolume("phantom:sphere?size=12&spacing=1mm"), 0, 0);
  std::string bytes;
  writeMesh(mesh, path, 1000, [&](std::string_view piece) { bytes += piece; });
  writeFile(path, bytes);
}

std::string plyText() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n12.5 0 0\n0 12.5 0\n0 0 12.5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
}

std::string stlText() {
  std::string text = "solid tetrahedron\n";
  for (const char* const corners :
       {"0 0 0\nvertex 0 12.5 0\nvertex 12.5 0 0", "0 0 0\nvertex 12.5 0 0\nvertex 0 0 12.5",
        "0 0 0\nvertex 0 0 12.5\nvertex 0 12.5 0", "12.5 0 0\nvertex 0 12.5 0\nvertex 0 0 12.5"}) {
    text += fmt::format("facet normal 0 0 0\nouter loop\nvertex {}\nendloop\nendfacet\n", corners);
  }
  return text + "endsolid tetrahedron\n";
}

std::size_t after(const std::string& bytes, const std::string& mark) {
  const std::size_t at = bytes.find(mark);
  return at == std::string::npos ? 0 : at + mark.size();
}

WholeFile nrrd(const std::string& name, const std::string& encoding,
               const std::function<std::string(const std::string&)>& values, Promise promise,
               const std::string& endian = "little") {
  promise.lines_once = true;
  const std::string header = replaced(nrrdHeader("int16", encoding), "little", endian) + "\n";
  return {name,    "a.nrrd",      "a.nrrd",
          false,   true,          ':',
          promise, header.size(), [=](const std::string& f) { writeFile(in(f, "a.nrrd"), header + values(f)); }};
}

WholeFile saved(const std::string& name, const std::string& file, Promise promise, std::size_t header_bytes) {
  return {name,    file,         file,
          false,   false,        ':',
          promise, header_bytes, [file](const std::string& f) { saveVolume(sample(), in(f, file)); }};
}

std::vector<WholeFile> volumes() {
  const Promise length = {.length = true};
  const Promise all = {.header = true, .values = true, .length = true};
  const Promise values = {.values = true, .length = true};
  Promise meta = length, packed_meta = values;
  meta.lines_once = packed_meta.lines_once = true;
  Promise own = all;
  own.can_be_lost = true;
  const std::string list_nrrd = nrrdHeader("int16", "raw", "data file: LIST\n");
  const std::string list_meta = metaHeader("MET_SHORT", "ElementSpacing = 0.5 0.75 2\n", "LIST");
  const std::string big_meta = replaced(metaHeader("MET_SHORT"), "MSB = False", "MSB = True");
  return {
      nrrd(
          "NRRD, raw", "raw", [](const std::string&) { return data(); }, length),
      nrrd(
          "NRRD, big-endian", "raw", [](const std::string&) { return bytesOf<std::int16_t>(shorts(), true); }, length,
          "big"),
      nrrd(
          "NRRD, hex", "hex", [](const std::string&) { return hexOf(data()); }, length),
      nrrd(
          "NRRD, gzip", "gzip", [](const std::string& f) { return gzipped(f, data()); }, values),
      nrrd("NRRD, text", "text",
           [](const std::string&) {
             std::string text;
             for (const double value : shorts()) text += fmt::format("{}\n", value);
             return text;
           },
           {}),
      {"NRRD, list of files: the list",
       "a.nhdr",
       "a.nhdr",
       false,
       true,
       ':',
       {.lines_once = true},
       list_nrrd.size(),
       [=](const std::string& f) {
         writeSlices(f);
         writeFile(in(f, "a.nhdr"), list_nrrd + "s0.raw\ns1.raw\ns2.raw\n");
       }},
      listedFile("NRRD, list of files: a slice", "a.nhdr", list_nrrd),
      {"MetaImage, raw", "a.mha", "a.mha", false, true, '=', meta, metaHeader("MET_SHORT").size(),
       [](const std::string& f) { writeFile(in(f, "a.mha"), metaHeader("MET_SHORT") + data()); }},
      {"MetaImage, big-endian", "a.mha", "a.mha", false, true, '=', meta, big_meta.size(),
       [=](const std::string& f) { writeFile(in(f, "a.mha"), big_meta + bytesOf<std::int16_t>(shorts(), true)); }},
      {"MetaImage, zlib", "a.mha", "a.mha", false, true, '=', packed_meta, 0,
       [](const std::string& f) {
         ItkImage image = itkImageOf(plainLattice(), shorts());
         writeWithItk(ItkWriter::kMeta, in(f, "a.mha"), image, true);
       }},
      {"MetaImage, list of files: the list",
       "a.mhd",
       "a.mhd",
       false,
       true,
       '=',
       {.lines_once = true},
       list_meta.size(),
       [=](const std::string& f) {
         writeSlices(f);
         writeFile(in(f, "a.mhd"), list_meta + "s0.raw\ns1.raw\ns2.raw\n");
       }},
      listedFile("MetaImage, list of files: a slice", "a.mhd", list_meta),
      saved("NIfTI", "a.nii", length, 352),
      saved("NIfTI, gzip", "a.nii.gz", all, 0),
      {"NIfTI, pair: header", "a.hdr", "a.hdr", false, false, ':', length, 348,
       [](const std::string& f) {
         NiftiFields pair;
         pair.one_file = false;
         writeFile(in(f, "a.hdr"), niftiHeader(pair));
         writeFile(in(f, "a.img"), data());
       },
       false},
      {"NIfTI, pair: gzip values", "a.img.gz", "a.hdr", false, false, ':', all, 0,
       [](const std::string& f) {
         NiftiFields pair;
         pair.one_file = false;
         writeFile(in(f, "a.hdr"), niftiHeader(pair));
         writeGzip(in(f, "a.img.gz"), data());
       }},
      saved("OpenVDB by Palpate", "a.vdb", own, 0),
      {"OpenVDB without checksum",
       "a.vdb",
       "a.vdb",
       false,
       false,
       ':',
       {},
       900,
       [](const std::string& f) {
         saveVolume(sample(), in(f, "a.vdb"));
         const std::string bytes = readFile(in(f, "a.vdb"));
         writeFile(in(f, "a.vdb"), bytes.substr(0, bytes.size() - 16));
       }},
      {"OpenVDB, several grids",
       "a.vdb",
       "a.vdb",
       false,
       false,
       ':',
       {},
       900,
       [](const std::string& f) { writeVdbGrids(in(f, "a.vdb")); }},
      {"InVesalius", "a.inv3", "a.inv3", false, false, ':', all, 0,
       [](const std::string& f) {
         writeTarGz(in(f, "a.inv3"), {{"main.plist", invesaliusPlist()}, {"matrix.dat", data()}});
       }},
      dicom("DICOM slice", kLittleEndianDicom, 40),
      {"DICOM frames",
       "scan.dcm",
       "",
       false,
       false,
       ':',
       {.length = true},
       dicomFrames().size() - 120,
       [](const std::string& f) { writeFile(in(f, "scan.dcm"), dicomFrames()); }},
      dicom("DICOM slice, big-endian", kBigEndianDicom, 40),
      dicom("DICOM slice, deflated", kDeflatedDicom, deflatedBytes()),
      packedDicomFile("DICOM slice, RLE", DicomPacking::kRle),
      packedDicomFile("DICOM slice, JPEG lossless", DicomPacking::kJpegLossless),
      packedDicomFile("DICOM slice, JPEG-LS", DicomPacking::kJpegLs),
      packedDicomFile("DICOM slice, JPEG 2000", DicomPacking::kJpeg2000),
  };
}

WholeFile mesh(const std::string& name, const std::string& file, bool text, Promise promise, const std::string& bytes) {
  WholeFile mesh = {
      name, file, file, true, text, ' ', promise, after(bytes, "end_header\n"), [=](const std::string& f) {
        bytes.empty() ? writeMeshTo(in(f, file)) : writeFile(in(f, file), bytes);
      }};
  mesh.values_are_text = !bytes.empty();
  return mesh;
}

}  // namespace

std::vector<WholeFile> wholeFiles() {
  std::vector<WholeFile> all = volumes();
  all.push_back(mesh("OBJ", "a.obj", false, {}, ""));
  all.push_back(mesh("STL, binary", "a.stl", false, {.length = true}, ""));
  all.push_back(mesh("STL, text", "a.stl", false, {.ends = true}, stlText()));
  all.push_back(mesh("PLY, binary", "a.ply", true, {.length = true, .lines_once = true}, ""));
  all.push_back(mesh("PLY, text", "a.ply", true, {.ends = true, .lines_once = true}, plyText()));
  return all;
}

}  // namespace palpate::damage
