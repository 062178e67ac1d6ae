// SPDX-License-Identifier: Apache-2.0
// A recorded session as bytes. What is read, as far as it is whole, is what is written again.
#include "servo/devices/recording.hpp"

#include "base/error.hpp"
#include "fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::string bytes = fuzz::textOf(data, size);
  Recording read;
  const bool accepted = fuzz::accepts("a.rec", [&] { read = readRecording(bytes, "a.rec"); });
  if (!accepted) return 0;
  fuzz::require(!read.ticks.empty(), "a recording without a tick is accepted");
  const std::string again = recordingBytes(read);
  const Recording back = readRecording(again, "a.rec");
  fuzz::require(back.damage.empty() && recordingBytes(back) == again, "it reads otherwise when it is written again");
  return 0;
}
