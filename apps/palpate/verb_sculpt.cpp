// SPDX-License-Identifier: Apache-2.0
// palpate sculpt IN: a window in which a volume is seen, touched and edited.
#include "apps/scene/idle_options.hpp"
#include "apps/sculpt/sculpt_session.hpp"
#include "base/error.hpp"
#include "scene_flag.hpp"
#include "service/channel/usual_socket.hpp"
#include "verbs.hpp"
#include "version.hpp"
#include "volume_options.hpp"

namespace palpate {
namespace {

// Of the device: all that is not of a simulated one's dynamics or of recordings. And where the servo is.
constexpr const char* kDeviceKeys[] = {"device.name",
                                       "device.path",
                                       "device.hid",
                                       "device.calibrated",
                                       "device.current_limit_A",
                                       "device.place_at_mm",
                                       "device.place_turn_deg",
                                       "device.place_scale",
                                       "device.force_scale",
                                       "device.clutch",
                                       "device.edge_stiffness_N_per_m",
                                       "servo.service"};

// With --connect the service has the volume and its servo the device.
void checkAlone(const CLI::App& verb, const CLI::Option& connect) {
  for (const CLI::Option* const option : verb.get_options()) {
    if (option == &connect || option->count() == 0) continue;
    refuse(option->get_name(), "a window of a service takes volume, device and engine from the service",
           "give it to 'palpate serve', or leave --connect out");
  }
}

}  // namespace

void addSculptVerb(CLI::App& app,
                   std::function<void(const SculptRequest& request, const std::vector<std::string>& idle)> run) {
  CLI::App* verb = app.add_subcommand("sculpt", "see, touch and edit a volume in a window");
  verb->footer(
      "Left button: stroke; right: turn; Shift + right: move; wheel: zoom; F: size; Ctrl+Z: undo.\n"
      "Without a display use 'palpate touch' and 'palpate render'. docs/sculpt.md explains the window");
  auto request = std::make_shared<SculptRequest>();
  request->commit = programCommit();
  verb->add_option("in", request->volume, "file, DICOM folder or 'phantom:NAME?size=64'");
  auto socket = std::make_shared<std::string>();
  CLI::Option* const connect =
      verb->add_option("--connect", *socket,
                       "show the volume of a running 'palpate serve': its socket, or the usual one")
          ->expected(0, 1);
  verb->add_option("--iso", request->isovalue,
                   "isovalue of the surface [density]; as `palpate touch` chooses it if not given");
  verb->add_option("--gpu", request->gpu, "part of the name of the Vulkan device (default: the best one)")
      ->check(notEmpty);
  addVolumeOptions(*verb, request->volume);
  auto flags = std::make_shared<SceneFlags>(*verb, kDeviceKeys, request->device);
  verb->callback([verb, request, flags, socket, connect, run = std::move(run)] {
    flags->apply(request->device);
    if (connect->count() > 0) {
      checkAlone(*verb, *connect);
      request->connect = socket->empty() ? usualSocket() : *socket;
    } else if (request->volume.empty()) {
      refuse("palpate sculpt", "no volume is named", "name a file, or phantom:sphere, or give --connect");
    }
    run(*request, idleOptions(request->device, flags->given()));
  });
}

}  // namespace palpate
