// SPDX-License-Identifier: Apache-2.0
// A desktop for tests: Xvfb, a person's mouse and keys (xdotool), and what is on the screen. And a program on it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/apps/report/temporary_folder.hpp"

namespace palpate {

struct Screen {
  int width = 0, height = 0;
  std::size_t first = 0, row = 0;  // offset of the first pixel and length of a row [byte]
  std::string bytes;               // 4 a pixel: blue, green, red
  [[nodiscard]] std::array<int, 3> at(int x, int y) const {
    const auto* pixel = reinterpret_cast<const std::uint8_t*>(&bytes.at(offset(x, y)));
    return {pixel[2], pixel[1], pixel[0]};
  }
  [[nodiscard]] std::size_t offset(int x, int y) const {
    return first + static_cast<std::size_t>(y) * row + 4 * static_cast<std::size_t>(x);
  }
};

struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
  [[nodiscard]] bool holds(int px, int py) const { return px >= x && py >= y && px < x + width && py < y + height; }
};

// How many pixels of `within`, but not of `but`, differ by more than `most` of 255.
[[nodiscard]] int differing(const Screen& a, const Screen& b, const Rectangle& within, const Rectangle& but = {},
                            int most = 2);

// Up to a minute: no time is asserted.
[[nodiscard]] bool waitUntil(const std::function<bool()>& done);

class Desktop {
 public:
  // Why there can be none here; empty: there can.
  [[nodiscard]] static std::string missing();
  Desktop(int width, int height);
  ~Desktop();
  Desktop(const Desktop&) = delete;
  Desktop& operator=(const Desktop&) = delete;

  [[nodiscard]] const std::string& display() const noexcept { return display_; }
  [[nodiscard]] Screen look() const;
  // xdotool's commands: {"mousemove", "640", "360", "click", "1"}.
  void does(const std::vector<std::string>& commands) const;
  void moves(int x, int y) const { does({"mousemove", std::to_string(x), std::to_string(y)}); }
  // As a file manager lets files go over the program's window.
  void drops(const std::vector<std::filesystem::path>& files) const;
  // As a window manager does when a person closes the window.
  void asksToClose() const;
  // A window manager from now on; without one, windows are not minimised. False: twm is not installed.
  [[nodiscard]] bool manageWindows();
  // In so many steps of a moment each, as a hand does.
  void drags(int from_x, int from_y, int to_x, int to_y, int button, int steps = 10) const;

 private:
  TemporaryFolder folder_;
  std::string display_;
  pid_t server_ = -1;
  pid_t manager_ = -1;
};

using Environment = std::map<std::string, std::string>;

// `palpate` with these words on a display (empty: none), with a home of its own, in which it begins; started by
// `runner`, if that is not empty: a program and its words.
class Started {
 public:
  Started(const std::string& display, const std::filesystem::path& home, std::vector<std::string> words,
          const Environment& more = {}, std::vector<std::string> runner = {});
  ~Started();  // kills it
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;

  [[nodiscard]] bool runs();
  // Whether a thread other than the servo's has, or waits for, a processor now.
  [[nodiscard]] bool computes() const;
  void signals(int number) const;  // to the program, also if a runner started it
  // Its exit status, or 256 and the signal; -1 if it does not end within a minute.
  [[nodiscard]] int ends();
  [[nodiscard]] pid_t id() const noexcept { return process_; }
  [[nodiscard]] std::string said() const;  // on both streams

 private:
  std::filesystem::path log_;
  bool has_runner_;
  pid_t process_ = -1;
  int status_ = -1;
};

}  // namespace palpate
