// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/passivity.hpp"

#include <cmath>

#include "base/error.hpp"

namespace palpate {
Passivity::Passivity(const PassivityParameters& p, double force_limit_N, double rate_hz, int delay_ticks,
                     double resolution_m)
    : control_(p.control),
      forget_credit_(p.forget_credit),
      share_limit_N_(p.force_share * force_limit_N),
      damping_limit_(p.damping_limit_Ns_per_m.value_or(PassivityParameters::kUsualDamping_Ns_per_m)),
      rate_hz_(rate_hz),
      position_(resolution_m) {
  checkSetting(p.force_share >= 0 && p.force_share <= 1, "passivity force share", p.force_share, "give 0 to 1");
  checkSetting(damping_limit_ >= 0, "passivity damping limit", damping_limit_, "give 0 N s/m or more");
  checkSetting(delay_ticks >= 0, "device delay", delay_ticks, "give 0 ticks or more");
  checkSetting(resolution_m >= 0, "encoder resolution", resolution_m, "give 0 m or more");
  under_way_W_.assign(static_cast<std::size_t>(delay_ticks), Vec3::Zero());
}

}  // namespace palpate
