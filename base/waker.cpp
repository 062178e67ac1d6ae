// SPDX-License-Identifier: Apache-2.0
#include "base/waker.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/error.hpp"

namespace palpate {

Waker::Waker(const std::string& whom) : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!event_)
    throw Error(Error::Code::kIo, whom, fmt::format("nothing can wake it ({})", std::strerror(errno)),
                kFreeDescriptors);
}

void Waker::wake() const noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(write(event_.get(), &one, sizeof one));
}

void Waker::sleepAgain() const noexcept {
  std::uint64_t count = 0;
  static_cast<void>(read(event_.get(), &count, sizeof count));
}

}  // namespace palpate
