// SPDX-License-Identifier: Apache-2.0
// tests/support/as_nobody.hpp: what is refused to most users is allowed to the superuser, as whom tests may run.
#pragma once

#include <sys/types.h>
#include <unistd.h>

namespace palpate {

// Files are opened and made as nobody while it lives, if this is the superuser; else as whoever this is. Whole process.
class AsNobody {
 public:
  static constexpr uid_t kNobody = 65534;
  AsNobody() : was_root_(geteuid() == 0), is_set_(!was_root_ || seteuid(kNobody) == 0) {}
  ~AsNobody() {
    if (was_root_ && is_set_) static_cast<void>(!seteuid(0));
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;
  [[nodiscard]] bool isSet() const noexcept { return is_set_; }

 private:
  bool was_root_, is_set_;
};

}  // namespace palpate
