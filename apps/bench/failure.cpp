// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/failure.hpp"

#include <exception>
#include <new>

#include "base/error.hpp"

namespace palpate {

std::string failureOf(const std::function<void()>& work) {
  try {
    work();
    return "";
  } catch (const Error& failure) {
    if (failure.code() == Error::Code::kCancelled) throw;
    return failure.what();
  } catch (const std::bad_alloc&) {
    return "there was not enough memory";
  } catch (const std::exception& failure) {  // of a library's own kind
    return failure.what();
  }
}

}  // namespace palpate
