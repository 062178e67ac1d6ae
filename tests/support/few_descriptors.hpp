// SPDX-License-Identifier: Apache-2.0
// tests/support/few_descriptors.hpp: while it lives, this process may open only `spare` more files.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace palpate {

class FewDescriptors {
 public:
  explicit FewDescriptors(int spare = 0) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int next = dup(STDERR_FILENO);  // the lowest number that is free
    close(next);
    const rlimit few{static_cast<rlim_t>(next + spare), before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  rlimit before_{};
};

}  // namespace palpate
