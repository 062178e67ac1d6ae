// SPDX-License-Identifier: Apache-2.0
// apps/render/render_options.hpp: the table of every option of `palpate render` but its files: flag, unit, what it
// takes, default, help. The command line, `--help` and completion are made from it. Any thread.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "apps/render/render_request.hpp"

namespace palpate {

struct RenderOption {
  std::string flag;      // "--fov"
  std::string unit;      // as on screens: "degree"; empty for words and counts without one
  std::string takes;     // "a number from 1 to 120"; empty: the flag has no value
  std::string standard;  // the default as it may be given; empty: the program chooses, or there is none
  std::string help;
  // Sets the request's member. False: the text is not what the option takes.
  std::function<bool(const std::string& text, RenderRequest& request)> set;
  std::string placeholder{};            // stands for the value in a help text: "DEG"
  std::vector<std::string> words{};     // from which a user must choose; empty: any text of the form
  std::size_t most = 1;                 // times that it may be given
  std::string needs{};                  // flag without which it has no effect
  std::vector<std::string> excludes{};  // flags that it cannot go with

  [[nodiscard]] bool isBare() const noexcept { return takes.empty(); }
};

[[nodiscard]] const std::vector<RenderOption>& renderOptions();

// "vertical angle of view [degree] (a number from 1 to 120; default 30)"
[[nodiscard]] std::string optionHelp(const RenderOption& option);

// Sets what was given. `given`: for each row of the table the texts, as often as the flag was given; a bare flag has an
// empty one. Throws Error(kBadInput), which names the flag, for text that it does not take, for more texts than
// `most`, and for an option that has no effect beside the others or cannot go with one of them.
void setRenderOptions(std::span<const std::vector<std::string>> given, RenderRequest& request);

}  // namespace palpate
