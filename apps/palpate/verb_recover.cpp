// SPDX-License-Identifier: Apache-2.0
// palpate recover DIR --out FILE: the volume that an editing session had, from its journal.
#include <algorithm>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/convert/convert_job.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "engine/journal/replay.hpp"
#include "engine/volume/volume_file.hpp"
#include "verbs.hpp"

namespace palpate {
namespace {

struct RecoverArguments {
  std::string folder, out, volume;
};

void recover(const RecoverArguments& arguments) {
  ConvertRequest output{.in = arguments.folder, .out = arguments.out};
  checkOutput(output);
  Progress progress;
  progress.stage("reading " + arguments.folder);
  const Journal journal = readJournal(arguments.folder);
  const std::string source = arguments.volume.empty() ? journal.header.volume.source : arguments.volume;
  checkNotInput(source, arguments.out);
  AtomicFile file(arguments.out);
  progress.stage("loading " + source);
  Volume volume = loadVolume(source);
  progress.stage("applying the edits");
  replay(journal, volume, [&](double done) {
    throwIfInterrupted("palpate recover");
    progress.fraction(done);
  });
  if (isMeshFileName(arguments.out)) output.isovalue = journal.header.profile.isovalue;
  static_cast<void>(writeOutput(volume, output, "palpate recover", file, progress));
  file.commit();
  progress.done();
  fmt::print("Journal   {} edits, of which {} last; newest record {}\n",
             std::count_if(journal.records.begin(), journal.records.end(),
                           [](const JournalRecord& record) { return record.kind == RecordKind::kEdit; }),
             lastingEdits(journal).size(), journal.last_sequence);
  if (journal.damage) {
    fmt::print("Lost      {}\n", damageWords(*journal.damage));
    // For who looks at errors only: the status is 0, there is a volume.
    fmt::print(stderr, "palpate: {}: {}; {} holds what is before them\n", arguments.folder,
               damageWords(*journal.damage), arguments.out);
  }
  fmt::print("Volume    {}, content {:016x}\nFile      {}\n", source, contentHash(volume), arguments.out);
}

}  // namespace

void addRecoverVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("recover", "make the volume of an editing session from its journal");
  verb->footer(
      "A journal is what --journal DIR of 'palpate touch --edit' and 'palpate edit' keeps. The volume is the "
      "session's, "
      "bit\nfor bit, up to the last edit that reached the disk. Example: palpate recover DIR --out sculpted.vdb");
  auto arguments = std::make_shared<RecoverArguments>();
  verb->add_option("journal", arguments->folder, "folder that --journal was given")->required()->type_name("DIR");
  verb->add_option("--out", arguments->out,
                   "the volume: .vdb .nii .nii.gz .nrrd .mha; or its isosurface: .stl .obj .ply")
      ->required()
      ->type_name("FILE");
  verb->add_option("--volume", arguments->volume, "where the session's volume lies now, if it has moved")
      ->type_name("VOLUME");
  verb->callback([arguments] { recover(*arguments); });
}

}  // namespace palpate
