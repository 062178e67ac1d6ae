// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/service_place.hpp"

#include <algorithm>

#include "base/user_folders.hpp"
#include "service/channel/usual_socket.hpp"

namespace palpate {

std::string socketOf(const Scene& scene) {
  return scene.service_socket.empty() ? usualSocket() : scene.service_socket;
}

std::filesystem::path usualServiceJournal(const std::string& socket) {
  const std::filesystem::path state = stateFolder();
  if (state.empty()) return {};
  std::string name = std::filesystem::absolute(socket).lexically_normal().string();
  std::ranges::replace(name, '/', '_');
  return state / "services" / name;
}

}  // namespace palpate
