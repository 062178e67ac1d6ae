// SPDX-License-Identifier: Apache-2.0
// A sphere that is served, for tests of `palpate serve`.
#pragma once

#include "engine/files/volume_file.hpp"
#include "service_processes.hpp"

namespace palpate {

inline constexpr const char* kServedSphere = "phantom:sphere?size=32";

class ServedSphere : public ServiceTest {
 protected:
  // A hand that is pressed 1 mm into the sphere, and stays there.
  void writePress() const { write("press.csv", "time_s,x_m,y_m,z_m\n0,0,0,0.014\n0.3,0,0,0.0102\n"); }
  [[nodiscard]] double densityAt(const std::string& name, const Vec3& place_W) const {
    const Volume volume = loadVolume(file(name).string());
    return volume.density(place_W).value_or(-1e9);
  }
  // In the file of what was set, wherever the journal lies.
  [[nodiscard]] bool isKept(const std::string& words) const {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder()))
      if (entry.path().filename() == "settings.json" && contentsOf(entry.path()).find(words) != std::string::npos)
        return true;
    return false;
  }
  [[nodiscard]] bool awaitKept(const std::string& words) const {
    for (int look = 0; look < 200; ++look) {
      if (isKept(words)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
};

}  // namespace palpate
