// SPDX-License-Identifier: Apache-2.0
// palpate recover DIR --out FILE: the volume that an editing session had, from its journal.
#include <algorithm>

#include <fmt/format.h>

#include "apps/console/progress.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "engine/journal/replay.hpp"
#include "engine/volume/volume_file.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

struct RecoverArguments {
  std::string folder, out, volume;
};

void checkOut(const std::string& out) {
  if (isVolumeFileName(out)) return;
  throw Error(Error::Code::kBadInput, "--out " + out, "its suffix names no format that volumes are written in",
              fmt::format("use one of {}", kVolumeFileSuffixes));
}

void recover(const RecoverArguments& arguments) {
  checkOut(arguments.out);
  Progress progress;
  progress.stage("reading " + arguments.folder);
  const Journal journal = readJournal(arguments.folder);
  const std::string source = arguments.volume.empty() ? journal.header.volume.source : arguments.volume;
  checkNotInput(source, arguments.out);
  static_cast<void>(AtomicFile(arguments.out));  // a folder that may not be written is refused before the long part
  progress.stage("loading " + source);
  Volume volume = loadVolume(source);
  progress.stage("applying the edits");
  replay(journal, volume);
  progress.stage("writing " + arguments.out);
  saveVolume(volume, arguments.out);
  progress.done();
  fmt::print("Journal   {} edits, of which {} last; newest record {}\n",
             std::count_if(journal.records.begin(), journal.records.end(),
                           [](const JournalRecord& record) { return record.kind == RecordKind::kEdit; }),
             lastingEdits(journal).size(), journal.last_sequence);
  if (journal.damage) fmt::print("Lost      {}\n", damageWords(*journal.damage));
  fmt::print("Volume    {}, content {:016x}\nFile      {}\n", source, contentHash(volume), arguments.out);
}

}  // namespace

void addRecoverVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("recover", "make the volume of an editing session from its journal");
  verb->footer(
      "A journal is what 'palpate touch --edit ... --journal DIR' keeps. The volume is the session's, bit for bit, up "
      "to "
      "the\nlast edit that reached the disk. Example: palpate recover DIR --out sculpted.vdb");
  auto arguments = std::make_shared<RecoverArguments>();
  verb->add_option("journal", arguments->folder, "folder that --journal was given")->required()->type_name("DIR");
  verb->add_option("--out", arguments->out, "file to write: .vdb .nii .nii.gz .nrrd .mha")
      ->required()
      ->type_name("FILE");
  verb->add_option("--volume", arguments->volume, "where the session's volume lies now, if it has moved")
      ->type_name("VOLUME");
  verb->callback([arguments] { recover(*arguments); });
}

}  // namespace palpate
