// SPDX-License-Identifier: Apache-2.0
// apps/palpate/start_window.hpp: goes over to the program with the window. It is one of its own, so that no other verb
// loads the libraries of a desktop.
#pragma once

namespace palpate {

// Replaces this process by `palpate-sculpt`, from the same folder, with the same words. Throws Error(kNotFound) where
// it is not there.
[[noreturn]] void startWindow();

}  // namespace palpate
