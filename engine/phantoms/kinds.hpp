// SPDX-License-Identifier: Apache-2.0
// engine/phantoms/kinds.hpp: a function for each phantom that makes it. The registry in phantom_spec.cpp lists them.
// Private to engine/phantoms.
#pragma once

#include <memory>

#include "engine/phantoms/phantom.hpp"

namespace palpate {

[[nodiscard]] std::unique_ptr<Phantom> makeSphere(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeBox(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeSpheres(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeShell(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeKnot(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeGyroid(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeHead(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeLung(const PhantomSpec& spec);
[[nodiscard]] std::unique_ptr<Phantom> makeRandom(const PhantomSpec& spec);

}  // namespace palpate
