// SPDX-License-Identifier: Apache-2.0
// palpate edit IN OUT: every edit, undo and redo, from the command line or a script.
#include <fmt/format.h>

#include "apps/console/document.hpp"
#include "apps/console/message.hpp"
#include "apps/edit/edit_words.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/json_text.hpp"
#include "engine/edit/edit_keys.hpp"
#include "engine/files/volume_file.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

struct EditArguments {
  EditRequest request;
  std::string history, gpu_memory;
};

// The JSON file must not be the output volume. (editVolume() checks the inputs.)
void checkJson(const EditArguments& arguments) {
  if (arguments.request.json.empty()) return;
  if (!arguments.request.out.empty() && sameFile(arguments.request.json, arguments.request.out))
    throw Error(Error::Code::kBadInput, "--json " + arguments.request.json, "it is the output", "give another name");
  checkWritable(arguments.request.json);
}

void edit(EditArguments& arguments) {
  EditRequest& request = arguments.request;
  if (!arguments.history.empty()) request.history_bytes = byteSize(arguments.history, "--history");
  if (!arguments.gpu_memory.empty()) request.gpu_memory_bytes = byteSize(arguments.gpu_memory, "--gpu-memory");
  checkJson(arguments);
  Progress progress;
  const EditResult result = editVolume(request, progress, [&](const std::string& message) {
    progress.done();
    tellUser(message);
  });
  if (!arguments.request.json.empty())
    writeFileAtomically(arguments.request.json, jsonFileText(editJson(request, result)));
  printText(editWords(request, result));
  // The volume was written, and the failure reported. But the user relies on the journal, so the exit status tells too.
  if (result.journal_saved < result.journal_records) throw CLI::RuntimeError(exitStatus(Error::Code::kIo));
}

}  // namespace

void addEditVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("edit", "apply edits, undo and redo to a volume and save it");
  verb->footer(
      R"(A command is a kind and keys: remove:radius=2mm:at=10,20,30 (mm, world); or undo, redo. 'palpate edit --commands'
lists all, docs/edits.md explains them. --do comes before --script.
Example: palpate edit phantom:head head.vdb --do remove:radius=12mm:at=0,-80,0 --do undo)");
  auto arguments = std::make_shared<EditArguments>();
  EditRequest& request = arguments->request;
  verb->add_option("in", request.in, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option("out", request.out,
                   fmt::format("the edited volume: {}; or its isosurface: {}", volumeFileSuffixes(), kMeshFileSuffixes))
      ->required();
  verb->add_option("--do", request.commands, "a command; as often as wanted, in this order")
      ->type_name("COMMAND")
      ->allow_extra_args(false);  // the next word may be a volume
  verb->add_option("--script", request.script,
                   "commands from a file, one a line, # begins a comment; -: standard input")
      ->type_name("FILE")
      ->check(notEmpty);
  verb->add_option("--iso", request.isovalue, "isovalue of the surface [density]; as `palpate touch` chooses it");
  verb->add_option("--gpu", request.gpu, "part of the Vulkan device's name; the best one if not given");
  verb->add_option("--journal", request.journal, "keep every edit on disk in this folder (docs/journal.md)")
      ->type_name("DIR")
      ->check(notEmpty);
  verb->add_option("--history", arguments->history, "memory for undo, 0: none (default 256MiB)")->type_name("SIZE");
  verb->add_option("--gpu-memory", arguments->gpu_memory,
                   "most that densities and samples may take on the GPU, 0: what it has (default 0)")
      ->type_name("SIZE");
  verb->add_flag("--keep-going", request.keep_going, "tell of a command that is refused, leave it out and go on");
  verb->add_option("--json", request.json, "write the result into this file too")->type_name("FILE")->check(notEmpty);
  verb->add_flag_callback(
          "--commands",
          [] {
            printDocument(editTextTable());
            throw CLI::Success();
          },
          "list the kinds of edits and their keys")
      ->trigger_on_parse();
  addVolumeOptions(*verb, request.in);
  verb->callback([arguments] { edit(*arguments); });
}

}  // namespace palpate
