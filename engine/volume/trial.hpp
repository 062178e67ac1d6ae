// SPDX-License-Identifier: Apache-2.0
// engine/volume/trial.hpp: work done in a child process first, to see whether it survives. Private to engine/volume.
//
// Debian builds GDCM with its assertions on, so a damaged DICOM file ends the process instead of raising an error; only
// another process can find that out. POSIX. Call it from a set-up thread while no other thread loads a volume.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

namespace palpate {

// Runs work(0) to work(count - 1) in a child process and returns the first n that kills it or takes longer than a
// minute. What work throws, prints or changes stays in the child. Nothing is returned, too, where no process can be
// made: the work then goes untried. Cost: a fork, and the work itself.
[[nodiscard]] std::optional<std::size_t> firstFatal(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace palpate
