// SPDX-License-Identifier: Apache-2.0
// apps/serve/service_place.hpp: where a service and those who talk with it find each other, and where it keeps its
// journal. Any thread.
#pragma once

#include <filesystem>
#include <string>

#include "apps/scene/scene.hpp"

namespace palpate {

// The socket that is used if none is named: service.sock in the folder "palpate" of the user's runtime folder
// (XDG_RUNTIME_DIR), or where there is none in /tmp/palpate-UID.
[[nodiscard]] std::string usualSocket();
// That of a scene: where it says, or the usual one.
[[nodiscard]] std::string socketOf(const Scene& scene);

// Makes the socket's folder, for this user alone. Throws Error(kIo) if it cannot be made, or if the usual one belongs
// to somebody else.
void makeSocketFolder(const std::string& socket);

// The journal of a service at this socket: below XDG_STATE_HOME (~/.local/state), named after the socket. Empty: there
// is no such folder.
[[nodiscard]] std::filesystem::path usualServiceJournal(const std::string& socket);

}  // namespace palpate
