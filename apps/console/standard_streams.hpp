// SPDX-License-Identifier: Apache-2.0
// apps/console/standard_streams.hpp: makes standard input, output and error safe to use, even if they were closed when
// the program was started.
#pragma once

namespace palpate {

// To be called first in main(). If descriptor 0, 1 or 2 is closed, the next file that is opened would take its place,
// and messages would go into that file. So each closed one is opened on /dev/null, but in the direction that is not
// used: reading from a closed input and writing to a closed output still fail, and reach no file.
void openClosedStreams() noexcept;

}  // namespace palpate
