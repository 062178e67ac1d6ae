// SPDX-License-Identifier: Apache-2.0
// apps/console/message.hpp: the program's standard streams: messages on standard error, results on standard output.
//
// Nothing here throws: a message that cannot be written (a full disk, a closed terminal) is no reason to lose the work.
// At the end main() asks resultError() and reports a result that could not be written. Any thread; a message is one
// write.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace palpate {

// "palpate: TEXT" as a line of its own on standard error; control characters become '?'. Or, for programs that read
// messages, an object of JSON: {"time": "2026-01-31T12:00:00.000Z", "level": "info", "program": "palpate", "pid": 4711,
// "message": "TEXT"}.
void tellUser(std::string_view text) noexcept;
// The same with the level "error": what ends the program.
void tellError(std::string_view text) noexcept;

// Which of the two it is, from now on and in every program that this one starts: "text" or "json", from the environment
// variable PALPATE_LOG at first. To be called before there are threads.
enum class MessageForm { kText, kJson };
void setMessageForm(MessageForm form);
[[nodiscard]] bool messagesAreJson() noexcept;

// The text as it is, flushed.
void writeMessage(std::FILE* stream, std::string_view text) noexcept;

// To standard output. Control characters but ends of lines and tabs become '?': names of files may hold some. Set-up
// code, one thread.
void printText(std::string_view text) noexcept;
template <typename... Args>
void printResult(fmt::format_string<Args...> format, Args&&... args) {
  printText(fmt::format(format, std::forward<Args>(args)...));
}

// For results that are read while the program runs on.
void flushResults() noexcept;

// Flushes standard output. 0, or the errno value of the first error in writing a result.
[[nodiscard]] int resultError() noexcept;

// To be called first in main(). If descriptor 0, 1 or 2 is closed, the next file that is opened would take its place,
// and messages would go into that file. So each closed one is opened on /dev/null, but in the direction that is not
// used: reading from a closed input and writing to a closed output still fail, and reach no file.
void openClosedStreams() noexcept;

}  // namespace palpate
