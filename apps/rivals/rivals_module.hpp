// SPDX-License-Identifier: Apache-2.0
// apps/rivals/rivals_module.hpp: the module "rivals" (base/module.hpp): rivals on ITK and OpenVDB. Private to
// apps/rivals.
#pragma once

#include "apps/rivals/rivals.hpp"

namespace palpate {

class OpenVdbRivals::Library {
 public:
  virtual ~Library() = default;
  [[nodiscard]] virtual std::vector<Rival> rivalsOf(const std::string& job) const = 0;
  [[nodiscard]] virtual std::vector<Rival> picturesOf(const RivalView& view) const = 0;
  [[nodiscard]] virtual std::vector<float> distancesOf(const RivalView& view) const = 0;
};

struct RivalsModule {
  static constexpr const char* kModule = "rivals";
  static constexpr const char* kTable = "palpate_rivals";
  std::vector<Rival> (*itk)(const std::string& job, const RivalField& field, unsigned threads);
  std::shared_ptr<const OpenVdbRivals::Library> (*openvdb)(const RivalField& field, unsigned threads);
};

}  // namespace palpate
