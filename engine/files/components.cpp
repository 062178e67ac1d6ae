// SPDX-License-Identifier: Apache-2.0
#include "engine/files/components.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

struct ComponentWords {
  const char* what;
  const char* remedy;
};

ComponentWords wordsOf(Components kind) {
  switch (kind) {
    case Components::kColours:
      return {"colours", "convert it to grey values, or extract one channel"};
    case Components::kVectors:
      return {"vectors", "extract one component, or write their length"};
    case Components::kComplex:
      return {"complex numbers", "write their magnitude"};
    case Components::kTensors:
      return {"matrices", "extract one component, or write a measure of them"};
    case Components::kColoursOrVectors:
      break;
  }
  return {"colours or vectors", "convert it to grey values, or extract one component"};
}

}  // namespace

void refuseComponents(const std::string& source, Components kind, double count, const std::string& whose) {
  const ComponentWords words = wordsOf(kind);
  refuse(source, fmt::format("{} are {} of {:.0f} components, and a density is one number", whose, words.what, count),
         words.remedy);
}

}  // namespace palpate
