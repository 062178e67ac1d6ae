// SPDX-License-Identifier: Apache-2.0
// How soon the program ends when it is asked to, as docs/command-line.md promises.
#pragma once

namespace palpate {

inline constexpr double kPromisedEnd_s = 0.5;

// Whatever else the machine does can only make the time from signal to end longer, so of several times the shortest
// says most about the program, and the first one below the promise makes more tries needless.
inline constexpr int kTriesToEnd = 5;

// Sanitized programs take many times as long, and promise nothing.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kEndIsPromised = false;
#else
inline constexpr bool kEndIsPromised = true;
#endif

}  // namespace palpate
