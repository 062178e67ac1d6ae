// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/attachments.hpp: what is too long for a message, in sealed memory that is attached to one: a way, a
// mesh, the records of a run.
//
// Values lie one after another, as they are in memory; both processes are the same program. Counts come with the
// message. Set-up code; any thread. Throws as SealedMemory does.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "base/triangle_mesh.hpp"
#include "base/vec.hpp"
#include "service/memory/sealed_memory.hpp"
#include "servo/devices/path.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

[[nodiscard]] SealedMemory wayMemory(const SampledPath& way);
[[nodiscard]] SampledPath wayOf(Descriptor memory, std::uint64_t points, bool is_linear);

[[nodiscard]] SealedMemory meshMemory(const TriangleMesh& mesh);
[[nodiscard]] TriangleMesh meshOf(Descriptor memory, std::uint64_t vertices, std::uint64_t triangles);

struct RunRecords {
  std::vector<TickRecord> ticks;
  std::string recording;  // as bytes (servo/devices/recording.hpp); empty: none
};
[[nodiscard]] SealedMemory recordsMemory(const RunRecords& records);
[[nodiscard]] RunRecords recordsOf(Descriptor memory, std::uint64_t ticks, std::uint64_t recording_bytes);

// Of a tick that another process told: whether its numbers are those of a servo. Its flags are mended.
[[nodiscard]] bool makeSound(TickRecord& record) noexcept;

}  // namespace palpate
