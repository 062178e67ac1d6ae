// SPDX-License-Identifier: Apache-2.0
// NIfTI-1: .nii, .nii.gz and .hdr/.img pairs. Source of the format: nifti1.h, https://nifti.nimh.nih.gov/nifti-1
//
// Nothing of it is ITK's: where the voxels lie is found in nifti_form.hpp, the values are read where they lie, and
// scl_slope and scl_inter applied. Analyze 7.5 files are refused: they do not say left from right.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/volume/itk_image.hpp"
#include "engine/volume/magic.hpp"
#include "engine/volume/memory_budget.hpp"
#include "engine/volume/nifti_form.hpp"
#include "engine/volume/readers.hpp"
#include "engine/volume/text_header.hpp"

namespace palpate {
namespace {

constexpr std::size_t kHeaderBytes = 348;
constexpr double kOneFileHeaderBytes = 352;  // with the four that say whether extensions follow

[[noreturn]] void refuse(const std::string& source, const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, source, reason, remedy);
}

// The 348 bytes of nifti_1_header, in either byte order. Offsets are the format's.
class RawHeader {
 public:
  RawHeader(std::string bytes, const std::string& source) : bytes_(std::move(bytes)) {
    if (bytes_.size() < kHeaderBytes) refuse(source, "its header is cut short", "copy or write the file again");
    const auto claimed_bytes = get<std::int32_t>(0);
    swapped_ = get<std::int16_t>(40) < 1 || get<std::int16_t>(40) > 7;
    if (claimed_bytes == 540 || get<std::int32_t>(0) == 540) refuse(source, "it is NIfTI-2", "convert it to NIfTI-1");
    const std::string magic = bytes_.substr(344, 3);
    if (magic != "n+1" && magic != "ni1") {
      refuse(source, "it is no NIfTI file; an Analyze file would not say left from right", "convert it to NIfTI");
    }
  }

  [[nodiscard]] int dimension(std::size_t axis) const { return get<std::int16_t>(40 + 2 * axis); }  // 0: their count
  [[nodiscard]] double voxelSize(std::size_t axis) const { return get<float>(76 + 4 * axis); }
  [[nodiscard]] int type() const { return get<std::int16_t>(70); }
  [[nodiscard]] double dataOffset() const { return get<float>(108); }
  [[nodiscard]] double slope() const { return get<float>(112); }
  [[nodiscard]] double intercept() const { return get<float>(116); }
  [[nodiscard]] int unitOfLength() const { return bytes_[123] & 7; }  // 0: not said
  // Of one unit of length [mm].
  [[nodiscard]] double millimetresPerUnit() const {
    const int unit = unitOfLength();
    if (unit == 1) return 1e3;
    return unit == 3 ? 1e-3 : 1;
  }
  [[nodiscard]] bool swapped() const { return swapped_; }  // against the machine's byte order
  [[nodiscard]] bool oneFile() const { return bytes_[345] == '+'; }
  [[nodiscard]] NiftiForms forms() const {
    NiftiForms forms;
    forms.qform_code = get<std::int16_t>(252);
    forms.sform_code = get<std::int16_t>(254);
    forms.qfac = get<float>(76);
    forms.millimetres_per_unit = millimetresPerUnit();
    for (std::size_t n = 0; n < 3; ++n) {
      forms.voxel_size[n] = voxelSize(n + 1);
      forms.quaternion[n] = get<float>(256 + 4 * n);
      forms.offset[n] = get<float>(268 + 4 * n);
      for (std::size_t column = 0; column < 4; ++column) forms.sform[n][column] = get<float>(280 + 16 * n + 4 * column);
    }
    return forms;
  }

 private:
  template <class T>
  [[nodiscard]] T get(std::size_t offset) const {
    std::array<char, sizeof(T)> raw;
    std::copy_n(bytes_.data() + offset, sizeof(T), raw.data());
    if (swapped_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  std::string bytes_;
  bool swapped_ = false;
};

ValueType valueTypeOf(const RawHeader& header, const std::string& source) {
  switch (header.type()) {
    case 2:
      return ValueType::kUint8;
    case 4:
      return ValueType::kInt16;
    case 8:
      return ValueType::kInt32;
    case 16:
      return ValueType::kFloat32;
    case 64:
      return ValueType::kFloat64;
    case 256:
      return ValueType::kInt8;
    case 512:
      return ValueType::kUint16;
    case 768:
      return ValueType::kUint32;
    case 1024:
      return ValueType::kInt64;
    case 1280:
      return ValueType::kUint64;
    case 32:
    case 128:
    case 1792:
    case 2304:
      refuse(source, "its voxels are complex numbers or colours, several components each", "extract one component");
    default:
      refuse(source, fmt::format("its value type {} is not supported", header.type()), "write it as int16 or float32");
  }
}

// Before ITK sees the file, which may allocate while it reads a header.
void checkSizes(const RawHeader& header, const std::string& source, std::size_t memory_budget_bytes) {
  const int axes = header.dimension(0);
  if (axes < 3 || axes > 7) refuse(source, fmt::format("it has {} dimensions", axes), "give a volume");
  for (std::size_t axis = 4; axis <= static_cast<std::size_t>(axes); ++axis) {
    if (header.dimension(axis) <= 1) continue;
    refuse(source, fmt::format("it is a series of {} volumes or components", header.dimension(axis)),
           "extract one of them");
  }
  const double bytes = static_cast<double>(byteSize(valueTypeOf(header, source)));
  checkMemory(source, header.dimension(1), header.dimension(2), header.dimension(3), bytes, memory_budget_bytes);
}

void checkVoxelSize(const RawHeader& header, const std::string& source) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    if (header.voxelSize(axis) > 0 && std::isfinite(header.voxelSize(axis))) continue;
    refuse(source, fmt::format("its voxel size pixdim[{}] is {:g}, not positive", axis, header.voxelSize(axis)),
           "write the true voxel size into the header");
  }
}

void checkUnit(const RawHeader& header, const std::string& source) {
  constexpr int kMicrometre = 3;  // the last that there is
  if (header.unitOfLength() <= kMicrometre) return;
  refuse(source,
         fmt::format("its xyzt_units give lengths in unit {}, which NIfTI does not know", header.unitOfLength()),
         "write the true unit into the header");
}

// "scan.hdr" and "scan.img" are one volume; the header is in the former.
std::string headerPath(const std::string& name) {
  const std::string lower = lowerCase(name);
  if (lower.ends_with(".img")) return name.substr(0, name.size() - 4) + ".hdr";
  if (lower.ends_with(".img.gz")) return name.substr(0, name.size() - 7) + ".hdr.gz";
  return name;
}

// The file that holds the voxels: "scan.hdr" has them in "scan.img", either of them gzipped or not.
std::string dataPath(const RawHeader& header, const std::string& header_path) {
  if (header.oneFile()) return header_path;
  const std::string stem = header_path.substr(0, lowerCase(header_path).rfind(".hdr"));
  for (const std::string suffix : {".img", ".img.gz", ".IMG"}) {
    if (std::filesystem::exists(stem + suffix)) return stem + suffix;
  }
  return stem + ".img";
}

// Where the values lie. A gzipped pair has its offset in what comes out, one file too.
StoredValues storedValuesOf(const RawHeader& header, const std::string& header_path, const std::string& source) {
  const std::string path = dataPath(header, header_path);
  double offset = header.dataOffset();
  if (header.oneFile() && offset == 0) offset = kOneFileHeaderBytes;  // left out by its writer
  if (!(offset >= (header.oneFile() ? kHeaderBytes : 0) && offset < 1e12) || offset != std::floor(offset)) {
    refuse(source, fmt::format("its data offset {:g} is no place in a file", offset), "write the file again");
  }
  StoredValues values;
  values.parts = {{path, 0}};
  values.skip_bytes = static_cast<std::uint64_t>(offset);
  if (isGzip(path) || lowerCase(path).ends_with(".gz")) values.packing = Packing::kGzip;
  values.swapped = header.swapped();
  return values;
}

// Where the slope is 0 the values are what they are.
void applyScale(const RawHeader& header, ItkRequest& request) {
  if (header.slope() == 0) return;
  if (!std::isfinite(header.slope()) || !std::isfinite(header.intercept())) {
    refuse(request.facts.source,
           fmt::format("its scl_slope {:g} or scl_inter {:g} is no number", header.slope(), header.intercept()),
           "write the file again");
  }
  request.slope = request.facts.rescale_slope = header.slope();
  request.intercept = request.facts.rescale_intercept = header.intercept();
}

}  // namespace

Volume readNifti(const ReadRequest& wanted) {
  const std::string& name = wanted.name;
  const std::string path = headerPath(name);
  if (path != name) static_cast<void>(fileBytes(path, name));  // an .img without its .hdr
  const RawHeader header(headOf(path, kHeaderBytes, name), name);
  checkVoxelSize(header, name);
  checkUnit(header, name);
  checkSizes(header, name, wanted.memory_budget_bytes);
  ItkRequest request;
  request.reader = ItkReader::kNifti;
  request.path = path;
  request.memory_budget_bytes = wanted.memory_budget_bytes;
  request.stored_type = valueTypeOf(header, name);
  request.stored = storedValuesOf(header, path, name);
  const Vec3 last(header.dimension(1) - 1, header.dimension(2) - 1, header.dimension(3) - 1);
  const NiftiPlacing placing = placingOf(header.forms(), last, name);
  request.lattice = placing.lattice;
  request.facts.source = name;
  request.facts.format = "NIfTI";
  request.facts.value_type = nameOf(valueTypeOf(header, name));
  request.facts.orientation = placing.orientation;
  request.facts.remark = placing.remark;
  request.facts.instead_of_nan = wanted.instead_of_nan.value_or(0.0F);
  request.header = ItkHeader{};
  request.header->type = request.stored_type;
  for (std::size_t axis = 1; axis <= 3; ++axis) request.header->dimensions.push_back(header.dimension(axis));
  applyScale(header, request);
  return readItkImage(std::move(request));
}

}  // namespace palpate
