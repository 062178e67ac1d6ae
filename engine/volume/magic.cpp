// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/magic.hpp"

#include <algorithm>
#include <memory>
#include <string_view>

#include <archive.h>

namespace palpate {
namespace {

constexpr std::size_t kHeadBytes = 1024;

std::string_view at(const std::string& head, std::size_t offset, std::size_t count) {
  return offset < head.size() ? std::string_view(head).substr(offset, count) : std::string_view();
}

}  // namespace

// "raw" is libarchive's name for any content.
std::string headOf(const std::string& path, std::size_t count) {
  const std::unique_ptr<archive, int (*)(archive*)> reader(archive_read_new(), archive_read_free);
  archive_read_support_filter_gzip(reader.get());
  archive_read_support_format_raw(reader.get());
  archive_entry* entry = nullptr;
  if (archive_read_open_filename(reader.get(), path.c_str(), kHeadBytes) != ARCHIVE_OK) return {};
  if (archive_read_next_header(reader.get(), &entry) != ARCHIVE_OK) return {};
  std::string head(count, '\0');
  const la_ssize_t got = archive_read_data(reader.get(), head.data(), head.size());
  head.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return head;
}

std::string formatByContent(const std::string& path) {
  using namespace std::string_view_literals;
  const std::string head = headOf(path, kHeadBytes);
  if (at(head, 0, 7) == "NRRD000") return "NRRD";
  if (at(head, 0, 8) == " BDV\0\0\0\0"sv) return "OpenVDB";
  if (at(head, 344, 4) == "n+1\0"sv || at(head, 344, 4) == "ni1\0"sv) return "NIfTI";
  if (at(head, 0, 10) == "ObjectType" || (at(head, 0, 5) == "NDims")) return "MetaImage";
  if (at(head, 128, 4) == "DICM") return "DICOM";
  if (at(head, 257, 5) == "ustar") return "InVesalius";
  return {};
}

}  // namespace palpate
