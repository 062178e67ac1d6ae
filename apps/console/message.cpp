// SPDX-License-Identifier: Apache-2.0
#include "apps/console/message.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <initializer_list>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "base/outside_text.hpp"

namespace palpate {

void writeMessage(std::FILE* stream, std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
  std::clearerr(stream);  // the next one is tried again: a disk may have room by then
}

namespace {

int first_error = 0;  // of standard output

void note(bool failed) noexcept {
  if (failed && first_error == 0) first_error = errno != 0 ? errno : EIO;
}

constexpr const char* kForm = "PALPATE_LOG";
constexpr const char* kJson = "json";

std::string jsonLine(const std::string& text, const char* level) {
  const auto now = std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
  const nlohmann::ordered_json line = {
      {"time", fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(now)),
                           now.time_since_epoch().count() % 1000)},
      {"level", level},
      {"program", program_invocation_short_name},
      {"pid", getpid()},
      {"message", text}};
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void tell(std::string_view text, const char* level) noexcept {
  try {
    const std::string line = oneLine(std::string(text));
    writeMessage(stderr, (messagesAreJson() ? jsonLine(line, level) : "palpate: " + line) + "\n");
  } catch (...) {  // no memory for the line
    writeMessage(stderr, text);
  }
}

}  // namespace

bool messagesAreJson() noexcept {
  const char* const form = std::getenv(kForm);
  return form != nullptr && std::string_view(form) == kJson;
}

void setMessageForm(MessageForm form) {
  setenv(kForm, form == MessageForm::kJson ? kJson : "text", 1);
}

void tellUser(std::string_view text) noexcept {
  tell(text, "info");
}

void tellError(std::string_view text) noexcept {
  tell(text, "error");
}

void printText(std::string_view text) noexcept {
  const auto is_unfit = [](char c) { return c != '\n' && c != '\t' && isControl(c); };
  errno = 0;
  while (!text.empty()) {
    const auto bad = std::ranges::find_if(text, is_unfit);
    const auto fit = static_cast<std::size_t>(bad - text.begin());
    note(std::fwrite(text.data(), 1, fit, stdout) < fit);
    if (bad != text.end()) note(std::fputc('?', stdout) == EOF);
    text.remove_prefix(fit + (bad != text.end() ? 1 : 0));
  }
}

void flushResults() noexcept {
  errno = 0;
  note(std::fflush(stdout) != 0);
}

int resultError() noexcept {
  errno = 0;
  note(std::fflush(stdout) != 0 || std::ferror(stdout) != 0);
  return first_error;
}

// In rising order, since open() gives the lowest number that is free.
void openClosedStreams() noexcept {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    const int opened = open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (opened >= 0 && opened != descriptor) {  // cannot happen: all lower descriptors are open
      dup2(opened, descriptor);
      close(opened);
    }
  }
}

}  // namespace palpate
