// SPDX-License-Identifier: Apache-2.0
#include "apps/window/run_window.hpp"

#include <filesystem>

#include "apps/console/interrupt.hpp"
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

// The next volume in place of the present one. Empty: the present one stays, and `window` says why.
std::optional<OpenVolume> openNext(GuiHost& host, SculptWindow& window, const SculptRequest& request,
                                   const std::filesystem::path& journals) {
  try {
    return openVolume(host, request, journals);
  } catch (const Error& error) {
    window.say(error.what());
    return std::nullopt;
  }
}

}  // namespace

void runWindow(const SculptRequest& asked) {
  SculptRequest request = asked;
  const std::filesystem::path folder = settingsFolder(), journals = journalsFolder();
  const std::filesystem::path file = folder.empty() ? folder : folder / "sculpt.json";
  std::string trouble;
  SculptSettings settings = readSettings(file, trouble);
  GuiHost host({.title = "Palpate",
                .width = settings.width,
                .height = settings.height,
                .gpu = request.gpu,
                .dark = settings.dark,
                .scale = settings.scale});
  const KeptWork kept;  // a signal closes the window in good order
  std::optional<OpenVolume> open = openVolume(host, request, journals);
  while (open) {
    settings.opened(lasting(request.volume));
    host.setTitle("Palpate: " + request.volume);
    SculptWindow window(host, *open->session, settings);
    if (!trouble.empty()) window.say(std::exchange(trouble, {}));
    std::optional<OpenVolume> next;
    for (std::string volume = window.run(); !volume.empty(); volume = window.run()) {
      request = {.volume = volume, .gpu = asked.gpu, .gpu_memory_bytes = asked.gpu_memory_bytes, .device = asked.device};
      next = openNext(host, window, request, journals);
      if (next || interrupted() || host.wantsToClose()) break;
    }
    settings = window.settings();
    open->session->close();
    open = std::move(next);
  }
  if (!file.empty()) writeSettings(settings, file);
}

}  // namespace palpate
