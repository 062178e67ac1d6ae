// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/checkpoint.hpp"

#include <algorithm>
#include <exception>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/atomic_file.hpp"
#include "base/byte_size.hpp"
#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "base/whole_file.hpp"
#include "engine/journal/kept_bricks.hpp"

namespace palpate {

namespace fs = std::filesystem;

fs::path checkpointFile(const fs::path& folder, std::size_t number) {
  return folder / fmt::format("checkpoint-{}.palpate", number);
}

namespace {

constexpr std::string_view kMagic = "PALPCHKP";
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kHeadBytes = 44;  // magic, version, head

struct Content {
  CheckpointHead head;
  KeptBricks bricks;
};

std::optional<CheckpointHead> headIn(ByteReader& in) {
  std::uint32_t version = 0;
  CheckpointHead head;
  if (in.getRaw(kMagic.size()) != kMagic) return std::nullopt;
  in.get(version);
  in.get(head.mark.edits);
  in.get(head.mark.hash);
  in.get(head.journal);
  in.get(head.sequence);
  return in.good() && version == kVersion ? std::optional(head) : std::nullopt;
}

// Everything is checked before anything is used. Empty: it is no checkpoint, or a damaged one.
std::optional<Content> contentOf(std::string_view bytes) {
  std::uint32_t count = 0, checksum = 0;
  if (bytes.size() < sizeof checksum) return std::nullopt;
  ByteReader end(bytes.substr(bytes.size() - sizeof checksum));
  end.get(checksum);
  bytes.remove_suffix(sizeof checksum);
  if (crc32c(bytes) != checksum) return std::nullopt;
  ByteReader in(bytes);
  const std::optional<CheckpointHead> head = headIn(in);
  if (!head) return std::nullopt;
  Content content{*head, {}};
  in.get(count);
  return getBricks(in, count, content.bricks) && in.atEnd() ? std::optional(std::move(content)) : std::nullopt;
}

using Heads = std::array<std::optional<CheckpointHead>, kCheckpoints>;

// What the files say that they are.
Heads headsIn(const fs::path& folder) {
  Heads heads;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    std::error_code ignored;
    if (!fs::is_regular_file(checkpointFile(folder, i), ignored)) continue;
    std::ifstream file(checkpointFile(folder, i), std::ios::binary);
    std::string head(kHeadBytes, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    ByteReader in(std::string_view(head).substr(0, static_cast<std::size_t>(file.gcount())));
    heads[i] = headIn(in);
  }
  return heads;
}

// Empty: it cannot be read, or not into memory.
std::string bytesOf(const fs::path& file) {
  try {
    return wholeFile(file, "the checkpoint");
  } catch (const std::exception&) {
    return {};
  }
}

bool isReached(const EditMark& mark, const EditMark& start, std::span<const LastingEdit> edits) {
  if (mark.edits < start.edits || mark.edits - start.edits > edits.size()) return false;
  return trailAfter(start, edits.first(mark.edits - start.edits)).mark() == mark;
}

// Puts the file into the volume if it is whole, fits, and is what its head said. Returns the bricks.
std::optional<std::vector<std::uint32_t>> put(const fs::path& file, const CheckpointHead& head, Volume& volume) {
  std::optional<Content> content = contentOf(bytesOf(file));
  if (!content || content->head.mark != head.mark || !fit(content->bricks, volume)) return std::nullopt;
  putBricks(content->bricks, volume);
  return std::move(content->bricks.bricks);
}

}  // namespace

void writeCheckpoint(const fs::path& file, const CheckpointHead& head, const Volume& volume,
                     std::span<const std::uint32_t> bricks) {
  AtomicFile target(file, Rights::kPrivate);
  std::uint32_t checksum = 0;
  const auto write = [&](const ByteWriter& out) {
    checksum = crc32c(out.bytes(), checksum);
    target.write(out.bytes());
  };
  ByteWriter begin;
  begin.addRaw(kMagic);
  begin.add(kVersion);
  begin.add(head.mark.edits);
  begin.add(head.mark.hash);
  begin.add(head.journal);
  begin.add(head.sequence);
  begin.add(static_cast<std::uint32_t>(bricks.size()));
  write(begin);
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  for (const std::uint32_t brick : bricks) {
    ByteWriter out;
    addBrick(out, volume, grid, brick);
    write(out);
  }
  ByteWriter end;
  end.add(checksum);
  target.write(end.bytes());
  target.commit();
}

std::uint64_t roomFor(std::size_t bricks) noexcept {
  constexpr std::uint64_t kForJournals = std::uint64_t{64} << 20U;
  return 2 * sizeof(float) * std::uint64_t{kBrickVoxels} * bricks + kForJournals;
}

void checkRoomFor(const fs::path& folder, std::size_t bricks) {
  std::error_code unknown;
  const fs::space_info space = fs::space(folder, unknown);
  if (unknown || space.available >= roomFor(bricks)) return;
  throw Error(Error::Code::kIo, folder.string(),
              fmt::format("there is room for {} there, and a checkpoint is not to take it from the journal",
                          bytesInWords(space.available)),
              "make room");
}

Headstart putCheckpoint(const fs::path& folder, const EditMark& start, std::span<const LastingEdit> edits,
                        Volume& volume) {
  Heads heads = headsIn(folder);
  Headstart held{.edits = start.edits, .bricks = {}, .good = {}};
  std::array<std::size_t, kCheckpoints> order{0, 1};
  for (const std::size_t i : order) {
    if (heads[i] && isReached(heads[i]->mark, start, edits)) held.good[i] = heads[i]->mark;
  }
  std::ranges::sort(order, {}, [&](std::size_t i) { return held.good[i] ? held.good[i]->edits : 0; });
  for (const std::size_t number : order) {
    if (!held.good[number]) continue;
    if (auto bricks = put(checkpointFile(folder, number), *heads[number], volume)) {
      held.edits = held.good[number]->edits;
      held.bricks = std::move(*bricks);
      return held;
    }
    held.good[number].reset();
  }
  return held;
}

std::optional<BeyondDamage> putCheckpointBeyond(const fs::path& folder, const JournalHeader& header,
                                                std::uint64_t sequence, Volume& volume) {
  if (header.id == 0) return std::nullopt;
  const Heads heads = headsIn(folder);
  std::array<std::size_t, kCheckpoints> order{0, 1};
  std::ranges::sort(order, std::greater<>(), [&](std::size_t i) { return heads[i] ? heads[i]->sequence : 0; });
  for (const std::size_t number : order) {
    if (!heads[number] || heads[number]->journal != header.id || heads[number]->sequence <= sequence) continue;
    if (auto bricks = put(checkpointFile(folder, number), *heads[number], volume))
      return BeyondDamage{*heads[number], number, std::move(*bricks)};
  }
  return std::nullopt;
}

void removeCheckpoints(const fs::path& folder) noexcept {
  std::error_code ignored;
  for (std::size_t i = 0; i < kCheckpoints; ++i) fs::remove(checkpointFile(folder, i), ignored);
}

}  // namespace palpate
