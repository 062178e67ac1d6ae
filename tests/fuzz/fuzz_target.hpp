// SPDX-License-Identifier: Apache-2.0
// tests/fuzz/fuzz_target.hpp: what every fuzz target has: the function that libFuzzer calls, and the rules that a
// parser must keep for any bytes at all.
//
// A target is one source file that defines LLVMFuzzerTestOneInput. It is linked with driver.cpp, which replays a corpus
// and changes it at random, or under `./dev fuzz` with libFuzzer. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>

#include "base/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace palpate::fuzz {

// What the target did with the last input; of several parts the worst. The driver compares it with the input's name.
enum class Verdict { kNone, kAccepted, kRefused };
inline Verdict verdict = Verdict::kNone;

[[noreturn]] inline void fail(const std::string& what) {
  std::fprintf(stderr, "fuzz: %s\n", what.c_str());
  std::abort();
}
inline void require(bool holds, const std::string& what) {
  if (!holds) fail(what);
}

inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
}

// Requires a message of one line that names `input` and has a reason and a remedy.
inline void requireMessage(const Error& error, const std::string& input) {
  const std::string_view what = error.what();
  for (const char c : what) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) fail("the message is more than one line: " + error.reason());
  }
  require(what.find(input) != std::string_view::npos, "the message does not name '" + input + "': " + error.what());
  require(!error.reason().empty() && !error.remedy().empty(), "the message lacks a part: " + std::string(what));
}

// Returns whether `work` accepted the input. If not, it must have refused it with such a message, naming `input`.
// Anything else that it throws is a failure.
template <typename Work>
bool accepts(const std::string& input, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    requireMessage(error, input);
    verdict = Verdict::kRefused;
    return false;
  } catch (const std::exception& other) {
    fail(std::string("something other than an Error was thrown: ") + other.what());
  }
  if (verdict == Verdict::kNone) verdict = Verdict::kAccepted;
  return true;
}

// For what is made from accepted input: `work` must not refuse it.
template <typename Work>
void mustAccept(const std::string& what, const Work& work) {
  try {
    work();
  } catch (const std::exception& error) {
    fail(what + ": " + error.what());
  }
}

}  // namespace palpate::fuzz
