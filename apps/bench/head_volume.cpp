// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/head_volume.hpp"

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "base/user_folders.hpp"

namespace palpate {

std::string headVolume() {
  std::vector<std::filesystem::path> places;
  if (const std::filesystem::path cache = cacheFolder(); !cache.empty())
    places.push_back(cache / "Cranium.inv3");  // where ./dev demo keeps it
  if (const char* data = std::getenv("PALPATE_DATA")) {
    places.push_back(std::filesystem::path(data) / "ct_head_invesalius.nrrd");
  }
  std::error_code ignored;
  for (const auto& place : places) {
    if (std::filesystem::is_regular_file(place, ignored)) return place.string();
  }
  return "phantom:head?size=256";
}

}  // namespace palpate
