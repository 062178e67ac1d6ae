// SPDX-License-Identifier: Apache-2.0
#include "apps/study/studies.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace palpate {

const std::vector<Study>& studies() {
  static const std::vector<Study> kStudies = {gradientStudy(), servoStudy(),   filterStudy(),
                                              drawStudy(),     publishStudy(), chainStudy()};
  return kStudies;
}

const Study& studyNamed(const std::string& name) {
  std::vector<std::string> names;
  for (const Study& study : studies()) {
    if (study.name == name) return study;
    names.emplace_back(study.name);
  }
  refuse(fmt::format("--study {}", name), "there is no such study",
         withDidYouMean(name, names, fmt::format("choose from {}", fmt::join(names, ", "))));
}

}  // namespace palpate
