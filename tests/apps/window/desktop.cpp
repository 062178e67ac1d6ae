// SPDX-License-Identifier: Apache-2.0
#include "desktop.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

// Starts a program that ends with this one. `prepare` runs in the child.
pid_t start(const std::vector<std::string>& words, const std::function<void()>& prepare) {
  const pid_t child = fork();
  if (child != 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  prepare();
  std::vector<char*> list;
  for (const std::string& word : words) list.push_back(const_cast<char*>(word.c_str()));
  list.push_back(nullptr);
  execvp(list[0], list.data());
  _exit(127);
}

// For start(): complaints go nowhere.
void quietly() {
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, 2);
}

bool isThere(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

std::string textOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return std::move(text).str();
}

std::uint32_t big(const std::string& bytes, std::size_t word) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | static_cast<std::uint8_t>(bytes.at(4 * word + i));
  return value;
}

}  // namespace

int differing(const Screen& a, const Screen& b, const Rectangle& within, const Rectangle& but, int most) {
  int count = 0;
  for (int y = within.y; y < within.y + within.height; ++y) {
    if (std::memcmp(&a.bytes.at(a.offset(within.x, y)), &b.bytes.at(b.offset(within.x, y)), 4 * within.width) == 0)
      continue;
    for (int x = within.x; x < within.x + within.width; ++x) {
      if (but.holds(x, y)) continue;
      const auto p = a.at(x, y), q = b.at(x, y);
      count += std::abs(p[0] - q[0]) > most || std::abs(p[1] - q[1]) > most || std::abs(p[2] - q[2]) > most;
    }
  }
  return count;
}

bool waitUntil(const std::function<bool()>& done) {
  for (int i = 0; i < 1200; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

std::string Desktop::missing() {
  for (const char* program : {"Xvfb", "xdotool"}) {
    if (!isThere(program)) return fmt::format("{} is not installed", program);
  }
  return {};
}

Desktop::Desktop(int width, int height) {
  int numbers[2];
  if (pipe(numbers) != 0) throw std::runtime_error("no pipe");
  server_ =
      start({"Xvfb", "-displayfd", std::to_string(numbers[1]), "-screen", "0", fmt::format("{}x{}x24", width, height),
             "-fbdir", folder_.path().string(), "-nolisten", "tcp", "-noreset"},
            quietly);
  close(numbers[1]);
  char byte = 0;
  while (read(numbers[0], &byte, 1) == 1 && byte != '\n') display_ += byte;
  close(numbers[0]);
  if (display_.empty()) throw std::runtime_error("Xvfb did not start");
  display_.insert(0, ":");
}

Desktop::~Desktop() {
  for (const pid_t one : {manager_, server_}) {
    if (one == -1) continue;
    kill(one, SIGTERM);
    waitpid(one, nullptr, 0);
  }
}

// Windows lie where they lay, without frames.
bool Desktop::manageWindows() {
  if (!isThere("twm")) return false;
  const std::filesystem::path file = folder_.path() / "twmrc";
  std::ofstream out(file);
  out << "RandomPlacement\nNoTitle\nBorderWidth 0\nNoGrabServer\n";
  for (const char* font : {"TitleFont", "MenuFont", "IconFont", "ResizeFont", "IconManagerFont"})
    out << font << " \"fixed\"\n";  // a font that every X server has
  out.close();
  manager_ = start({"twm", "-f", file.string()}, [this] {
    setenv("DISPLAY", display_.c_str(), 1);
    quietly();
  });
  return true;
}

// The file is an XWD dump of 32 bits a pixel: a header of 32-bit words, a table of colours of 12 bytes each, rows.
Screen Desktop::look() const {
  std::string bytes = textOf(folder_.path() / "Xvfb_screen0");
  const std::size_t first = big(bytes, 0) + std::size_t{12} * big(bytes, 19);
  return {static_cast<int>(big(bytes, 4)), static_cast<int>(big(bytes, 5)), first, big(bytes, 12), std::move(bytes)};
}

void Desktop::does(const std::vector<std::string>& commands) const {
  std::vector<std::string> words = {"xdotool"};
  words.insert(words.end(), commands.begin(), commands.end());
  const pid_t child = start(words, [this] { setenv("DISPLAY", display_.c_str(), 1); });
  int status = 0;
  waitpid(child, &status, 0);
  if (status != 0) throw std::runtime_error("xdotool failed");
}

void Desktop::drags(int from_x, int from_y, int to_x, int to_y, int button, int steps) const {
  moves(from_x, from_y);
  does({"mousedown", std::to_string(button)});
  for (int i = 1; i <= steps; ++i) {
    moves(from_x + (to_x - from_x) * i / steps, from_y + (to_y - from_y) * i / steps);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  does({"mouseup", std::to_string(button)});
}

Started::Started(const std::string& display, const std::filesystem::path& home, std::vector<std::string> words,
                 const Environment& more, std::vector<std::string> runner)
    : log_(home / "log"), has_runner_(!runner.empty()) {
  runner.emplace_back(PALPATE_PROGRAM);
  words.insert(words.begin(), runner.begin(), runner.end());
  std::filesystem::create_directories(home);
  process_ = start(words, [&] {
    display.empty() ? unsetenv("DISPLAY") : setenv("DISPLAY", display.c_str(), 1);
    setenv("HOME", home.c_str(), 1);
    if (chdir(home.c_str()) != 0) _exit(126);
    setenv("PALPATE_VALIDATION", "1", 1);
    setenv("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation", 1);
    for (const char* name : {"XDG_CONFIG_HOME", "XDG_STATE_HOME", "WAYLAND_DISPLAY"}) unsetenv(name);
    for (const auto& [name, value] : more) setenv(name.c_str(), value.c_str(), 1);
    const int log = open(log_.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    dup2(log, 1);
    dup2(log, 2);
  });
}

Started::~Started() {
  if (!runs()) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

bool Started::runs() {
  if (status_ != -1) return false;
  int status = 0;
  if (waitpid(process_, &status, WNOHANG) != process_) return true;
  status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
  return false;
}

bool Started::computes() const {
  std::error_code gone;
  for (const auto& thread : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process_), gone)) {
    const std::string line = textOf(thread.path() / "stat");  // 12 (engine) S ...
    const std::size_t end = line.rfind(") ");
    if (end != std::string::npos && line.find("(servo)") == std::string::npos && line.compare(end, 3, ") R") == 0)
      return true;
  }
  return false;
}

void Started::signals(int number) const {
  pid_t last = process_;
  const auto childOf = [](pid_t process) {
    const std::string children = textOf(fmt::format("/proc/{0}/task/{0}/children", process));
    const pid_t child = children.empty() ? -1 : std::stoi(children);
    return child != -1 && textOf(fmt::format("/proc/{}/comm", child)) == "palpate-servo\n" ? -1 : child;
  };
  for (pid_t child = has_runner_ ? childOf(last) : -1; child != -1; child = childOf(child)) last = child;
  kill(last, number);
}

int Started::ends() {
  return waitUntil([this] { return !runs(); }) ? status_ : -1;
}

std::string Started::said() const {
  return textOf(log_);
}

}  // namespace palpate
