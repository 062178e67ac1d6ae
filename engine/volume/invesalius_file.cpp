// SPDX-License-Identifier: Apache-2.0
// InVesalius projects (.inv3): a tar, usually gzipped, with main.plist (what it is) and matrix.dat (the voxels, C order
// z, y, x). Source of the format: InVesalius 3, invesalius/project.py, Project.SavePlistProject.
//
// InVesalius keeps its slices flipped in y against DICOM: index j runs anterior. It keeps no position, so the world's
// origin is the centre of voxel (0, 0, 0).
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <plist/plist.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/volume/memory_budget.hpp"
#include "engine/volume/raw_values.hpp"
#include "engine/volume/readers.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostPlistBytes = 4U << 20U;
constexpr std::size_t kBlockBytes = 1U << 16U;

[[noreturn]] void refuse(const std::string& source, const std::string& reason) {
  throw Error(Error::Code::kBadInput, source, reason, "save the project again in InVesalius");
}

// Walks through the archive to one member and reads from it. Members before it are unpacked and dropped.
class ArchiveMember {
 public:
  ArchiveMember(const std::string& path, const std::string& wanted, const std::string& source)
      : reader_(archive_read_new(), archive_read_free), source_(source) {
    archive_read_support_filter_gzip(reader_.get());
    archive_read_support_format_tar(reader_.get());
    check(archive_read_open_filename(reader_.get(), path.c_str(), kBlockBytes));
    archive_entry* entry = nullptr;
    for (;;) {
      const int result = archive_read_next_header(reader_.get(), &entry);
      if (result == ARCHIVE_EOF) refuse(source_, fmt::format("the archive has no {}", wanted));
      check(result);
      const char* name = archive_entry_pathname(entry);
      if (name != nullptr && std::filesystem::path(name).filename() == wanted) break;
    }
    bytes_ = archive_entry_size_is_set(entry) != 0 ? archive_entry_size(entry) : 0;
  }

  [[nodiscard]] std::int64_t bytes() const noexcept { return bytes_; }

  void read(char* to, std::size_t count) {
    while (count > 0) {
      const la_ssize_t got = archive_read_data(reader_.get(), to, count);
      if (got == 0) refuse(source_, "the archive is cut short");
      if (got < 0) check(static_cast<int>(got));
      to += got;
      count -= static_cast<std::size_t>(got);
    }
  }

 private:
  void check(int result) const {
    if (result == ARCHIVE_OK || result == ARCHIVE_WARN) return;
    const char* reason = archive_error_string(reader_.get());
    refuse(source_, fmt::format("the archive cannot be read ({})", reason != nullptr ? reason : "unknown fault"));
  }

  std::unique_ptr<archive, int (*)(archive*)> reader_;
  std::string source_;
  std::int64_t bytes_ = 0;
};

struct PlistFree {
  void operator()(void* node) const { plist_free(node); }
};
using Plist = std::unique_ptr<void, PlistFree>;

Plist readPlist(const std::string& path, const std::string& source) {
  ArchiveMember member(path, "main.plist", source);
  if (member.bytes() <= 0 || static_cast<std::uint64_t>(member.bytes()) > kMostPlistBytes) {
    refuse(source, fmt::format("its main.plist has {} bytes", member.bytes()));
  }
  std::string text(static_cast<std::size_t>(member.bytes()), '\0');
  member.read(text.data(), text.size());
  plist_t root = nullptr;
  plist_from_memory(text.data(), static_cast<std::uint32_t>(text.size()), &root);
  if (root == nullptr || plist_get_node_type(root) != PLIST_DICT) refuse(source, "its main.plist cannot be read");
  return Plist(root);
}

std::optional<double> numberOf(plist_t node) {
  if (plist_get_node_type(node) == PLIST_UINT) {
    std::uint64_t value = 0;
    plist_get_uint_val(node, &value);
    return static_cast<double>(static_cast<std::int64_t>(value));  // libplist keeps negative numbers so
  }
  if (plist_get_node_type(node) != PLIST_REAL) return {};
  double value = 0;
  plist_get_real_val(node, &value);
  return value;
}

// Three numbers under a key of a dictionary.
Vec3 triple(plist_t dict, const char* key, const std::string& source) {
  plist_t array = dict != nullptr ? plist_dict_get_item(dict, key) : nullptr;
  if (array == nullptr || plist_get_node_type(array) != PLIST_ARRAY || plist_array_get_size(array) != 3) {
    refuse(source, fmt::format("its main.plist has no three numbers under \"{}\"", key));
  }
  Vec3 numbers = Vec3::Zero();
  for (std::uint32_t n = 0; n < 3; ++n) {
    const std::optional<double> number = numberOf(plist_array_get_item(array, n));
    if (!number) refuse(source, fmt::format("\"{}\" in its main.plist holds what is no number", key));
    numbers[static_cast<int>(n)] = *number;
  }
  return numbers;
}

ValueType valueTypeOf(plist_t matrix, const std::string& source) {
  plist_t node = plist_dict_get_item(matrix, "dtype");
  std::string name;
  if (node != nullptr && plist_get_node_type(node) == PLIST_STRING) name = plist_get_string_ptr(node, nullptr);
  for (const ValueType type : {ValueType::kInt16, ValueType::kUint8, ValueType::kInt8, ValueType::kUint16,
                               ValueType::kInt32, ValueType::kUint32, ValueType::kFloat32, ValueType::kFloat64}) {
    if (nameOf(type) == name) return type;
  }
  refuse(source, fmt::format("its values are of the type \"{}\"", name));
}

}  // namespace

Volume readInvesalius(const std::string& name, std::size_t memory_budget_bytes) {
  const Plist root = readPlist(name, name);
  plist_t matrix = plist_dict_get_item(root.get(), "matrix");
  if (matrix == nullptr || plist_get_node_type(matrix) != PLIST_DICT)
    refuse(name, "its main.plist describes no matrix");
  const Vec3 shape = triple(matrix, "shape", name);  // z, y, x
  if (!(shape.minCoeff() >= 1 && shape.maxCoeff() < 1e15)) refuse(name, "its matrix has no size");
  const ValueType type = valueTypeOf(matrix, name);
  checkMemory(name, static_cast<std::int64_t>(shape[2]), static_cast<std::int64_t>(shape[1]),
              static_cast<std::int64_t>(shape[0]), static_cast<double>(byteSize(type)), memory_budget_bytes);
  const Vec3i size = shape.reverse().cast<int>();
  Lattice lattice;
  lattice.spacing_m = triple(root.get(), "spacing", name) * kMetresPerMillimetre;
  lattice.R_WL = Vec3(1, -1, 1).asDiagonal();
  checkLattice(lattice, name);

  ArchiveMember member(name, "matrix.dat", name);
  const std::size_t wanted = static_cast<std::size_t>(size.cast<long long>().prod()) * byteSize(type);
  if (member.bytes() != static_cast<std::int64_t>(wanted)) {
    refuse(name, fmt::format("its matrix.dat has {} bytes, and {} x {} x {} voxels of {} need {}", member.bytes(),
                             size.x(), size.y(), size.z(), nameOf(type), wanted));
  }
  std::vector<char> raw(wanted);
  member.read(raw.data(), raw.size());
  VolumeFacts facts;
  facts.source = name;
  facts.format = "InVesalius";
  facts.value_type = nameOf(type);
  facts.orientation = "InVesalius axes: left, anterior, superior";
  const std::vector<float> values = toFloats(raw, type);
  std::vector<char>().swap(raw);
  return Volume::fromDense(size, lattice, values, std::move(facts));
}

}  // namespace palpate
