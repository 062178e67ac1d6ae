// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/checkpoint.hpp"

#include <algorithm>
#include <cstring>
#include <exception>
#include <fstream>
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
#include "engine/bricks/brick_grid.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/journal/byte_stream.hpp"

namespace palpate {

namespace fs = std::filesystem;

fs::path checkpointFile(const fs::path& folder, std::size_t number) {
  return folder / fmt::format("checkpoint-{}.palpate", number);
}

namespace {

constexpr std::string_view kMagic = "PALPCHKP";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeadBytes = 28;  // magic, version, mark

struct Content {
  EditMark mark;
  std::vector<std::uint32_t> bricks;
  std::vector<std::string_view> values;  // of each: as many bytes as one density has, or a brick
};

std::string_view bytesOf(std::span<const float> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

std::optional<EditMark> markIn(ByteReader& in) {
  std::uint32_t version = 0;
  EditMark mark;
  if (in.getRaw(kMagic.size()) != kMagic) return std::nullopt;
  in.get(version);
  in.get(mark.edits);
  in.get(mark.hash);
  return in.good() && version == kVersion ? std::optional(mark) : std::nullopt;
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
  const std::optional<EditMark> mark = markIn(in);
  if (!mark) return std::nullopt;
  Content content{*mark, {}, {}};
  in.get(count);
  for (std::uint32_t i = 0; i < count && in.good(); ++i) {
    std::uint32_t brick = 0, values = 0;
    in.get(brick);
    in.get(values);
    if (values != 1 && values != kBrickVoxels) return std::nullopt;
    if (i > 0 && brick <= content.bricks.back()) return std::nullopt;
    content.bricks.push_back(brick);
    content.values.push_back(in.getRaw(values * sizeof(float)));
  }
  return in.atEnd() ? std::optional(std::move(content)) : std::nullopt;
}

// What the files say that they are.
CheckpointMarks marksIn(const fs::path& folder) {
  CheckpointMarks marks;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    std::error_code ignored;
    if (!fs::is_regular_file(checkpointFile(folder, i), ignored)) continue;
    std::ifstream file(checkpointFile(folder, i), std::ios::binary);
    std::string head(kHeadBytes, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    ByteReader in(std::string_view(head).substr(0, static_cast<std::size_t>(file.gcount())));
    marks[i] = markIn(in);
  }
  return marks;
}

// Empty: it cannot be read, or not into memory.
std::string bytesOf(const fs::path& file) {
  try {
    return wholeFile(file, "the checkpoint", std::numeric_limits<std::uint64_t>::max() - 1);
  } catch (const std::exception&) {
    return {};
  }
}

bool isReached(const EditMark& mark, const JournalHeader& header, std::span<const LastingEdit> edits) {
  if (mark.edits > edits.size()) return false;
  EditTrail trail(header);
  for (const LastingEdit& edit : edits.first(mark.edits)) {
    trail.edit(edit.commands, false);
    trail.forgetAllBut(0);
  }
  return trail.mark() == mark;
}

}  // namespace

void writeCheckpoint(const fs::path& file, const EditMark& mark, const Volume& volume,
                     std::span<const std::uint32_t> bricks) {
  AtomicFile target(file, Rights::kPrivate);
  std::uint32_t checksum = 0;
  const auto write = [&](const ByteWriter& out) {
    checksum = crc32c(out.bytes(), checksum);
    target.write(out.bytes());
  };
  ByteWriter head;
  head.addRaw(kMagic);
  head.add(kVersion);
  head.add(mark.edits);
  head.add(mark.hash);
  head.add(static_cast<std::uint32_t>(bricks.size()));
  write(head);
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  std::array<float, kBrickVoxels> values{};
  for (const std::uint32_t brick : bricks) {
    const bool is_constant = volume.readBrick(grid.brick(brick), values.data()) || holdOneValue(values);
    const std::span<const float> kept = std::span(values).first(is_constant ? 1 : kBrickVoxels);
    ByteWriter out;
    out.add(brick);
    out.add(static_cast<std::uint32_t>(kept.size()));
    out.addRaw(bytesOf(kept));
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

Headstart putCheckpoint(const fs::path& folder, const JournalHeader& header, std::span<const LastingEdit> edits,
                        Volume& volume) {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  Headstart start{.edits = 0, .bricks = {}, .good = marksIn(folder)};
  CheckpointMarks& marks = start.good;
  for (std::optional<EditMark>& mark : marks) {
    if (mark && !isReached(*mark, header, edits)) mark.reset();
  }
  std::array<std::size_t, kCheckpoints> order{0, 1};
  std::ranges::sort(order, {}, [&](std::size_t i) { return marks[i] ? marks[i]->edits : 0; });
  for (const std::size_t number : order) {
    if (!marks[number]) continue;
    const std::string bytes = bytesOf(checkpointFile(folder, number));
    std::optional<Content> content = contentOf(bytes);
    if (!content || content->mark != *marks[number] ||
        (!content->bricks.empty() && content->bricks.back() >= grid.brickCount())) {
      marks[number].reset();
      continue;
    }
    for (std::size_t i = 0; i < content->bricks.size(); ++i) {
      std::array<float, kBrickVoxels> values{};
      const std::string_view from = content->values[i];
      std::memcpy(values.data(), from.data(), from.size());
      putBrick(volume, grid.brick(content->bricks[i]), std::span(values).first(from.size() / sizeof(float)));
    }
    start.edits = content->mark.edits;
    start.bricks = std::move(content->bricks);
    return start;
  }
  return start;
}

void removeCheckpoints(const fs::path& folder) noexcept {
  std::error_code ignored;
  for (std::size_t i = 0; i < kCheckpoints; ++i) fs::remove(checkpointFile(folder, i), ignored);
}

}  // namespace palpate
