// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_text.hpp: edits as text: `remove:radius=2mm:at=10,20,30mm`, `undo`, `redo`. Command line, scripts
// and the brush of the servo's tool share one grammar (docs/edits.md; the keys: edit_keys.hpp). Any thread.
//
// A text is a kind of edit, then `key=value` pairs, all separated by colons. Lengths and places are in the world frame
// W, in mm where no unit is given. A file name may contain colons. It ends before a colon that a key of that kind and
// `=` follow.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/edit/edit_command.hpp"

namespace palpate {

// Where the place of an edit comes from: the text (kPlaced), or the pose of the tool that carries the brush (kTool).
enum class EditUse { kPlaced, kTool };

struct EditText {
  enum class Verb { kEdit, kUndo, kRedo };
  Verb verb = Verb::kEdit;
  EditCommand command;             // all but EditCommand::stamp, for which the caller reads mesh_file
  std::string mesh_file;           // stamps
  double metres_per_unit = 1e-3;   // of the mesh file's coordinates [m]
  std::optional<int> mirror_axis;  // 0 to 2: the edit is repeated, mirrored along this axis of the volume's lattice
  double rate_per_Ns = 0;          // tools: ToolBrushSpec::rate_per_Ns
  double period_s = 4e-3;          // tools: ToolBrushSpec::period_s
};

// The command and, if an axis is given, its mirror image across the middle of a volume of `size` voxels. Pass both to
// one Editor::apply().
[[nodiscard]] std::vector<EditCommand> withMirror(const EditCommand& command, std::optional<int> mirror_axis,
                                                  const Vec3i& size, const Lattice& lattice);

// Parses an edit. `where` names the text in messages. Throws Error(kBadInput) for an unknown kind; for `undo` or `redo`
// with kTool; for a key that the kind does not take, that comes twice or that is missing; for a value that is not a
// number, length or place, or is out of range. Limits that depend on the volume (largest radius, farthest place) are
// checked when the edit is applied.
[[nodiscard]] EditText editText(std::string_view text, EditUse use, const std::string& where);

// The command on a line of a script, without the blanks around it and without a comment. A comment begins with `#` at
// the start of the line or behind a blank. Empty: the line holds no command.
[[nodiscard]] std::string_view scriptCommand(std::string_view line) noexcept;

}  // namespace palpate
