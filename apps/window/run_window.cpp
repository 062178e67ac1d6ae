// SPDX-License-Identifier: Apache-2.0
#include "apps/window/run_window.hpp"

#include <exception>
#include <filesystem>
#include <memory>
#include <utility>

#include "apps/console/interrupt.hpp"
#include "apps/held/held_device.hpp"
#include "apps/sculpt/user_folders.hpp"
#include "apps/window/questions.hpp"
#include "apps/window/sculpt_window.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

// As it is found from anywhere.
std::string lasting(const std::string& volume) {
  std::error_code unknown;
  return std::filesystem::exists(volume, unknown) ? std::filesystem::absolute(volume, unknown).string() : volume;
}

// The next volume in place of the present one. Null: the present one stays, and `window` says why.
std::unique_ptr<OpenVolume> openNext(GuiHost& host, SculptWindow& window, const SculptRequest& request,
                                     const std::filesystem::path& journals) {
  try {
    return openVolume(host, request, journals);
  } catch (const std::exception& error) {
    window.say(error.what());
    return nullptr;
  }
}

// The window of one session, until it shall close: nothing; or until another volume is open.
std::unique_ptr<OpenVolume> runSession(GuiHost& host, OpenVolume& open, SculptRequest& request,
                                       const std::filesystem::path& journals, SculptSettings& settings,
                                       std::string& remark) {
  open.session->start();
  SculptWindow window(host, *open.session, settings);
  if (!remark.empty()) window.say(std::exchange(remark, {}));
  std::unique_ptr<OpenVolume> next;
  for (std::string volume = window.run(); !volume.empty(); volume = window.run()) {
    if (isSameVolume(volume, open.session->volume().name)) {
      window.say(volume + " is open already: the list of edits leads back to what it was");
      continue;
    }
    request.volume = volume;
    next = openNext(host, window, request, journals);
    if (next && request.held && request.held->forceOff() == ForceOff::kDisconnected) {
      window.say(request.device.device + " is not connected: plug it in, and open the other volume then");
      next.reset();  // no servo begins without a first position
      continue;
    }
    if (next || interrupted() || host.wantsToClose()) break;
  }
  settings = window.settings();
  try {
    open.session->close();
  } catch (const std::exception& error) {
    if (!next) throw;
    remark = error.what();  // of the former volume: the next one's window says it
  }
  return next;
}

}  // namespace

void runWindow(const SculptRequest& asked) {
  SculptRequest request = asked;
  request.device.rate_hz = request.loop.rate_hz;
  // Once for all volumes: what it knows of its calibration is kept, and lost when it is unplugged.
  if (isHeld(request.device)) request.held = openHeldDevice(request.device);
  const std::filesystem::path folder = settingsFolder(), journals = journalsFolder();
  const std::filesystem::path file = folder.empty() ? folder : folder / "sculpt.json";
  std::string remark;
  SculptSettings settings = readSettings(file, remark);
  GuiHost host({.title = "Palpate",
                .width = settings.width,
                .height = settings.height,
                .gpu = request.gpu,
                .dark = settings.dark,
                .scale = settings.scale});
  const KeptWork kept;  // a signal closes the window in good order
  std::unique_ptr<OpenVolume> open = openVolume(host, request, journals);
  request.isovalue.reset();  // of the first volume
  request.device.place_at_W.reset();
  const auto keepSettings = [&] {
    if (!file.empty()) writeSettings(settings, file);
  };
  try {
    while (open) {
      const std::string volume = open->session->volume().name;
      settings.opened(lasting(volume));
      host.setTitle("Palpate: " + volume);
      std::unique_ptr<OpenVolume> next = runSession(host, *open, request, journals, settings, remark);
      open.reset();  // the session before its journal's folder
      open = std::move(next);
    }
  } catch (...) {
    keepSettings();
    throw;
  }
  keepSettings();
}

}  // namespace palpate
