// SPDX-License-Identifier: Apache-2.0
// Checkpoints. Almost every change breaks the checksum or the mark. So each input is read as it is, and again with a
// sound beginning and end, so that only what is between is wrong. What is put into a volume must be there, and come
// back from a checkpoint of that volume; what is refused must leave the volume alone.
#include "engine/journal/checkpoint.hpp"

#include <vector>

#include "base/crc32c.hpp"
#include "engine/journal/byte_stream.hpp"
#include "fuzz_target.hpp"
#include "scratch_file.hpp"

namespace {

using namespace palpate;

constexpr std::size_t kBeforeMark = 12, kHead = 44;

const fuzz::ScratchFile& checkpointScratch() {
  static const fuzz::ScratchFile kFile(checkpointFile("", 0).string());
  return kFile;
}

Volume plainVolume() {
  const std::vector<float> values(20 * 16 * 9, 5);
  return Volume::fromDense({20, 16, 9}, {}, values, {});
}

JournalHeader plainHeader() {
  JournalHeader header;
  header.volume.size = {20, 16, 9};
  header.profile = brushProfile(30, -100, 200, Vec3::Constant(1e-3));
  return header;
}

// Of a journal without edits, so that every start leads through it.
std::string withSoundEnds(std::string_view bytes) {
  const EditMark mark = *EditTrail(plainHeader()).mark();
  ByteWriter sound;
  sound.addRaw("PALPCHKP");
  sound.add(std::uint32_t{2});
  sound.add(mark.edits);
  sound.add(mark.hash);
  sound.add(std::uint64_t{0});
  sound.add(std::uint64_t{0});
  if (bytes.size() > kHead + 4) sound.addRaw(bytes.substr(kHead, bytes.size() - kHead - 4));
  ByteWriter end;
  end.add(crc32c(sound.bytes()));
  return sound.bytes() + end.bytes();
}

Headstart put(std::string_view bytes, Volume& volume) {
  checkpointScratch().write(bytes);
  return putCheckpoint(checkpointScratch().folder(), *EditTrail(plainHeader()).mark(), {}, volume);
}

bool check(const std::string& bytes) {
  Volume volume = plainVolume();
  const std::uint64_t untouched = contentHash(volume);
  const Headstart held = put(bytes, volume);
  if (!held.good[0]) {
    fuzz::require(held.bricks.empty() && contentHash(volume) == untouched, "what is refused has left something");
    return false;
  }
  fuzz::require(bytes.size() > kBeforeMark && held.edits == 0, "it is of edits that were never made");
  writeCheckpoint(checkpointScratch().path(), {*held.good[0], 0, 0}, volume, held.bricks);
  Volume again = plainVolume();
  const Headstart kept = putCheckpoint(checkpointScratch().folder(), *EditTrail(plainHeader()).mark(), {}, again);
  fuzz::require(kept.good == held.good && kept.bricks == held.bricks && contentHash(again) == contentHash(volume),
                "it comes back otherwise");
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = fuzz::textOf(data, size);
  static_cast<void>(check(bytes));
  fuzz::verdict = check(withSoundEnds(bytes)) ? fuzz::Verdict::kAccepted : fuzz::Verdict::kRefused;
  return 0;
}
