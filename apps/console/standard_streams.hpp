// SPDX-License-Identifier: Apache-2.0
// apps/console/standard_streams.hpp: standard input, output and error as the program finds them, whatever state its
// starter left them in.
#pragma once

namespace palpate {

// The first thing that the program does. Where descriptor 0, 1 or 2 is closed, the first file that is opened would take
// its place, and every message would go into that file. So each is opened on /dev/null, in the direction in which it is
// not used: reading from a closed input and writing to a closed output fail, as they should, and reach no file.
void openClosedStreams() noexcept;

}  // namespace palpate
