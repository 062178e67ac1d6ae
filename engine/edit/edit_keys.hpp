// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_keys.hpp: the vocabulary of edits as text: a table of every kind of edit, and a table of every key
// with the kinds that take it. The parser, the messages and the table in docs/edits.md are made from it. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/edit/edit_text.hpp"
#include "engine/edit/edit_value.hpp"

namespace palpate {

struct EditWord {
  const char* name;
  EditKind kind;
  bool tool;  // the servo's tool may carry such a brush
  const char* help;
};

struct EditKey {
  const char* name;
  const char* takes;
  std::uint32_t kinds;   // bit n is set if EditKind number n takes the key
  bool placed, tool;     // allowed in EditUse::kPlaced; in EditUse::kTool
  const char* standard;  // the default, in words
  const char* help;
  void (*set)(const EditValue& value, EditText& text);
};

[[nodiscard]] std::span<const EditWord> editWords();
[[nodiscard]] std::span<const EditKey> editKeys();
[[nodiscard]] bool hasKey(const EditKey& key, EditKind kind, EditUse use) noexcept;

// Both tables as Markdown: the generated part of docs/edits.md, between its two marks.
[[nodiscard]] std::string editTextTable();

}  // namespace palpate
