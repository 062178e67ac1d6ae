// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_text.hpp: edits as text: `remove:radius=2mm:at=10,20,30mm`, `undo`, `redo`. One grammar for the
// command line, for scripts and for the brush of the servo's tool (docs/edits.md; the keys: edit_keys.hpp). Any thread.
//
// A text is a kind and keys with values, colons between them. Lengths and places are in mm where no unit is given, in
// the world's frame W. A file's name may hold colons, as long as none is followed by a key of the kind and `=`.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/edit/edit_command.hpp"

namespace palpate {

// Who says where the edit goes: the text, or a tool that carries the brush.
enum class EditUse { kPlaced, kTool };

struct EditText {
  enum class Verb { kEdit, kUndo, kRedo };
  Verb verb = Verb::kEdit;
  EditCommand command;             // of a stamp all but the stamp itself: who applies it reads the mesh
  std::string mesh_file;           // stamps
  double metres_per_unit = 1e-3;   // of the mesh file's coordinates [m]
  std::optional<int> mirror_axis;  // 0 to 2: the same again, mirrored across this axis of the volume's lattice
  double rate_per_Ns = 0;          // tools: ToolBrushSpec's
  double period_s = 4e-3;
};

// The command and, where there is an axis, its mirror image across the middle of a volume of `size` voxels: of one
// apply().
[[nodiscard]] std::vector<EditCommand> withMirror(const EditCommand& command, std::optional<int> mirror_axis,
                                                  const Vec3i& size, const Lattice& lattice);

// `where` names the text in messages. Throws Error(kBadInput): an unknown kind, `undo` and `redo` of a tool; a key that
// the kind does not have, comes twice or is missing; a value that is no number, length or place, or out of its range.
// What depends on the volume (a radius or place too large for it) is checked when the edit is applied.
[[nodiscard]] EditText editText(std::string_view text, EditUse use, const std::string& where);

// The command on a line of a script: without blanks around it and without a comment, which begins with `#` at the
// line's beginning or behind a blank. Empty: the line has none.
[[nodiscard]] std::string_view scriptCommand(std::string_view line) noexcept;

}  // namespace palpate
