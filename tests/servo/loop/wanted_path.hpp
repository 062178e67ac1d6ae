// SPDX-License-Identifier: Apache-2.0
// tests/servo/loop/wanted_path.hpp: a path from a formula, 10 s long.
#pragma once

#include <functional>

#include "servo/devices/path.hpp"

namespace palpate {

class WantedPath final : public Path {
 public:
  explicit WantedPath(std::function<Vec3(double)> at) : at_(std::move(at)) {}
  [[nodiscard]] Vec3 position(double time_s) const noexcept override { return at_(time_s); }
  [[nodiscard]] double duration_s() const noexcept override { return 10; }

 private:
  std::function<Vec3(double)> at_;
};

}  // namespace palpate
