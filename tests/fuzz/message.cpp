// SPDX-License-Identifier: Apache-2.0
// A message of one process of a service to another, and what its reader makes of it. What is accepted is a message
// again when it is sent on.
#include "service/messages/message.hpp"

#include <concepts>
#include <optional>

#include "apps/onlook/onlook_messages.hpp"
#include "apps/servo_side/wire_settings.hpp"
#include "fuzz_target.hpp"

namespace {

using namespace palpate;

// What comes out of a message goes into one again, and comes out as before.
template <typename Wire, typename Read>
void readAgain(const Wire& wire, Read read) {
  std::optional<decltype(read(wire))> value;
  try {
    value = read(wire);
  } catch (const Error& error) {
    fuzz::require(!error.reason().empty() && !error.remedy().empty(), "a message lacks a part");
    fuzz::verdict = fuzz::Verdict::kRefused;
    return;
  }
  fuzz::mustAccept("what was read is refused", [&] {
    const auto again = read(wireOf(*value));
    // Whoever acts on settings refuses numbers that are none; they equal not even themselves.
    if constexpr (std::equality_comparable<decltype(again)>)
      fuzz::require(again == *value || *value != *value, "it comes out otherwise");
  });
}

void readParts(wire::BodyUnion& body) {
  if (const auto* const ask = contentOf<wire::AskT>(body)) {
    if (ask->view) readAgain(ask->view, viewOf);
    if (ask->settings) readAgain(ask->settings, [](const auto& wire) { return settingsOf(wire); });
    if (ask->before) readAgain(ask->before, [](const auto& wire) { return settingsOf(wire); });
  } else if (const auto* const answer = contentOf<wire::AnswerT>(body)) {
    if (answer->facts) readAgain(answer->facts, factsOf);
    if (answer->looked) readAgain(answer->looked, lookedOf);
    if (answer->refusal) static_cast<void>(errorOf(*answer->refusal));
  } else if (const auto* const change = contentOf<wire::ChangeT>(body)) {
    if (change->settings) readAgain(change->settings, [](const auto& wire) { return settingsOf(wire); });
  } else if (const auto* const loop = contentOf<wire::MakeLoopT>(body)) {
    if (loop->settings) readAgain(loop->settings, [](const auto& wire) { return settingsOf(wire); });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  wire::BodyUnion body;
  if (!fuzz::accepts("the servo", [&] { body = decoded(bytes, "the servo"); })) return 0;
  readParts(body);
  const std::string kind = kindOf(body);
  const std::vector<std::byte> again = encodedBody(std::move(body));
  fuzz::mustAccept("its own bytes are refused", [&] {
    const wire::BodyUnion back = decoded(again, "the servo");
    fuzz::require(kindOf(back) == kind, "it is of another kind when it is sent on");
  });
  return 0;
}
