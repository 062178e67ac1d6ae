// SPDX-License-Identifier: Apache-2.0
// apps/window/panel_parts.hpp: what the sections of the panels are made of. One thread.
#pragma once

#include <string>

#include <imgui.h>

#include "apps/sculpt/force_words.hpp"
#include "apps/window/window_model.hpp"
#include "base/error.hpp"

namespace palpate {

// What is felt now, or why nothing is.
[[nodiscard]] ForceWords forceWordsOf(const WindowModel& model);
// A section that can be folded. Returns whether it is open.
[[nodiscard]] bool section(const char* title, bool open_at_first = true);
// About the item before it.
void tip(const std::string& text);
// A slider of a quantity in SI units, shown in units of `unit`. Returns whether it was moved.
bool slider(const char* label, double& value, double low, double high, double unit, const char* form,
            bool logarithmic = false);
// A slider from 0 to 1, shown in percent.
bool shareSlider(const char* label, double& share);
// The next item leaves room for a label.
void leaveRoomForLabel();
// The size of one of so many buttons in a row.
[[nodiscard]] ImVec2 inRow(int buttons);
void mutedText(const std::string& text);

// An Error of `work` becomes a message. Returns whether there was none.
template <typename Work>
bool orSay(WindowModel& model, const Work& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    model.say(error.what());
    return false;
  }
}

}  // namespace palpate
