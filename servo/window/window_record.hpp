// SPDX-License-Identifier: Apache-2.0
// servo/window/window_record.hpp: a window's placement as it lies in the exchange: plain bytes of a fixed layout, so
// that engine and servo may be two processes.
//
// Frames W, L and units as in sample_window.hpp. Whoever changes the layout counts kLinkLayout up
// (service/memory/link_memory.hpp refuses another one). Any thread; no heap.
#pragma once

#include <cstdint>
#include <type_traits>

#include "servo/window/confirmation.hpp"
#include "servo/window/sample_window.hpp"
#include "servo/window/triple_buffer.hpp"

namespace palpate {

struct WindowRecord {
  double origin_W[3] = {};   // Lattice::origin_W [m]
  double axes_WL[9] = {};    // Lattice::R_WL, column by column [-]
  double spacing_m[3] = {};  // [m]
  std::int32_t size[3] = {};
  std::uint8_t low_is_border[3] = {}, high_is_border[3] = {};  // 0 or 1
  std::uint8_t unused[6] = {};
  std::uint64_t version = 0, edit_version = 0;
  std::int64_t stamp_ns = 0;
};
static_assert(std::is_trivially_copyable_v<WindowRecord> && sizeof(WindowRecord) == 168);

// What both sides of a window exchange see beside the samples.
struct WindowBlock {
  TripleBlock<WindowRecord> windows;
  Confirmation<> confirmation;
};
static_assert(std::is_trivially_copyable_v<WindowRecord> && sizeof(WindowBlock) == 3 * 192 + 64 + 64);

[[nodiscard]] WindowRecord recordOf(const SampleWindow& window) noexcept;

// The window of a record, its samples at `samples`, of which there are `capacity`. A record that no engine writes (a
// size that does not fit, a lattice that is none) gives a window that is not usable, with its version and times.
// `record` is a copy of its own: the other side may write on.
[[nodiscard]] SampleWindow windowOf(const WindowRecord& record, const Sample* samples, std::size_t capacity) noexcept;

}  // namespace palpate
