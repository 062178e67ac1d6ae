// SPDX-License-Identifier: Apache-2.0
// apps/console/interrupt.hpp: Ctrl-C, `kill` and a closed terminal end long work soon and in good order.
//
// The first request sets a flag, which work checks wherever it can stop. Some work cannot stop: a library reads a file,
// a kernel runs, memory is freed. So a thread of the program watches the flag too. If the process still lives 150 ms
// later, this thread says that the work was stopped, removes unfinished files (base/leftover.hpp) and ends the process.
// Files are whole or not there, and journals survive a killed process, so only the work itself is lost.
//
// Work whose results should be kept holds a KeptWork. Then the first request only sets the flag, however long the work
// goes on. A second request, at least half a second later, ends the process as above. A third has the system's effect.
#pragma once

#include <string>

namespace palpate {

// To be called once, by main(). From then on SIGINT, SIGTERM and SIGHUP are requests to stop (SIGHUP stays ignored
// under nohup). SIGXFSZ and SIGPIPE are ignored, so that a failed write is reported as an error.
void catchInterrupts();

// Names the work in messages: "palpate touch". The default is "palpate".
void nameWork(const std::string& work);

[[nodiscard]] bool interrupted() noexcept;

// Throws Error(kCancelled) if interrupted. `kept`: what remains of the work, and what to do.
void throwIfInterrupted(const std::string& work, const std::string& kept = "nothing was written; start it again");

// While an object of this class exists, a first request does not end the process. Any thread.
class KeptWork {
 public:
  KeptWork() noexcept;
  ~KeptWork();
  KeptWork(const KeptWork&) = delete;
  KeptWork& operator=(const KeptWork&) = delete;
};

// Sets the end of the message for a process that is ended as above: what remains of the work. By default it says that
// nothing was written, or that files finished before are there. Any thread.
void tellWhatIsKept(const std::string& kept);

// For main(), when the work is over and it is about to report the result. From then on a request ends the process with
// this status and without a message. Does not return if the process is being ended already.
void endOfWork(int status) noexcept;

}  // namespace palpate
