// SPDX-License-Identifier: Apache-2.0
// service/channel/usual_socket.hpp: where a service and those who talk with it find each other, if no place is named.
// Any thread.
#pragma once

#include <string>

namespace palpate {

// service.sock in the folder "palpate" of the user's runtime folder (XDG_RUNTIME_DIR), or where there is none in
// /tmp/palpate-UID.
[[nodiscard]] std::string usualSocket();

// Makes the socket's folder, for this user alone. Throws Error(kIo) if it cannot be made, or if the usual one belongs
// to somebody else.
void makeSocketFolder(const std::string& socket);

}  // namespace palpate
