// SPDX-License-Identifier: Apache-2.0
#include "apps/edit/script_reader.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/outside_text.hpp"

namespace palpate {
namespace {

constexpr std::size_t kShown = 120;  // characters of a command in a message
constexpr int kAskEvery_ms = 100;

std::string shortened(std::string_view text) {
  return text.size() <= kShown ? std::string(text) : std::string(text.substr(0, kShown)) + "...";
}

// The position of the first byte that is not text; npos: none. Bytes above 0x7f may be letters of any language.
std::size_t firstControl(std::string_view text) {
  const auto is_control = [](unsigned char c) { return (c < 0x20 && c != '\t' && c != '\r') || c == 0x7f; };
  const auto found = std::find_if(text.begin(), text.end(), is_control);
  return found == text.end() ? std::string_view::npos : static_cast<std::size_t>(found - text.begin());
}

}  // namespace

EditOrder editOrder(std::string_view text, const std::string& place, const std::filesystem::path& folder) {
  EditOrder order;
  if (const std::size_t at = firstControl(text); at != std::string_view::npos) {
    order.where = place;  // without the text, which would garble the message
    order.refusal =
        Error(Error::Code::kBadInput, place,
              fmt::format("it is no text: byte {} is 0x{:02x}", at + 1, static_cast<unsigned char>(text[at])),
              "give commands as text, for example remove:radius=2mm:at=0,0,0");
    return order;
  }
  order.where = fmt::format("{} '{}'", place, shortened(text));
  try {
    order.text = editText(text, EditUse::kPlaced, order.where);
    std::string& mesh = order.text.mesh_file;
    if (!mesh.empty()) mesh = (folder / mesh).string();  // an absolute path stays
  } catch (const Error& error) {
    order.refusal = error;
  }
  return order;
}

ScriptReader::ScriptReader(const std::string& name) : name_(name == "-" ? "standard input" : name) {
  if (name == "-") return;
  folder_ = std::filesystem::path(name).parent_path();
  descriptor_ = open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // does not wait for a pipe's writer
  const int error = errno;
  if (descriptor_ < 0) {
    throw Error(error == ENOENT ? Error::Code::kNotFound : Error::Code::kIo, name,
                error == ENOENT ? "there is no such script"
                                : fmt::format("the script cannot be read ({})", std::strerror(error)),
                "check its path and permissions, or give '-' for standard input");
  }
  struct stat facts {};
  if (fstat(descriptor_, &facts) == 0 && S_ISREG(facts.st_mode)) size_ = static_cast<std::size_t>(facts.st_size);
  if (!S_ISDIR(facts.st_mode)) return;
  close(descriptor_);
  throw Error(Error::Code::kBadInput, name, "it is a folder", "give a file with one command a line");
}

ScriptReader::~ScriptReader() {
  if (descriptor_ > 0) close(descriptor_);
}

double ScriptReader::fraction() const noexcept {
  return size_ == 0 ? 0 : std::min(1.0, static_cast<double>(read_.load()) / static_cast<double>(size_));
}

// Returns false if no more input is needed.
bool ScriptReader::waitForBytes(const EditQueue& queue, const std::function<bool()>& stopped) const {
  for (;;) {
    if (stopped() || queue.abandoned()) return false;
    pollfd waiting{descriptor_, POLLIN, 0};
    const int ready = poll(&waiting, 1, kAskEvery_ms);
    if (ready > 0 || (ready < 0 && errno != EINTR)) return true;
  }
}

void ScriptReader::take(char byte) {
  too_long_ = too_long_ || line_.size() >= kLongestLine;
  if (!too_long_) line_ += byte;
}

bool ScriptReader::give(EditQueue& queue) {
  ++number_;
  const std::string_view command = scriptCommand(number_ == 1 ? withoutByteOrderMark(line_) : line_);
  const std::string place = fmt::format("{} line {}", name_, number_);
  bool taken = true;
  if (too_long_) {
    EditOrder order{place, {}, {}};
    order.refusal = Error(Error::Code::kBadInput, place, fmt::format("it has more than {} bytes", kLongestLine),
                          "give one command a line");
    taken = queue.push(std::move(order));
  } else if (!command.empty()) {
    taken = queue.push(editOrder(command, place, folder_));
  }
  line_.clear();
  too_long_ = false;
  return taken;
}

void ScriptReader::giveTo(EditQueue& queue, const std::function<bool()>& stopped) {
  std::array<char, 65536> buffer{};
  while (waitForBytes(queue, stopped)) {
    const ssize_t count = read(descriptor_, buffer.data(), buffer.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) {
      throw Error(Error::Code::kIo, name_, fmt::format("reading failed ({})", std::strerror(errno)),
                  "check the script and give it again");
    }
    if (count == 0) {
      if (!line_.empty()) static_cast<void>(give(queue));  // the last line needs no end
      return;
    }
    read_ += static_cast<std::size_t>(count);
    for (ssize_t i = 0; i < count; ++i) {
      const char byte = buffer[static_cast<std::size_t>(i)];
      if (byte != '\n') {
        take(byte);
      } else if (!give(queue)) {
        return;
      }
    }
  }
}

}  // namespace palpate
