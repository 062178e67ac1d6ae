// SPDX-License-Identifier: Apache-2.0
// apps/console/pass_progress.hpp: shows the passes that Engine's constructor runs, one stage each, and lets Ctrl-C end
// them. One thread.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "apps/console/progress.hpp"

namespace palpate {

// The `progress` argument of Engine's constructor. `stop` is called after every submission and throws to end the work.
inline std::function<void(const char* pass, double done)> passProgress(Progress& progress, std::function<void()> stop) {
  return [&progress, stop = std::move(stop), shown = std::string()](const char* pass, double done) mutable {
    if (std::exchange(shown, pass) != pass) progress.stage(std::string("computing on Vulkan: ") + pass);
    progress.fraction(done);
    stop();
  };
}

}  // namespace palpate
