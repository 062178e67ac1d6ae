// SPDX-License-Identifier: Apache-2.0
// apps/window/questions.hpp: what the window shows before a volume is there: questions, and how far loading is. One
// thread, that of the window; each call stays until it has an answer.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/sculpt/sculpt_session.hpp"
#include "apps/sculpt/sculpt_side.hpp"
#include "apps/sculpt/session_folders.hpp"
#include "apps/window/gui_host.hpp"

namespace palpate {

// A session, and the folder of its journal.
struct OpenVolume {
  std::unique_ptr<SessionFolder> journal;  // outlives the session; null: none is kept
  std::unique_ptr<SculptSide> session;
};

// Whether these are names of one volume.
[[nodiscard]] bool isSameVolume(const std::string& name, const std::string& other);

// That of a running service, when it answers. Null: the person does not wait any more. Throws Error as ServedSession
// does.
[[nodiscard]] std::unique_ptr<OpenVolume> joinService(GuiHost& host, const std::string& socket);

// Opens a volume: asks what becomes of a session of it that a crash has left, and loads it beside the window.
// `journals`: folder for them; empty: none is kept. Null: the person does not want it any more, or the
// window shall close. Throws Error as SculptSession does; then nothing has changed.
[[nodiscard]] std::unique_ptr<OpenVolume> openVolume(GuiHost& host, SculptRequest request,
                                                     const std::filesystem::path& journals);

}  // namespace palpate
