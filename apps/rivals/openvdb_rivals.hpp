// SPDX-License-Identifier: Apache-2.0
// apps/rivals/openvdb_rivals.hpp: what OpenVDB has for a job, on a grid whose every voxel is active.
//
// One thread; OpenVDB takes `threads`. Memory: the grid, and a copy of it while a filter that works in place runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/rivals/rival.hpp"

namespace palpate {

class OpenVdbRivals {
 public:
  OpenVdbRivals(const RivalField& field, unsigned threads);  // copies the field
  [[nodiscard]] static bool hasAny(const std::string& job);  // for the job
  // None where OpenVDB has nothing alike. They keep the grid alive.
  [[nodiscard]] std::vector<Rival> rivalsOf(const std::string& job) const;

  struct State;

 private:
  std::shared_ptr<State> state_;
};

}  // namespace palpate
