// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/serve_job.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/console/interrupt.hpp"
#include "apps/console/message.hpp"
#include "apps/serve/client_desk.hpp"
#include "apps/serve/flat_heap.hpp"
#include "apps/serve/kept_settings.hpp"
#include "apps/serve/live_setting.hpp"
#include "apps/serve/metrics_door.hpp"
#include "apps/serve/served_volume.hpp"
#include "apps/serve/service_place.hpp"
#include "apps/supervise/service_notify.hpp"
#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "base/monotonic_clock.hpp"
#include "service/channel/usual_socket.hpp"

namespace palpate {
namespace {

constexpr int kLook_ms = 50;  // how long a signal may go unseen

volatile std::sig_atomic_t reload_asked = 0, stop_asked = 0;
std::atomic<std::int64_t> stop_asked_ns{0};
constexpr std::int64_t kAgain_ns = 500'000'000;  // one sent twice is one request (apps/console/interrupt.hpp)

void askToReload(int) {
  reload_asked = 1;
}

// The work that is left, as a file to be saved, is not given up for the first signal. Another one ends the process:
// edits are in the journal.
void askToStop(int number) {
  const std::int64_t now_ns = monotonicNow_ns();
  if (stop_asked == 0) stop_asked_ns = now_ns;
  stop_asked = 1;
  if (now_ns - stop_asked_ns < kAgain_ns) return;
  static_cast<void>(std::signal(number, SIG_DFL));
  static_cast<void>(std::raise(number));
}

void tell(const std::string& words) {
  tellUser("serve: " + words);
}

// False: not yet, as the engine is being made anew.
bool reload(const ServeRequest& request, ServedVolume& served, KeptSettings& settings) {
  if (!request.read_again) {
    tell("no scene file was named, so there are no settings to read again");
    return true;
  }
  try {
    const Scene wanted = request.read_again();
    std::vector<std::string> others;
    served.change(withLiveSettings(served.scene(), wanted, others), [](const std::optional<Error>& refusal) {
      if (refusal) tell(refusal->what());
    });
    settings.reread(wanted);
    tell("the scene's settings were read again");
    others.clear();
    static_cast<void>(withLiveSettings(request.scene, wanted, others));  // held against the file as it was at the start
    if (!others.empty()) tell(fmt::format("these take effect with the next start: {}", fmt::join(others, ", ")));
  } catch (const Error& error) {
    if (error.code() == Error::Code::kDevice) return false;
    tell(fmt::format("the settings stay as they are: {}", error.what()));
  }
  return true;
}

struct ClosedFirst {
  ServedVolume& served;
  ~ClosedFirst() {
    try {
      served.close();
    } catch (const std::exception&) {  // told already
    }
  }
};

std::filesystem::path journalOf(const ServeRequest& request) {
  if (!request.scene.journal.empty()) return request.scene.journal;
  std::filesystem::path folder = usualServiceJournal(socketOf(request.scene));
  if (folder.empty())
    tell(
        "no journal is kept, as neither XDG_STATE_HOME nor HOME is set: a crash loses the edits; name a folder with "
        "--journal");
  return folder;
}

std::unique_ptr<MetricsDoor> metricsDoorOf(const Scene& scene, const ServedVolume& served, const ClientDesk& desk) {
  if (scene.service_metrics_socket.empty()) return nullptr;
  makeSocketFolder(scene.service_metrics_socket);
  return std::make_unique<MetricsDoor>(scene.service_metrics_socket, [&served, &desk] {
    ServedStatus status = served.status();
    status.clients = desk.clients();
    return metricsText(figuresOf(status, monotonicNow_ns()));
  });
}

// Told at the start, not refused: an engine that is started again after a crash must serve, whatever became of the
// place.
void warnOfSave(const std::string& file) {
  if (file.empty()) return;
  try {
    checkWritable(file);
  } catch (const Error& error) {
    tell(fmt::format("the volume cannot be written at the end, as things are: {}", error.what()));
  }
}

// Filters that were set before a crash may need more memory than there is now. The service then starts without anything
// that was set.
std::unique_ptr<ServedVolume> servedOf(const ServeRequest& request, KeptSettings& settings,
                                       const std::filesystem::path& journal, Progress& progress) {
  const auto made = [&] {
    return std::make_unique<ServedVolume>(
        ServedVolume::Request{
            .scene = request.scene, .settings = settings.taken(), .journal = journal, .commit = request.commit},
        progress, tell);
  };
  try {
    return made();
  } catch (const Error& error) {
    const bool may_be_theirs = error.code() == Error::Code::kOutOfMemory || error.code() == Error::Code::kDevice;
    if (settings.taken().filter == request.scene.filter || !may_be_theirs) throw;
    settings.takeNone(fmt::format("the service does not start with them ({})", error.what()));
  }
  return made();
}

// Tells systemd that the service lives, twice as often as it wants to hear that; not while the engine hangs.
class Watchdog {
 public:
  explicit Watchdog(const ServiceNotify& notify) : notify_(notify) {
    if (const auto period = notify.watchdogPeriod())
      every_ns_ = std::chrono::duration_cast<std::chrono::nanoseconds>(*period).count() / 2;
  }
  void look(const ServedVolume& served) {
    const std::int64_t now_ns = monotonicNow_ns();
    if (every_ns_ == 0 || now_ns - last_ns_ < every_ns_ || !served.isAlive(every_ns_)) return;
    last_ns_ = now_ns;
    static_cast<void>(notify_.watchdog());
  }

 private:
  const ServiceNotify& notify_;
  std::int64_t every_ns_ = 0;  // 0: it is not wanted
  std::int64_t last_ns_ = 0;
};

}  // namespace

void serveScene(const ServeRequest& request, Progress& progress) {
  keepHeapFlat();
  static_cast<void>(std::signal(SIGHUP, askToReload));  // also while the volume is loaded
  warnOfSave(request.scene.save);
  const ServiceNotify notify;
  const std::string socket = socketOf(request.scene);
  makeSocketFolder(socket);
  Listener listener(socket);  // first: whoever has the socket has the journal
  const std::filesystem::path journal = journalOf(request);
  KeptSettings settings(journal.empty() ? journal : journal / "settings.json", request.scene, tell);
  settings.check([](const Scene& scene) {
    checkServable(scene);
    static_cast<void>(servedPlan(scene));
  });
  const std::unique_ptr<ServedVolume> made = servedOf(request, settings, journal, progress);
  ServedVolume& served = *made;
  settings.begin(served.scene());
  ClientDesk desk(std::move(listener), served, tell);
  const ClosedFirst closed{served};  // what it still has to answer goes to the desk
  for (const int number : {SIGTERM, SIGINT}) static_cast<void>(std::signal(number, askToStop));
  served.start();
  progress.done();
  const std::unique_ptr<MetricsDoor> metrics = metricsDoorOf(request.scene, served, desk);
  static_cast<void>(notify.ready());
  const std::string words = fmt::format("{} is served at {}", request.scene.volume, socket);
  static_cast<void>(notify.status(words));
  tell(words);
  Watchdog watchdog(notify);
  while (stop_asked == 0 && !interrupted() && !served.failed() && desk.round(kLook_ms)) {
    watchdog.look(served);
    if (settings.isDue(monotonicNow_ns())) settings.look(served.scene(), monotonicNow_ns(), served.isIsovalueFelt());
    if (reload_asked == 0) continue;
    reload_asked = 0;
    static_cast<void>(notify.reloading());
    if (!reload(request, served, settings)) reload_asked = 1;
    static_cast<void>(notify.ready());
  }
  static_cast<void>(notify.stopping());
  struct Flushed {  // also when the end fails: who asked is told
    ClientDesk& desk;
    ~Flushed() {
      try {
        desk.flush();
      } catch (const std::exception&) {  // nobody is left who could be told
      }
    }
  };
  {
    const Flushed flushed{desk};
    try {
      served.close(request.scene.save);
    } catch (...) {
      if (!served.failed()) settings.forget();
      throw;
    }
  }
  settings.forget();
  tell("ended");
}

}  // namespace palpate
