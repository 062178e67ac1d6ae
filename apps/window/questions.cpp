// SPDX-License-Identifier: Apache-2.0
#include "apps/window/questions.hpp"

#include <chrono>
#include <functional>
#include <future>
#include <mutex>

#include <fmt/format.h>
#include <imgui.h>

#include "apps/console/interrupt.hpp"
#include "apps/sculpt/served_session.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kAskingFrame_s = 0.05;

// A frame with some words in the middle of an empty window, and buttons below. `done`: a bar up to there, from 0; below
// 0: none. Returns the number of the button that was pressed.
std::optional<std::size_t> frame(GuiHost& host, const std::string& words, const std::vector<std::string>& buttons,
                                 double done = -1) {
  std::optional<std::size_t> pressed;
  host.begin();
  ImGui::SetNextWindowPos(ImGui::GetMainViewport()->GetCenter(), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  if (ImGui::Begin("question", nullptr,
                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize)) {
    ImGui::TextUnformatted(words.c_str());
    if (done >= 0) ImGui::ProgressBar(static_cast<float>(done), ImVec2(ImGui::GetFontSize() * 24, 0));
    for (std::size_t i = 0; i < buttons.size(); ++i) {
      if (i > 0) ImGui::SameLine();
      if (ImGui::Button(buttons[i].c_str())) pressed = i;
    }
  }
  ImGui::End();
  host.end({});
  return pressed;
}

// Empty: the window shall close.
std::optional<std::size_t> ask(GuiHost& host, const std::string& words, const std::vector<std::string>& buttons) {
  while (!host.wantsToClose() && !interrupted()) {
    if (const auto pressed = frame(host, words, buttons)) return pressed;
    static_cast<void>(host.listen(kAskingFrame_s));
  }
  return std::nullopt;
}

// What becomes of sessions of this volume that a crash has left. Returns whether the volume shall be opened.
bool recover(GuiHost& host, const std::filesystem::path& journals, const std::string& volume,
             std::optional<LeftSession>& from) {
  for (const LeftSession& left : leftSessions(journals)) {
    if (!isSameVolume(left.volume, volume)) continue;
    const std::string words = fmt::format(
        "A session of {} was not closed.\nIts journal has {} {} that no file may hold.{}", volume, left.edits,
        left.edits == 1 ? "edit" : "edits", left.damage.empty() ? "" : "\nLost: " + left.damage);
    const auto choice = ask(host, words, {"Make them again", "Begin anew, keep the journal", "Throw them away"});
    if (!choice) return false;
    if (*choice == 0) from = left;
    if (*choice == 2) dropLeftSession(left);
    if (*choice < 2) break;
  }
  return true;
}

// How far a thread is with loading, and whether it shall go on.
class Loading {
 public:
  explicit Loading(std::string volume) : volume_(std::move(volume)) {}

  void cancel() {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
  }
  // Called by the thread that loads.
  void tell(const std::string& stage, double done) {
    const std::lock_guard lock(mutex_);
    if (cancelled_) throw Error(Error::Code::kCancelled, volume_, "loading was cancelled", "open it again");
    stage_ = stage;
    done_ = done;
  }
  [[nodiscard]] std::pair<std::string, double> state() {
    const std::lock_guard lock(mutex_);
    return {cancelled_ ? "cancelling ..." : stage_ + " ...", done_};
  }

 private:
  const std::string volume_;
  std::mutex mutex_;
  bool cancelled_ = false;
  std::string stage_ = "opening";
  double done_ = 0;
};

// What `make` makes beside the window. Null: it was cancelled.
template <class Session>
std::unique_ptr<Session> load(GuiHost& host, const std::string& name,
                              const std::function<std::unique_ptr<Session>(Progress&)>& make) {
  Loading loading(name);
  auto loaded = std::async(std::launch::async, [&] {
    Progress progress([&](const std::string& stage, double done) { loading.tell(stage, done); });
    return make(progress);
  });
  while (loaded.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    const auto [words, done] = loading.state();
    const bool pressed = frame(host, words, {"Cancel"}, done).has_value();
    if (pressed || host.wantsToClose() || interrupted()) loading.cancel();
    static_cast<void>(host.listen(kAskingFrame_s));
  }
  try {
    return loaded.get();
  } catch (const Error& error) {
    if (error.code() != Error::Code::kCancelled || interrupted()) throw;
    return nullptr;
  }
}

}  // namespace

bool isSameVolume(const std::string& name, const std::string& other) {
  if (name == other) return true;
  std::error_code unknown;
  return std::filesystem::equivalent(name, other, unknown);
}

std::unique_ptr<OpenVolume> joinService(GuiHost& host, const std::string& socket) {
  auto opened = std::make_unique<OpenVolume>();
  opened->session = load<ServedSession>(
      host, socket, [&](Progress& progress) { return std::make_unique<ServedSession>(socket, progress); });
  return opened->session ? std::move(opened) : nullptr;
}

std::unique_ptr<OpenVolume> openVolume(GuiHost& host, SculptRequest request, const std::filesystem::path& journals) {
  auto opened = std::make_unique<OpenVolume>();
  std::optional<LeftSession> left;
  if (!journals.empty()) {
    if (!recover(host, journals, request.volume, left)) return nullptr;
    if (left) request.recovers = left->folder;
    opened->journal = std::make_unique<SessionFolder>(journals);
    request.journal = opened->journal->path();
  }
  auto session = load<SculptSession>(
      host, request.volume, [&](Progress& progress) { return std::make_unique<SculptSession>(request, progress); });
  if (!session) return nullptr;
  if (left && session->journalHolds()) passLeftSession(*left);  // its edits are in the new journal
  opened->session = std::move(session);
  return opened;
}

}  // namespace palpate
