// SPDX-License-Identifier: Apache-2.0
#include "engine/files/magic.hpp"

#include <stdexcept>
#include <string_view>
#include <system_error>

#include "engine/files/text_header.hpp"
#include "engine/files/unpacker.hpp"

namespace palpate {
namespace {

constexpr std::size_t kHeadBytes = 1024;

std::string_view at(const std::string& head, std::size_t offset, std::size_t count) {
  return offset < head.size() ? std::string_view(head).substr(offset, count) : std::string_view();
}

}  // namespace

std::string headOf(const std::string& path, std::size_t count, const std::string& source) {
  std::string head(count, '\0');
  try {
    head.resize(Unpacker(path, 0, isGzip(path) ? Packing::kGzip : Packing::kNone).read(head.data(), head.size()));
  } catch (const std::system_error& failure) {
    throw cannotRead(source, "it", failure.code());
  } catch (const std::runtime_error&) {
    return {};
  }
  return head;
}

std::string formatByContent(const std::string& path, const std::string& source) {
  using namespace std::string_view_literals;
  const std::string head = headOf(path, kHeadBytes, source);
  if (at(head, 0, 7) == "NRRD000") return "NRRD";
  if (at(head, 0, 8) == " BDV\0\0\0\0"sv) return "OpenVDB";
  if (at(head, 344, 4) == "n+1\0"sv || at(head, 344, 4) == "ni1\0"sv) return "NIfTI";
  if (at(head, 0, 10) == "ObjectType" || (at(head, 0, 5) == "NDims")) return "MetaImage";
  if (at(head, 128, 4) == "DICM") return "DICOM";
  if (at(head, 257, 5) == "ustar") return "InVesalius";
  return {};
}

}  // namespace palpate
