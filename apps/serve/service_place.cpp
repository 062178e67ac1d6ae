// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/service_place.hpp"

#include <algorithm>

#include "base/crc32c.hpp"
#include "base/formatted.hpp"
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
  // A folder's name has 255 bytes at most. The end tells services apart.
  constexpr std::size_t kLongest = 200;
  if (name.size() > kLongest) name = formatted("{}~{}", name.substr(name.size() - kLongest), crc32c(name));
  return state / "services" / name;
}

}  // namespace palpate
