// SPDX-License-Identifier: Apache-2.0
// How soon the program ends when it is asked to, as docs/command-line.md promises.
#pragma once

namespace palpate {

inline constexpr double kPromisedEnd_s = 0.5;

// Other load on the machine can only lengthen the time from signal to end. So the shortest of several times counts, and
// the first time within the promise ends the tries.
inline constexpr int kTriesToEnd = 5;

// The promise does not hold for sanitized programs, which take many times as long.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kEndIsPromised = false;
#else
inline constexpr bool kEndIsPromised = true;
#endif

}  // namespace palpate
