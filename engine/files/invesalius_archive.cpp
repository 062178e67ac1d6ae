// SPDX-License-Identifier: Apache-2.0
// The module "invesalius".
#include "engine/files/invesalius_archive.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <vector>

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>
#include <plist/plist.h>

#include "engine/field/memory_budget.hpp"
#include "engine/files/unpacker.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostPlistBytes = 4U << 20U;
constexpr std::size_t kBlockBytes = 1U << 16U;

// Walks through the archive to one member and reads from it. Members before it are unpacked and dropped. The gzip
// stream is unpacked here, because libarchive does not check its checksum.
class ArchiveMember {
 public:
  enum class Reading { kToMember, kToEnd };

  ArchiveMember(const std::string& path, const std::string& wanted, Reading reading, const std::string& source)
      : stream_(path, 0, isGzip(path) ? Packing::kGzip : Packing::kNone),
        block_(kBlockBytes),
        reader_(archive_read_new(), archive_read_free),
        source_(source) {
    if (reading == Reading::kToEnd) stream_.unpackWhole();
    archive_read_support_format_tar(reader_.get());
    check(archive_read_open(reader_.get(), this, nullptr, readBlock, nullptr));
    archive_entry* entry = nullptr;
    while (next(entry)) {
      const char* name = archive_entry_pathname(entry);
      if (name == nullptr || std::filesystem::path(name).filename() != wanted) continue;
      bytes_ = archive_entry_size_is_set(entry) != 0 ? archive_entry_size(entry) : 0;
      return;
    }
    refuseProject(source_, fmt::format("the archive has no {}", wanted));
  }
  ArchiveMember(const ArchiveMember&) = delete;
  ArchiveMember& operator=(const ArchiveMember&) = delete;

  [[nodiscard]] std::int64_t bytes() const noexcept { return bytes_; }

  void read(std::span<char> to) {
    while (!to.empty()) {
      const la_ssize_t got = archive_read_data(reader_.get(), to.data(), to.size());
      if (got == 0) refuseProject(source_, "the archive is cut short");
      if (got < 0) check(static_cast<int>(got));
      to = to.subspan(static_cast<std::size_t>(got));
    }
  }

  // Reads all members and bytes that follow, so that every checksum is checked.
  void readToEnd() {
    archive_entry* entry = nullptr;
    while (next(entry)) {
    }
    static_cast<void>(stream_.drain());
  }

 private:
  bool next(archive_entry*& entry) {
    const int result = archive_read_next_header(reader_.get(), &entry);
    if (result == ARCHIVE_EOF) return false;
    check(result);
    return true;
  }

  // An exception must not pass through C code, so it is kept in trouble_.
  static la_ssize_t readBlock(archive* reader, void* self, const void** block) {
    auto& member = *static_cast<ArchiveMember*>(self);
    *block = member.block_.data();
    try {
      return static_cast<la_ssize_t>(member.stream_.read(member.block_.data(), member.block_.size()));
    } catch (const std::runtime_error& failure) {
      member.trouble_ = failure.what();
    } catch (const std::bad_alloc&) {
      member.trouble_ = "no memory";
    }
    archive_set_error(reader, EIO, "%s", member.trouble_.c_str());
    return ARCHIVE_FATAL;
  }

  void check(int result) const {
    if (result == ARCHIVE_OK || result == ARCHIVE_WARN) return;
    const char* reason = archive_error_string(reader_.get());
    refuseProject(source_,
                  fmt::format("the archive cannot be read ({})", reason != nullptr ? reason : "unknown fault"));
  }

  Unpacker stream_;
  std::vector<char> block_;
  std::string trouble_;
  std::unique_ptr<archive, int (*)(archive*)> reader_;
  std::string source_;
  std::int64_t bytes_ = 0;
};

struct PlistFree {
  void operator()(void* node) const { plist_free(node); }
};
using Plist = std::unique_ptr<void, PlistFree>;

Plist readPlist(const std::string& path, const std::string& source) {
  ArchiveMember member(path, "main.plist", ArchiveMember::Reading::kToMember, source);
  if (member.bytes() <= 0 || static_cast<std::uint64_t>(member.bytes()) > kMostPlistBytes) {
    refuseProject(source, fmt::format("its main.plist has {} bytes", member.bytes()));
  }
  std::string text(static_cast<std::size_t>(member.bytes()), '\0');
  member.read(text);
  plist_t root = nullptr;
  plist_from_memory(text.data(), static_cast<std::uint32_t>(text.size()), &root);
  if (root == nullptr || plist_get_node_type(root) != PLIST_DICT)
    refuseProject(source, "its main.plist cannot be read");
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
    refuseProject(source, fmt::format("its main.plist has no three numbers under \"{}\"", key));
  }
  Vec3 numbers = Vec3::Zero();
  for (std::uint32_t n = 0; n < 3; ++n) {
    const std::optional<double> number = numberOf(plist_array_get_item(array, n));
    if (!number) refuseProject(source, fmt::format("\"{}\" in its main.plist holds what is no number", key));
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
  refuseProject(source, fmt::format("its values are of the type \"{}\"", name));
}

InvesaliusProject readProject(const std::string& name, std::size_t memory_budget_bytes) {
  const Plist root = readPlist(name, name);
  plist_t matrix = plist_dict_get_item(root.get(), "matrix");
  if (matrix == nullptr || plist_get_node_type(matrix) != PLIST_DICT)
    refuseProject(name, "its main.plist describes no matrix");
  const Vec3 shape = triple(matrix, "shape", name);  // z, y, x
  if (!(shape.minCoeff() >= 1 && shape.maxCoeff() < 1e15)) refuseProject(name, "its matrix has no size");
  InvesaliusProject project;
  project.type = valueTypeOf(matrix, name);
  checkMemory(name, static_cast<std::int64_t>(shape[2]), static_cast<std::int64_t>(shape[1]),
              static_cast<std::int64_t>(shape[0]), static_cast<double>(byteSize(project.type)), memory_budget_bytes);
  project.size = shape.reverse().cast<int>();
  const Vec3 spacing_mm = triple(root.get(), "spacing", name);
  std::copy_n(spacing_mm.data(), 3, project.spacing_mm.begin());
  return project;
}

void readMatrix(const std::string& name, const InvesaliusProject& project, std::span<char> raw) {
  ArchiveMember member(name, "matrix.dat", ArchiveMember::Reading::kToEnd, name);
  if (member.bytes() != static_cast<std::int64_t>(raw.size())) {
    refuseProject(name,
                  fmt::format("its matrix.dat has {} bytes, and {} x {} x {} voxels of {} need {}", member.bytes(),
                              project.size.x(), project.size.y(), project.size.z(), nameOf(project.type), raw.size()));
  }
  member.read(raw);
  member.readToEnd();
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::InvesaliusModule palpate_invesalius = {palpate::readProject, palpate::readMatrix};
