// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/volume_identity.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "engine/field/brick_values.hpp"

namespace palpate {
namespace {

// A step of MurmurHash3's 64-bit mixing (public domain).
std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) {
  value *= 0x87c37b91114253d5U;
  value = std::rotl(value, 31) * 0x4cf5ad432745937fU;
  return std::rotl(hash ^ value, 27) * 5 + 0x52dce729U;
}

}  // namespace

std::uint64_t contentHash(const Volume& volume) {
  std::uint64_t hash = 0;
  std::array<float, kBrickVoxels> values{};
  const Vec3i bricks = volume.brickCount();
  Vec3i brick;
  for (brick.z() = 0; brick.z() < bricks.z(); ++brick.z()) {
    for (brick.y() = 0; brick.y() < bricks.y(); ++brick.y()) {
      for (brick.x() = 0; brick.x() < bricks.x(); ++brick.x()) {
        if (volume.readBrick(brick, values.data()) || holdOneValue(values)) {
          hash = mixed(hash, std::bit_cast<std::uint32_t>(values[0]));
          continue;
        }
        for (int i = 0; i < kBrickVoxels; i += 2) {
          std::uint64_t pair = 0;
          std::memcpy(&pair, values.data() + i, sizeof pair);
          hash = mixed(hash, pair);
        }
      }
    }
  }
  return mixed(hash, static_cast<std::uint64_t>(bricks.cast<long long>().prod()));
}

std::uint64_t bytesHash(std::string_view bytes) {
  std::uint64_t hash = 0;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof hash) {
    std::uint64_t piece = 0;
    std::memcpy(&piece, bytes.data() + at, std::min(sizeof piece, bytes.size() - at));
    hash = mixed(hash, piece);
  }
  return mixed(hash, bytes.size());
}

VolumeIdentity identityOf(const Volume& volume) {
  std::error_code ignored;
  std::string source = volume.facts().source;
  // "file.vdb#name" is not a file, but like one it is relative to the folder in which the program was started.
  if (!source.starts_with("phantom:") && !source.empty()) source = std::filesystem::absolute(source, ignored).string();
  return {std::move(source), volume.size(), volume.lattice(), contentHash(volume)};
}

std::string differenceFrom(const VolumeIdentity& identity, const Volume& volume) {
  const Vec3i& size = volume.size();
  if (size != identity.size) {
    return fmt::format("it has {} x {} x {} voxels instead of {} x {} x {}", size.x(), size.y(), size.z(),
                       identity.size.x(), identity.size.y(), identity.size.z());
  }
  const Lattice& lattice = volume.lattice();
  if (lattice.spacing_m != identity.lattice.spacing_m) return "its voxels have another size";
  if (lattice.origin_W != identity.lattice.origin_W || lattice.R_WL != identity.lattice.R_WL)
    return "it lies elsewhere in the world";
  if (contentHash(volume) != identity.content) return "its densities are others";
  return "";
}

}  // namespace palpate
