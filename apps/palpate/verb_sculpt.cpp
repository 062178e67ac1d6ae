// SPDX-License-Identifier: Apache-2.0
// palpate sculpt IN: a window in which a volume is seen, touched and edited.
#include "apps/console/message.hpp"
#include "apps/sculpt/sculpt_session.hpp"
#include "verbs.hpp"
#include "volume_options.hpp"

namespace palpate {

void addSculptVerb(CLI::App& app, std::function<void(const SculptRequest&)> run) {
  CLI::App* verb = app.add_subcommand("sculpt", "see, touch and edit a volume in a window");
  verb->footer(
      "Left button: stroke; right: turn; Shift + right: move; wheel: zoom; F: size; Ctrl+Z: undo.\n"
      "Without a display use 'palpate touch' and 'palpate render'. docs/sculpt.md explains the window");
  auto request = std::make_shared<SculptRequest>();
  verb->add_option("in", request->volume, "file, DICOM folder or 'phantom:NAME?size=64'")->required();
  verb->add_option("--iso", request->isovalue,
                   "isovalue of the surface [density]; as `palpate touch` chooses it if not given");
  verb->add_option("--gpu", request->gpu, "part of the name of the Vulkan device (default: the best one)")
      ->check(notEmpty);
  verb->add_option("--device", request->device, "haptic device by name ('palpate devices' lists them)")
      ->capture_default_str();
  addVolumeOptions(*verb, request->volume);
  verb->callback([request, run = std::move(run)] { run(*request); });
}

}  // namespace palpate
