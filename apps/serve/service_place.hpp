// SPDX-License-Identifier: Apache-2.0
// apps/serve/service_place.hpp: where a scene's service listens, and where it keeps its journal. Any thread.
#pragma once

#include <filesystem>
#include <string>

#include "apps/scene/scene.hpp"

namespace palpate {

// The scene's socket: where it says, or the usual one (service/channel/usual_socket.hpp).
[[nodiscard]] std::string socketOf(const Scene& scene);

// The journal of a service at this socket: below XDG_STATE_HOME (~/.local/state), named after the socket. Empty: there
// is no such folder.
[[nodiscard]] std::filesystem::path usualServiceJournal(const std::string& socket);

}  // namespace palpate
