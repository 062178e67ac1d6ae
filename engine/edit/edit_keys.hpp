// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_keys.hpp: the words of edits as text: every kind, and every key with the kinds that have it. The
// parser, the messages and the table in docs/edits.md come from here. Any thread.
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
  bool tool;  // a tool can carry it
  const char* help;
};

struct EditKey {
  const char* name;
  const char* takes;
  std::uint32_t kinds;   // bit n: the kind of number n has it
  bool placed, tool;     // in edits that say where they go; in a tool's brush
  const char* standard;  // what holds if it is not given
  const char* help;
  void (*set)(const EditValue& value, EditText& text);
};

[[nodiscard]] std::span<const EditWord> editWords();
[[nodiscard]] std::span<const EditKey> editKeys();
[[nodiscard]] bool hasKey(const EditKey& key, EditKind kind, EditUse use) noexcept;

// Both as Markdown: the part of docs/edits.md between its two marks.
[[nodiscard]] std::string editTextTable();

}  // namespace palpate
