// SPDX-License-Identifier: Apache-2.0
// palpate recover DIR --out FILE: the volume that an editing session had, from its journal.
#include <algorithm>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/convert/convert_job.hpp"
#include "apps/load/load_and_tell.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "base/error.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/recovery.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

struct RecoverArguments {
  std::string folder, out, volume;
};

// A journal's file may be given in place of its folder. One of another name was put aside, or is a copy.
struct Given {
  std::string folder;
  std::string put_aside;  // empty: the folder's own
};
Given journalOf(const std::string& given) {
  const std::filesystem::path path(given);
  std::error_code ignored;
  const bool is_named = path.filename() == kJournalName && !std::filesystem::is_directory(path, ignored);
  const bool is_file = std::filesystem::is_regular_file(path, ignored);
  if (!is_named && !is_file) return {countingJournal(given).string(), {}};
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  return is_named ? Given{countingJournal(folder).string(), {}} : Given{folder, given};
}

Volume loadStart(const RecoverArguments& arguments, const std::string& source, Progress& progress) {
  try {
    return loadAndTell(source, progress);
  } catch (const Error& error) {
    if (!arguments.volume.empty()) throw;
    throw Error(error.code(), error.input(), error.reason(),
                "the journal names it as the session's volume: if that has moved, say where it lies now with --volume");
  }
}

std::string editsInWords(const Journal& journal, const Recovered& found) {
  const std::size_t in_effect = found.held.edits + found.edits.size();
  if (found.begins_with_bricks)
    return fmt::format("{} edit{} in effect; newest record {}", in_effect, in_effect == 1 ? "" : "s", found.sequence);
  const auto edits = std::count_if(journal.records.begin(), journal.records.end(),
                                   [](const JournalRecord& record) { return !record.commands.empty(); });
  return fmt::format("{} edit{}, {} undone; newest record {}", edits, edits == 1 ? "" : "s",
                     edits - static_cast<std::ptrdiff_t>(in_effect), journal.last_sequence);
}

void recover(const RecoverArguments& arguments) {
  const auto& [folder, put_aside] = journalOf(arguments.folder);
  ConvertRequest output{.in = folder, .out = arguments.out};
  checkOutput(output);
  Progress progress;
  progress.stage("reading " + (put_aside.empty() ? folder : put_aside));
  const Journal journal = put_aside.empty() ? readJournal(folder) : readJournalFile(put_aside);
  const std::string source = arguments.volume.empty() ? journal.header.volume.source : arguments.volume;
  checkNotInput(source, arguments.out);
  AtomicFile file(arguments.out, Rights::kPrivate);
  progress.stage("loading " + source);
  Volume volume = loadStart(arguments, source, progress);
  checkStart(journal, volume, source);
  progress.stage("applying the edits");
  const Recovered found = recoverSession(journal, checkpointFolder(folder), volume);
  makeEdits(found.edits, journal.header.profile, volume, [&](double done) {
    throwIfInterrupted("palpate recover");
    progress.fraction(done);
  });
  volume.keepIsovalue(journal.header.profile.isovalue);
  if (isMeshFileName(arguments.out)) output.isovalue = journal.header.profile.isovalue;
  static_cast<void>(writeOutput(volume, output, "palpate recover", file, progress));
  file.commit();
  progress.done();
  printResult("Journal   {}\n", editsInWords(journal, found));
  if (!found.loss.empty()) {
    printResult("Lost      {}\n", found.loss);
    tellUser(fmt::format("{}; {} holds what could be read", found.loss, arguments.out));
  }
  printResult("Volume    {}, content {:016x}\nFile      {}\n", source, contentHash(volume), arguments.out);
  const std::string surface = surfaceWords(arguments.out, journal.header.profile.isovalue);
  if (!surface.empty()) printResult("Surface   {}", surface);
  // The volume was written, but the exit status tells that edits are missing.
  if (!found.loss.empty()) throw CLI::RuntimeError(exitStatus(Error::Code::kIo));
}

}  // namespace

void addRecoverVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("recover", "make the volume of an editing session from its journal");
  verb->footer(
      "A journal is what --journal DIR of 'palpate touch --edit' and 'palpate edit' keeps. "
      "The volume is the session's, bit\nfor bit, up to the last edit that reached the disk. "
      "Example: palpate recover DIR --out sculpted.vdb");
  auto arguments = std::make_shared<RecoverArguments>();
  verb->add_option("journal", arguments->folder, "folder that --journal was given, or the file in it")
      ->required()
      ->type_name("DIR");
  verb->add_option("--out", arguments->out,
                   fmt::format("the volume: {}; or its isosurface: {}", volumeFileSuffixes(), kMeshFileSuffixes))
      ->required()
      ->type_name("FILE");
  verb->add_option("--volume", arguments->volume, "where the session's volume lies now, if it has moved")
      ->type_name("VOLUME")
      ->check(notEmpty);
  addVolumeOptions(*verb, arguments->volume);
  verb->callback([arguments] { recover(*arguments); });
}

}  // namespace palpate
