// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/head_volume.hpp"

#include <cstdlib>
#include <filesystem>
#include <vector>

namespace palpate {

std::string headVolume() {
  std::vector<std::filesystem::path> places;
  if (const char* cache = std::getenv("XDG_CACHE_HOME")) {
    places.push_back(std::filesystem::path(cache) / "palpate/Cranium.inv3");
  } else if (const char* home = std::getenv("HOME")) {
    places.push_back(std::filesystem::path(home) / ".cache/palpate/Cranium.inv3");  // where ./dev demo keeps it
  }
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
