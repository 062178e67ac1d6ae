// SPDX-License-Identifier: Apache-2.0
// engine/journal/volume_identity.hpp: identifies the volume that a journal belongs to, by its source, its place in the
// world and a hash of its densities. Any thread, while nobody changes the volume.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/lattice.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

struct VolumeIdentity {
  std::string source;          // the name that loadVolume takes; of a file, its absolute path
  Vec3i size = Vec3i::Zero();  // [voxel]
  Lattice lattice;
  std::uint64_t content = 0;  // contentHash()
};

// Hash of all densities, brick by brick. Equal volumes give equal hashes, however their bricks are stored. It is not
// cryptographic: collisions can be made on purpose. Cost: one pass over the stored bricks, some 0.3 us each.
[[nodiscard]] std::uint64_t contentHash(const Volume& volume);
// A hash of the same kind, of any bytes.
[[nodiscard]] std::uint64_t bytesHash(std::string_view bytes);

[[nodiscard]] VolumeIdentity identityOf(const Volume& volume);

// How `volume` differs from the identity, as text; empty if it does not. Sources are not compared, since files move.
[[nodiscard]] std::string differenceFrom(const VolumeIdentity& identity, const Volume& volume);

}  // namespace palpate
