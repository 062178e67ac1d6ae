// SPDX-License-Identifier: Apache-2.0
#include "servo/hid/hidraw_node.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <linux/hidraw.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

constexpr std::string_view kNodes = "/dev/hidraw";

bool isNodesPath(std::string_view path) {
  const std::string_view number = path.substr(std::min(path.size(), kNodes.size()));
  return path.starts_with(kNodes) && !number.empty() && number.find_first_not_of("0123456789") == number.npos;
}

// The kernel's own word for which device it is, whatever somebody has put at its path.
bool isHidraw(const Descriptor& node, const std::string& path) {
  struct stat facts {};
  if (fstat(node.get(), &facts) != 0 || !S_ISCHR(facts.st_mode)) return false;
  std::string numbers;
  std::getline(std::ifstream("/sys/class/hidraw/" + path.substr(path.rfind('/') + 1) + "/dev"), numbers);
  return numbers == formatted("{}:{}", major(facts.st_rdev), minor(facts.st_rdev));
}

class NodePort final : public ReportPort {
 public:
  explicit NodePort(Descriptor node) : node_(std::move(node)) {}

  // hidraw has whole reports: a read gives one. A device that is gone is known by poll(2) alone.
  [[nodiscard]] PortRead read(Report& report, int timeout_ms) noexcept override {
    report.size = 0;
    pollfd wait = {.fd = node_.get(), .events = POLLIN, .revents = 0};
    const int found = poll(&wait, 1, timeout_ms);
    if (found == 0 || (found < 0 && errno == EINTR)) return PortRead::kNothing;
    if (found < 0 || (wait.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return PortRead::kGone;
    const ssize_t got = ::read(node_.get(), report.bytes.data(), report.bytes.size());
    if (got < 0) return errno == EAGAIN || errno == EINTR ? PortRead::kNothing : PortRead::kGone;
    report.size = static_cast<std::size_t>(got);
    return got > 0 ? PortRead::kReport : PortRead::kNothing;
  }
  [[nodiscard]] bool write(const Report& report) noexcept override {
    return ::write(node_.get(), report.bytes.data(), report.size) == static_cast<ssize_t>(report.size);
  }

 private:
  Descriptor node_;
};

}  // namespace

Descriptor openHidrawNode(const std::string& path) {
  if (!isNodesPath(path))
    throw Error(Error::Code::kBadInput, path, "it is no device of hidraw", "'palpate doctor' lists these");
  Descriptor node(open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW));
  if (!node) {
    if (errno == ENOENT || errno == ENODEV || errno == ENXIO)
      throw Error(Error::Code::kNotFound, path, "it is not there any more", "plug the device in");
    if (errno == EACCES || errno == EPERM)
      throw Error(Error::Code::kDevice, path, "you have no right to use it",
                  "run 'palpate doctor --install-udev', which installs a rule for it, and plug the device in again");
    throw Error(Error::Code::kDevice, path, formatted("it cannot be opened: {}", std::strerror(errno)),
                "see that no other program uses it");
  }
  if (!isHidraw(node, path))
    throw Error(Error::Code::kBadInput, path, "what lies there is no device of hidraw", "'palpate doctor' lists these");
  return node;
}

HidNumbers numbersAt(const Descriptor& node, const std::string& path) {
  hidraw_devinfo info{};
  if (ioctl(node.get(), HIDIOCGRAWINFO, &info) != 0)
    throw Error(Error::Code::kDevice, path, formatted("the kernel does not say what it is: {}", std::strerror(errno)),
                "plug the device in again");
  return {static_cast<std::uint16_t>(info.vendor), static_cast<std::uint16_t>(info.product)};
}

std::unique_ptr<ReportPort> portAt(Descriptor node) {
  return std::make_unique<NodePort>(std::move(node));
}

}  // namespace palpate
