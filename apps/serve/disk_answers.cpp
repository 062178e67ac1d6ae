// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/disk_answers.hpp"

#include <utility>

namespace palpate {

void DiskAnswers::add(const JournalWriter& journal, Done done) {
  made_.push_back({journal.appended(), std::move(done)});
  count_.store(made_.size(), std::memory_order_relaxed);
}

void DiskAnswers::settle(const JournalWriter& journal) {
  if (made_.empty()) return;
  const std::string failure = journal.failure();  // first: what is acknowledged below was so before
  for (; !made_.empty(); made_.pop_front()) {
    if (made_.front().record <= journal.acknowledged()) {
      made_.front().done({});
    } else if (!failure.empty()) {
      made_.front().done(Error(Error::Code::kIo, "the journal",
                               "the edit was made, but it is not on the disk: " + failure,
                               "save the volume with 'palpate ctl save'"));
    } else {
      break;
    }
  }
  count_.store(made_.size(), std::memory_order_relaxed);
}

}  // namespace palpate
