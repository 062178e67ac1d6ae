// SPDX-License-Identifier: Apache-2.0
#include "engine/gpu/spirv_names.hpp"

#include <cstddef>

namespace palpate::gpu {
namespace {

// The SPIR-V specification, 2.3: five words of header; an instruction begins with its length in words and its opcode.
constexpr std::uint32_t kMagic = 0x07230203;
constexpr std::size_t kHeaderWords = 5;
constexpr std::uint32_t kOpName = 5;       // target, text
constexpr std::uint32_t kOpDecorate = 71;  // target, decoration, its operands
constexpr std::uint32_t kSpecId = 1;

// A text: UTF-8, four bytes a word, the lowest first, ended by a zero.
std::string textOf(std::span<const std::uint32_t> words) {
  constexpr std::uint32_t kByteBits = 8;
  std::string text;
  for (const std::uint32_t word : words) {
    for (std::uint32_t byte = 0; byte < sizeof(word); ++byte) {
      const auto letter = static_cast<char>(word >> (kByteBits * byte) & 0xFFU);
      if (letter == '\0') return text;
      text += letter;
    }
  }
  return text;
}

}  // namespace

std::map<std::uint32_t, std::string> constantNames(std::span<const std::uint32_t> spirv) {
  std::map<std::uint32_t, std::string> names;  // by target
  std::map<std::uint32_t, std::uint32_t> id_of_target;
  if (spirv.size() < kHeaderWords || spirv.front() != kMagic) return {};
  for (std::size_t at = kHeaderWords; at < spirv.size();) {
    const std::uint32_t length = spirv[at] >> 16U;
    const std::uint32_t opcode = spirv[at] & 0xFFFFU;
    if (length == 0 || at + length > spirv.size()) break;
    const std::span<const std::uint32_t> operands = spirv.subspan(at + 1, length - 1);
    if (opcode == kOpName && operands.size() >= 2) names[operands[0]] = textOf(operands.subspan(1));
    if (opcode == kOpDecorate && operands.size() >= 3 && operands[1] == kSpecId)
      id_of_target[operands[0]] = operands[2];
    at += length;
  }
  std::map<std::uint32_t, std::string> by_id;
  for (const auto& [target, id] : id_of_target) {
    if (names.contains(target) && !names[target].empty()) by_id[id] = names[target];
  }
  return by_id;
}

}  // namespace palpate::gpu
