// SPDX-License-Identifier: Apache-2.0
#include "apps/window/gui_host.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <fmt/format.h>
#include <imgui.h>

#include "apps/window/input_queue.hpp"
#include "apps/window/theme.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr float kFontSize = 15;  // [pixel] at 1x

std::string lastGlfwError() {
  const char* words = nullptr;
  glfwGetError(&words);
  return words == nullptr ? "for an unknown reason" : words;
}

// GLFW, from the first window to the last.
struct Glfw {
  Glfw() {
    if (glfwInit() == GLFW_TRUE) return;
    throw Error(Error::Code::kDevice, "palpate sculpt", fmt::format("there is no display ({})", lastGlfwError()),
                "on a machine without one use 'palpate touch' and 'palpate render'");
  }
  ~Glfw() { glfwTerminate(); }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

struct Window {
  GLFWwindow* handle;
  Window(int width, int height, const std::string& title) {
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    handle = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (handle != nullptr) return;
    throw Error(Error::Code::kDevice, "the window", fmt::format("it could not be opened ({})", lastGlfwError()),
                "use 'palpate touch' and 'palpate render', which need none");
  }
  ~Window() { glfwDestroyWindow(handle); }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
};

struct Panels {
  explicit Panels(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;  // nothing is written beside the settings
    io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
    ImGui_ImplGlfw_InitForVulkan(window, false);  // input comes through the queue
  }
  ~Panels() {
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;
};

}  // namespace

struct GuiHost::State {
  explicit State(const GuiSettings& settings)
      : window(settings.width, settings.height, settings.title), panels(window.handle), dark(settings.dark) {
    glfwSetWindowUserPointer(window.handle, this);
    glfwSetDropCallback(window.handle, [](GLFWwindow* of, int count, const char** names) {
      auto* self = static_cast<State*>(glfwGetWindowUserPointer(of));
      self->dropped.insert(self->dropped.end(), names, names + count);
    });
    hearInput();
    scale = scaleFor(settings.scale);
    loadFont();
    applyTheme(dark, scale);
    presenter.emplace(window.handle, settings.gpu);
  }
  static void add(GLFWwindow* of, const InputEvent& event) {
    static_cast<State*>(glfwGetWindowUserPointer(of))->input.add(event);
  }
  void hearInput() const {
    using Kind = InputEvent::Kind;
    glfwSetCursorPosCallback(
        window.handle, [](GLFWwindow* of, double x, double y) { add(of, {.kind = Kind::kMove, .x = x, .y = y}); });
    glfwSetMouseButtonCallback(window.handle, [](GLFWwindow* of, int button, int action, int) {
      add(of, {.kind = Kind::kButton, .code = button, .down = action == GLFW_PRESS});
    });
    glfwSetScrollCallback(window.handle,
                          [](GLFWwindow* of, double x, double y) { add(of, {.kind = Kind::kWheel, .x = x, .y = y}); });
    glfwSetKeyCallback(window.handle, [](GLFWwindow* of, int key, int, int action, int) {
      if (action != GLFW_REPEAT) add(of, {.kind = Kind::kKey, .code = key, .down = action == GLFW_PRESS});
    });
    glfwSetCharCallback(window.handle, [](GLFWwindow* of, unsigned character) {
      add(of, {.kind = Kind::kText, .character = character});
    });
    glfwSetWindowFocusCallback(window.handle, [](GLFWwindow* of, int focused) {
      if (focused == GLFW_FALSE) add(of, {.kind = Kind::kFocusLost});
    });
  }
  // Over what the backend has asked of GLFW, which is the newest state and not that of this frame.
  void feed() {
    const InputState& state = input.nextFrame();
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(static_cast<float>(state.x), static_cast<float>(state.y));
    for (std::size_t i = 0; i < InputState::kButtons; ++i) io.MouseDown[i] = state.buttons[i];
    for (std::size_t i = 0; i < InputState::kKeys; ++i) io.KeysDown[i] = state.keys[i];
    const auto held = [&](int left, int right) { return state.keys[left] || state.keys[right]; };
    io.KeyCtrl = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
    io.KeyShift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    io.KeyAlt = held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT);
    io.KeySuper = held(GLFW_KEY_LEFT_SUPER, GLFW_KEY_RIGHT_SUPER);
    io.MouseWheelH += static_cast<float>(state.wheel_x);
    io.MouseWheel += static_cast<float>(state.wheel_y);
    for (const unsigned character : state.text) io.AddInputCharacter(character);
  }
  [[nodiscard]] double scaleFor(double asked) const {
    float by_x = 1, by_y = 1;
    glfwGetWindowContentScale(window.handle, &by_x, &by_y);
    return asked > 0 ? asked : std::max(1.0F, by_x);
  }
  void loadFont() const {
    ImFontAtlas* fonts = ImGui::GetIO().Fonts;
    fonts->Clear();
    const auto size = static_cast<float>(kFontSize * scale);
    if (std::filesystem::exists(kFont)) {
      static const ImWchar kRanges[] = {0x20, 0xFF, 0x2013, 0x2026, 0x2190, 0x2193, 0x25A0, 0x25FF, 0};
      fonts->AddFontFromFileTTF(kFont, size, nullptr, kRanges);
      return;
    }
    ImFontConfig config;
    config.SizePixels = size;
    fonts->AddFontDefault(&config);
  }

  Glfw glfw;
  Window window;
  Panels panels;
  std::optional<Presenter> presenter;  // before the panels go
  InputQueue input;
  std::vector<std::string> dropped;
  bool dark;
  double scale = 1;
};

GuiHost::GuiHost(const GuiSettings& settings) : state_(std::make_unique<State>(settings)) {}
GuiHost::~GuiHost() = default;

bool GuiHost::listen(double most_s) {
  const double before = glfwGetTime();
  if (most_s > 0 && state_->input.empty()) {
    glfwWaitEventsTimeout(most_s);
  } else {
    glfwPollEvents();
  }
  return !state_->input.empty() || glfwGetTime() - before < most_s;
}

bool GuiHost::wantsToClose() const {
  return glfwWindowShouldClose(state_->window.handle) == GLFW_TRUE;
}

void GuiHost::refuseToClose() {
  glfwSetWindowShouldClose(state_->window.handle, GLFW_FALSE);
}

std::vector<std::string> GuiHost::takeDroppedFiles() {
  return std::exchange(state_->dropped, {});
}

void GuiHost::setTitle(const std::string& title) {
  glfwSetWindowTitle(state_->window.handle, title.c_str());
}

void GuiHost::setDark(bool dark) {
  if (std::exchange(state_->dark, dark) != dark) applyTheme(dark, state_->scale);
}

void GuiHost::setScale(double scale) {
  const double wanted = state_->scaleFor(scale);
  if (std::exchange(state_->scale, wanted) == wanted) return;
  state_->loadFont();
  applyTheme(state_->dark, wanted);
  state_->presenter->renewFonts();
}

std::array<int, 2> GuiHost::size() const {
  int width = 0, height = 0, pixels = 0;
  glfwGetWindowSize(state_->window.handle, &width, &height);
  glfwGetFramebufferSize(state_->window.handle, &pixels, nullptr);
  if (pixels != width) return {width, height};
  const double by = state_->scaleFor(0);  // GLFW makes a window larger by this where its size is counted in pixels
  return {static_cast<int>(std::lround(width / by)), static_cast<int>(std::lround(height / by))};
}

double GuiHost::scale() const noexcept {
  return state_->scale;
}

void GuiHost::begin() {
  ImGui_ImplGlfw_NewFrame();
  state_->feed();
  ImGui::NewFrame();
}

bool GuiHost::end(const PlacedPicture& picture) {
  ImGui::Render();
  return state_->presenter->present(background(state_->dark), picture, ImGui::GetDrawData());
}

std::optional<RenderedImage> GuiHost::endAndCapture(const PlacedPicture& picture) {
  ImGui::Render();
  return state_->presenter->capture(background(state_->dark), picture, ImGui::GetDrawData());
}

}  // namespace palpate
