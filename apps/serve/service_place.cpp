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
  const std::string path = std::filesystem::absolute(socket).lexically_normal().string();
  std::string name = path;
  std::ranges::replace(name, '/', '_');
  // A folder's name has 255 bytes at most. Of a path that is longer the end is kept; where that, or a '_' of its own,
  // might make two paths one name, a checksum tells them apart.
  constexpr std::size_t kLongest = 200;
  if (name.size() > kLongest) name.erase(0, name.size() - kLongest);
  if (name.size() < path.size() || path.find('_') != std::string::npos) name += formatted("~{}", crc32c(path));
  return state / "services" / name;
}

}  // namespace palpate
