// SPDX-License-Identifier: Apache-2.0
#include "apps/window/run_window.hpp"

#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/held/held_device.hpp"
#include "apps/window/questions.hpp"
#include "apps/window/sculpt_window.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/user_folders.hpp"

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

bool isAway(const SculptRequest& request, const SculptSide& session) {
  return (request.held ? request.held->forceOff() : session.forceOff()) == ForceOff::kDisconnected;
}

// A device that was pulled while one volume took the other's place is waited for, as long as somebody may plug it in.
void start(SculptSide& session, const SculptRequest& request, bool is_first) {
  constexpr double kPatience_s = 10;
  constexpr std::chrono::milliseconds kLook(100);
  const Stopwatch waited;
  for (bool is_told = false;; is_told = true) {
    try {
      return session.start();
    } catch (const Error& error) {
      // One that the servo's process opens is found there or not.
      const bool is_missing = error.code() == Error::Code::kNotFound || error.code() == Error::Code::kDevice;
      const bool may_come = request.held ? isAway(request, session) : is_missing && session.deviceIsHeld() && !is_first;
      if (!may_come || waited.seconds() >= kPatience_s || interrupted()) throw;
      if (!is_told) tellUser(fmt::format("{} is waited for: {}", request.device.device, error.what()));
    }
    std::this_thread::sleep_for(kLook);
  }
}

// The window of one session, until it shall close: nothing; or until another volume is open.
std::unique_ptr<OpenVolume> runSession(GuiHost& host, OpenVolume& open, SculptRequest& request,
                                       const std::filesystem::path& journals, SculptSettings& settings,
                                       std::string& remark, bool is_first) {
  start(*open.session, request, is_first);
  SculptWindow window(host, *open.session, settings);
  if (!remark.empty()) window.say(std::exchange(remark, {}));
  std::unique_ptr<OpenVolume> next;
  for (std::string volume = window.run(); !volume.empty(); volume = window.run()) {
    if (isSameVolume(volume, open.session->volume().name)) {
      window.say(volume + " is open already: the list of edits leads back to what it was");
      continue;
    }
    if (!open.session->canBeReplaced()) {
      window.say("this window shows the volume of a service: open another window for " + volume);
      continue;
    }
    request.volume = volume;
    next = openNext(host, window, request, journals);
    if (next && isAway(request, *open.session)) {
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
  // The servo's process opens it for each volume, and notes the same.
  if (isHeld(request.device) && !request.device.service) request.held = openHeldDevice(request.device);
  const std::filesystem::path folder = settingsFolder(), state = stateFolder();
  const std::filesystem::path journals = state.empty() ? state : state / "journals";
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
  std::unique_ptr<OpenVolume> open =
      request.connect.empty() ? openVolume(host, request, journals) : joinService(host, request.connect);
  request.isovalue.reset();  // of the first volume
  request.device.place_at_W.reset();
  const auto keepSettings = [&] {
    if (!file.empty()) writeSettings(settings, file);
  };
  try {
    for (bool is_first = true; open; is_first = false) {
      const std::string volume = open->session->volume().name;
      if (request.connect.empty()) settings.opened(lasting(volume));
      host.setTitle(fmt::format("Palpate: {}{}", volume, request.connect.empty() ? "" : " (served)"));
      std::unique_ptr<OpenVolume> next = runSession(host, *open, request, journals, settings, remark, is_first);
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
