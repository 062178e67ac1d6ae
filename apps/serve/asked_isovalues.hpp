// SPDX-License-Identifier: Apache-2.0
// apps/serve/asked_isovalues.hpp: who has asked for another isovalue, and waits until it is in effect. Any thread.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "base/error.hpp"

namespace palpate {

class AskedIsovalues {
 public:
  using Done = std::function<void(const std::optional<Error>& refusal)>;

  void add(double isovalue, Done done);
  // It is in effect: answers who asked for it, and who asked for others before. Those after wait on.
  void reached(double isovalue);
  // Answers all with why, but for those who asked for `kept`. False: nobody was there.
  bool refuse(const Error& refusal, std::optional<double> kept = {});

 private:
  struct Asked {
    double isovalue = 0;
    Done done;
  };
  std::mutex mutex_;  // guards the next; not held while somebody is answered
  std::vector<Asked> asked_;
};

}  // namespace palpate
