// SPDX-License-Identifier: Apache-2.0
// A message of one process of a service to another. What is accepted is a message again when it is sent on.
#include "service/messages/message.hpp"

#include "fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace palpate;
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  wire::BodyUnion body;
  if (!fuzz::accepts("the servo", [&] { body = decoded(bytes, "the servo"); })) return 0;
  const std::string kind = kindOf(body);
  const std::vector<std::byte> again = encodedBody(std::move(body));
  fuzz::mustAccept("its own bytes are refused", [&] {
    const wire::BodyUnion back = decoded(again, "the servo");
    fuzz::require(kindOf(back) == kind, "it is of another kind when it is sent on");
  });
  return 0;
}
