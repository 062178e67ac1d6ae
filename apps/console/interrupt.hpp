// SPDX-License-Identifier: Apache-2.0
// apps/console/interrupt.hpp: Ctrl-C, `kill` and a closed terminal end long work in good order and soon.
//
// The first request sets a flag, for which work looks wherever it can stop. Not all work can: a library reads a file, a
// kernel runs, memory is given back. So a thread of this program waits for the flag too: where the process still lives
// 150 ms later, it says that the work was stopped, removes what is not finished (base/leftover.hpp) and
// ends the process. Files are whole or not there, journals are made to be killed, so no more is lost than the work.
//
// Work that has something to keep holds a KeptWork: then a first request only sets the flag, however long the rest
// takes, and the second one, half a second later or more, ends the process as above. A third is the system's own.
#pragma once

#include <string>

namespace palpate {

// From here on SIGINT, SIGTERM and SIGHUP (unless that was ignored before: nohup) are requests to stop; SIGXFSZ and
// SIGPIPE are ignored: what cannot be written is an error that is told. Once, by main().
void catchInterrupts();

// For messages: "palpate touch". Without it "palpate".
void nameWork(const std::string& work);

[[nodiscard]] bool interrupted() noexcept;

// Error(kCancelled). `kept`: what there is of the work nevertheless, and what to do.
void throwIfInterrupted(const std::string& work, const std::string& kept = "nothing was written; start it again");

// While one lives, a first request does not end the process. Any thread.
class KeptWork {
 public:
  KeptWork() noexcept;
  ~KeptWork();
  KeptWork(const KeptWork&) = delete;
  KeptWork& operator=(const KeptWork&) = delete;
};

// What is there although the process was ended as above, in the words that end a message. Without it: that nothing was
// written, or that files are there which were finished before. Any thread.
void tellWhatIsKept(const std::string& kept);

// The work is over, and main() is about to say how: from here on a request ends the process with this status and
// without a word. Does not return where the process is being ended already.
void endOfWork(int status) noexcept;

}  // namespace palpate
