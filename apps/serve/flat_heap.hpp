// SPDX-License-Identifier: Apache-2.0
// apps/serve/flat_heap.hpp: how a process that runs for days gives back the memory that it has freed.
//
// glibc's allocator grows its own thresholds with the blocks that a program frees, and has a heap for each thread: a
// service that saves, draws and makes engines anew then keeps what it needed once, torn into pieces. Measured on a
// sphere of 32 voxels: 130 MiB after six minutes of that in place of 80. The drivers' memory is in the same heap. Does
// nothing with another allocator.
#pragma once

namespace palpate {

// Large blocks are the system's, and so again when they are freed; few heaps for all threads. Before other threads
// begin.
void keepHeapFlat() noexcept;

// What is free goes back to the system. Some milliseconds; meanwhile who allocates waits. Any thread.
void giveFreeHeapBack() noexcept;

}  // namespace palpate
