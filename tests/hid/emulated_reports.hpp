// SPDX-License-Identifier: Apache-2.0
// What an emulated Polhem says on a cable that may have trouble; for whoever carries the reports.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "tests/servo/support/emulated_polhem.hpp"

namespace palpate {

class EmulatedReports {
 public:
  // `share`: of answers that are lost, garbled, short, double or late.
  EmulatedReports(EmulatedPolhem& arm, double share, unsigned seed) : arm_(arm), share_(share), bits_(seed) {}

  // What comes from the device for a report that it gets.
  std::vector<Report> answersTo(const Report& report) {
    std::vector<Report> answers = troubled(report);
    silent_ += answers.empty() ? 1 : 0;
    extra_ += answers.empty() ? 0 : static_cast<int>(answers.size()) - 1;
    return answers;
  }
  [[nodiscard]] int faults() const { return faults_; }
  [[nodiscard]] int silent() const { return silent_; }    // reports that got no answer in their turn
  [[nodiscard]] int extra() const { return extra_; }      // answers beyond one a report
  [[nodiscard]] int spoiled() const { return spoiled_; }  // answers that are none

 private:
  std::vector<Report> troubled(const Report& report) {
    std::vector<Report> answers = std::exchange(late_, {});
    Report answer = arm_.answer(report);
    if (!(std::uniform_real_distribution<double>(0, 1)(bits_) < share_)) {
      answers.push_back(answer);
      return answers;
    }
    ++faults_;
    switch (bits_() % 5) {
      case 0:  // lost
        break;
      case 1:  // garbled
        ++spoiled_;
        for (std::size_t i = 0; i < answer.size; ++i) answer.bytes[i] = static_cast<std::uint8_t>(bits_());
        answers.push_back(answer);
        break;
      case 2:  // short
        ++spoiled_;
        answer.size = 1 + bits_() % (answer.size - 1);
        answers.push_back(answer);
        break;
      case 3:  // double
        answers.insert(answers.end(), 2, answer);
        break;
      default:
        late_.push_back(answer);
    }
    return answers;
  }

  EmulatedPolhem& arm_;
  double share_;
  std::mt19937 bits_;
  std::vector<Report> late_;
  int faults_ = 0, silent_ = 0, extra_ = 0, spoiled_ = 0;
};

}  // namespace palpate
