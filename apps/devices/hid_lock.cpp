// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/hid_lock.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/descriptor.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path lockFile(const std::string& device) {
  std::string name = device;
  std::ranges::replace(name, '/', '_');
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime == nullptr || *runtime != '/') return fs::path("/run/lock") / ("palpate" + name);
  const fs::path folder = fs::path(runtime) / "palpate";
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  return folder / ("in-use" + name);
}

// Another user's file can be opened to read alone, which is enough for its lock.
Descriptor openLock(const fs::path& file) {
  constexpr int kHow = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  Descriptor own(open(file.c_str(), O_RDWR | O_CREAT | kHow, 0644));
  return own ? std::move(own) : Descriptor(open(file.c_str(), O_RDONLY | kHow));
}

// The number of the process that holds it, as it wrote itself; empty: it did not.
std::string holderOf(const Descriptor& lock) {
  char text[16] = {};
  const ssize_t count = pread(lock.get(), text, sizeof text - 1, 0);
  const std::string words(text, static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  return words.substr(0, words.find_first_not_of("0123456789"));
}

class LockedPort final : public ReportPort {
 public:
  LockedPort(Descriptor lock, std::unique_ptr<ReportPort> port) : lock_(std::move(lock)), port_(std::move(port)) {}
  PortRead read(Report& report, int timeout_ms) noexcept override { return port_->read(report, timeout_ms); }
  bool write(const Report& report) noexcept override { return port_->write(report); }

 private:
  Descriptor lock_;
  std::unique_ptr<ReportPort> port_;  // closed before the lock is given up
};

}  // namespace

std::unique_ptr<ReportPort> openHidAlone(const std::string& path, HidBackEnd back_end) {
  Descriptor lock = openLock(lockFile(path));
  if (lock && flock(lock.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    const std::string holder = holderOf(lock);
    throw Error(
        Error::Code::kDevice, path,
        fmt::format("another program of Palpate uses it{}", holder.empty() ? "" : fmt::format(" (process {})", holder)),
        "end that one first");
  }
  if (lock) {
    const std::string own = fmt::format("{}\n", getpid());
    if (ftruncate(lock.get(), 0) == 0) static_cast<void>(pwrite(lock.get(), own.data(), own.size(), 0));
  }
  return std::make_unique<LockedPort>(std::move(lock), openHid(path, back_end));
}

}  // namespace palpate
