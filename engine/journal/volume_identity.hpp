// SPDX-License-Identifier: Apache-2.0
// engine/journal/volume_identity.hpp: which volume a journal belongs to: where it came from, where it lies, and a hash
// of what it holds. Any thread, while nobody changes the volume.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/lattice.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

struct VolumeIdentity {
  std::string source;          // as loadVolume takes it; files by their absolute path
  Vec3i size = Vec3i::Zero();  // [voxel]
  Lattice lattice;
  std::uint64_t content = 0;  // contentHash()
};

// Of all densities, brick by brick; equal volumes give equal hashes however their bricks are stored. No protection
// against somebody who wants two volumes to look alike. Cost: one pass over the stored bricks, some 0.3 us each.
[[nodiscard]] std::uint64_t contentHash(const Volume& volume);
// The same of any bytes.
[[nodiscard]] std::uint64_t bytesHash(std::string_view bytes);

[[nodiscard]] VolumeIdentity identityOf(const Volume& volume);

// In words, what of `volume` differs from the identity; empty where nothing does. `source` may differ: files move.
[[nodiscard]] std::string differenceFrom(const VolumeIdentity& identity, const Volume& volume);

}  // namespace palpate
