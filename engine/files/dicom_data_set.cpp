// SPDX-License-Identifier: Apache-2.0
#include "engine/files/dicom_data_set.hpp"

#include <string_view>

namespace palpate {

const DicomElement& DicomItem::element(DicomTag tag) const {
  static const DicomElement kNothing;
  const auto found = elements.find(tag);
  return found == elements.end() ? kNothing : found->second;
}

std::uint32_t DicomItem::number(DicomTag tag, std::uint32_t otherwise) const {
  const std::vector<std::uint32_t>& numbers = element(tag).numbers;
  return numbers.empty() ? otherwise : numbers[0];
}

const DicomItem* DicomItem::item(DicomTag sequence) const {
  const DicomElement& found = element(sequence);
  return found.items.empty() ? nullptr : found.items.data();
}

std::string DicomItem::text(DicomTag tag) const {
  std::string_view bytes = element(tag).bytes;
  while (!bytes.empty() && (bytes.back() == ' ' || bytes.back() == '\0')) bytes.remove_suffix(1);
  while (!bytes.empty() && bytes.front() == ' ') bytes.remove_prefix(1);
  return std::string(bytes);
}

}  // namespace palpate
