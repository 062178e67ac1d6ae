// SPDX-License-Identifier: Apache-2.0
// apps/window/window_model.hpp: everything that panels show and change. One thread, that of the window.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "apps/sculpt/gestures.hpp"
#include "apps/sculpt/sculpt_session.hpp"
#include "apps/sculpt/sculpt_settings.hpp"

namespace palpate {

// A figure over the last seconds.
struct Trace {
  static constexpr std::size_t kLength = 512;
  std::vector<float> values = std::vector<float>(kLength, 0.0F);
  std::size_t next = 0;
  float newest = 0;
  void add(float value) {
    newest = value;
    values[next] = value;
    next = (next + 1) % kLength;
  }
};

struct WindowModel {
  SculptSession& session;
  SculptSettings settings;
  OrbitView view;
  DrawStyle style = {};
  SculptState state = {};
  TickRecord tick = {.tick = -1};
  ToolRequest request = {};
  Gestures gestures = {};
  Trace force_N = {}, depth_mm = {}, cost_us = {}, lateness_us = {}, window_age_ms = {};
  std::deque<std::string> messages = {};  // the newest last
  char file[1024] = "";                   // to save as
  bool asks_to_close = false;             // because work is unsaved
  bool closes = false;
  bool shows_help = false;

  void say(const std::string& text) {
    messages.push_back(text);
    if (messages.size() > 50) messages.pop_front();
  }
};

}  // namespace palpate
