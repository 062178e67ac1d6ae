// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_keys.hpp: the vocabulary of edits as text. One table lists every kind of edit, another every key and
// the kinds that take it. The parser, its messages and the tables in docs/edits.md come from these two. Any thread.
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
  const char* takes;         // form of the value, for help texts: "a length [mm]"
  std::uint32_t kinds;       // bit n is set if EditKind number n takes the key
  bool placed, tool;         // allowed in EditUse::kPlaced; in EditUse::kTool
  const char* default_text;  // the default, for help texts
  const char* help;
  void (*set)(const EditValue& value, EditText& text);
};

[[nodiscard]] std::span<const EditWord> editWords();
[[nodiscard]] std::span<const EditKey> editKeys();
[[nodiscard]] bool hasKey(const EditKey& key, EditKind kind, EditUse use) noexcept;

// Both tables as Markdown. `palpate edit --commands` prints them, and docs/edits.md holds them.
[[nodiscard]] std::string editTextTable();

}  // namespace palpate
