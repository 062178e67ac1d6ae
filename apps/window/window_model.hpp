// SPDX-License-Identifier: Apache-2.0
// apps/window/window_model.hpp: everything that panels show and change. One thread, that of the window.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "apps/sculpt/fault_counts.hpp"
#include "apps/sculpt/gestures.hpp"
#include "apps/sculpt/key_pointer.hpp"
#include "apps/sculpt/saved_files.hpp"
#include "apps/sculpt/sculpt_settings.hpp"
#include "apps/sculpt/sculpt_side.hpp"
#include "apps/sculpt/tick_recording.hpp"
#include "apps/sculpt/view_choice.hpp"

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

// That this session shall end: the window closes, or another volume is opened.
struct Leaving {
  bool asks = false;   // whether to, because work is unsaved
  bool goes = false;   // it shall, once every file is written
  bool keeps = false;  // what is unsaved then stays in the journal
  std::string volume;  // to open; empty: the window closes
};

// A file that lies where the person wants to save, and that this session has not written: shall it go?
struct Overwriting {
  std::string file;           // empty: nothing is asked
  bool leaves_after = false;  // Leaving::goes then
};

struct WindowModel {
  SculptSide& session;
  SculptSettings settings;
  OrbitView view;
  ViewChoice sight = {};
  SculptState state = {};
  TickRecord tick = {.tick = -1};
  FaultCounts faults = {};
  ToolRequest request = {};
  Gestures gestures = {};
  KeyPointer keys = {};
  PointerInput pointer = {};  // of this frame
  Trace force_N = {}, depth_mm = {}, energy_mJ = {}, cost_us = {}, lateness_us = {}, window_age_ms = {};
  std::deque<Vec3> path_W = {};                 // of the surface point, while the contact lasts
  std::optional<TickRecording> recording = {};  // of the tool's way
  std::deque<std::string> messages = {};        // the newest last
  char file[1024] = "";                         // to save as
  char opens[1024] = "";                        // to open
  SavedFiles saved = {};
  Overwriting overwriting = {};
  Leaving leaving = {};
  bool wants_screenshot = false;

  void say(const std::string& text) {
    messages.push_back(text);
    if (messages.size() > 50) messages.pop_front();
  }
  void open(const std::string& volume) { leave(volume); }
  void close() { leave(""); }

 private:
  void leave(const std::string& volume) {
    if (leaving.goes) return;
    leaving = {.asks = state.unsaved, .goes = !state.unsaved, .keeps = false, .volume = volume};
  }
};

}  // namespace palpate
