// SPDX-License-Identifier: Apache-2.0
#include "engine/files/nifti_header.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/files/components.hpp"

namespace palpate {
namespace {

constexpr double kOneFileHeaderBytes = 352;  // 348, and four that say whether extensions follow

// The 348 bytes of nifti_1_header, in either byte order. Offsets are the format's.
class RawHeader {
 public:
  RawHeader(std::string_view bytes, const std::string& source) : bytes_(bytes) {
    if (bytes_.size() < kNiftiHeaderBytes) refuse(source, "its header is cut short", "copy or write the file again");
    const auto claimed_bytes = get<std::int32_t>(0);
    swapped_ = get<std::int16_t>(40) < 1 || get<std::int16_t>(40) > 7;
    if (claimed_bytes == 540 || get<std::int32_t>(0) == 540) refuse(source, "it is NIfTI-2", "convert it to NIfTI-1");
    const std::string_view magic = bytes_.substr(344, 3);
    if (magic != "n+1" && magic != "ni1") {
      refuse(source, "it is no NIfTI file; an Analyze file would not say left from right", "convert it to NIfTI");
    }
  }

  [[nodiscard]] int dimension(std::size_t axis) const { return get<std::int16_t>(40 + 2 * axis); }  // 0: their count
  [[nodiscard]] double voxelSize(std::size_t axis) const { return get<float>(76 + 4 * axis); }
  [[nodiscard]] int intent() const { return get<std::int16_t>(68); }
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

  std::string_view bytes_;
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
    case 128:
      refuseComponents(source, Components::kColours, 3);
    case 2304:
      refuseComponents(source, Components::kColours, 4);
    case 32:
    case 1792:
    case 2048:
      refuseComponents(source, Components::kComplex, 2);
    default:
      refuse(source, fmt::format("its value type {} is not supported", header.type()), "write it as int16 or float32");
  }
}

// By the intent_code, where there is one.
Components fifthAxisOf(const RawHeader& header) {
  switch (header.intent()) {
    case 1004:
    case 1005:
      return Components::kTensors;
    case 2003:
    case 2004:
      return Components::kColours;
    default:
      return Components::kVectors;
  }
}

void checkDimensions(const RawHeader& header, const std::string& source) {
  const int axes = header.dimension(0);
  if (axes < 3 || axes > 7) refuse(source, fmt::format("it has {} dimensions", axes), "give a volume");
  // The fourth axis is time, the fifth the components of a voxel.
  if (axes >= 5 && header.dimension(5) > 1) refuseComponents(source, fifthAxisOf(header), header.dimension(5));
  for (std::size_t axis = 4; axis <= static_cast<std::size_t>(axes); ++axis) {
    if (header.dimension(axis) <= 1) continue;
    refuse(source, fmt::format("it is a series of {} volumes", header.dimension(axis)), "extract one of them");
  }
}

void checkVoxelSize(const RawHeader& header, const std::string& source) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    if (header.voxelSize(axis) > 0 && std::isfinite(header.voxelSize(axis))) continue;
    refuse(source, fmt::format("its voxel size pixdim[{}] is {:g}, not positive", axis, header.voxelSize(axis)),
           "write the true voxel size into the header");
  }
}

void checkUnit(const RawHeader& header, const std::string& source) {
  constexpr int kMicrometre = 3;  // the last known code
  if (header.unitOfLength() <= kMicrometre) return;
  refuse(source,
         fmt::format("its xyzt_units give lengths in unit {}, which NIfTI does not know", header.unitOfLength()),
         "write the true unit into the header");
}

std::uint64_t dataOffsetOf(const RawHeader& header, const std::string& source) {
  double offset = header.dataOffset();
  if (header.oneFile() && offset == 0) offset = kOneFileHeaderBytes;  // the writer left it out
  if (!(offset >= (header.oneFile() ? kNiftiHeaderBytes : 0) && offset < 1e12) || offset != std::floor(offset)) {
    refuse(source, fmt::format("its data offset {:g} is no place in a file", offset), "write the file again");
  }
  return static_cast<std::uint64_t>(offset);
}

}  // namespace

NiftiHeader readNiftiHeader(std::string_view bytes, const std::string& source) {
  const RawHeader raw(bytes, source);
  checkVoxelSize(raw, source);
  checkUnit(raw, source);
  checkDimensions(raw, source);
  NiftiHeader header;
  header.swapped = raw.swapped();
  header.one_file = raw.oneFile();
  for (std::size_t axis = 0; axis < 3; ++axis) header.size[axis] = raw.dimension(axis + 1);
  header.type = valueTypeOf(raw, source);
  header.data_offset = dataOffsetOf(raw, source);
  if (raw.slope() != 0) {  // 0: the values are not scaled
    if (!std::isfinite(raw.slope()) || !std::isfinite(raw.intercept())) {
      refuse(source, fmt::format("its scl_slope {:g} or scl_inter {:g} is no number", raw.slope(), raw.intercept()),
             "write the file again");
    }
    header.slope = raw.slope();
    header.intercept = raw.intercept();
  }
  header.forms = raw.forms();
  return header;
}

}  // namespace palpate
