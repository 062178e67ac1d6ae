// SPDX-License-Identifier: Apache-2.0
// servo/devices/report_port.hpp: a channel that carries reports to a device and back, whatever the bus: HID, later a
// serial line, in tests a device in memory.
//
// A report is a block of bytes that arrives whole or not at all. A report that is written has the report's number in
// front, 0 where the device numbers none, as hidapi wants it; one that is read has not, unless the device numbers its
// reports. Threads: one thread at a time uses a port. Blocking: read() for its time at most, write() until the bus has
// taken the report; so the servo never calls either (report_link.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace palpate {

// The largest report of full-speed HID, and its number in front.
inline constexpr std::size_t kMostReportBytes = 64;

struct Report {
  std::array<std::uint8_t, kMostReportBytes + 1> bytes{};
  std::size_t size = 0;  // of `bytes` that count [byte]

  [[nodiscard]] std::span<const std::uint8_t> content() const noexcept { return {bytes.data(), size}; }
  bool operator==(const Report& other) const noexcept;
};

enum class PortRead {
  kReport,   // one report
  kNothing,  // none yet; the time may not be over
  kGone,     // the device is not there any more
};

class ReportPort {
 public:
  virtual ~ReportPort() = default;
  // Waits for `timeout_ms` at most [ms]; 0: not at all.
  [[nodiscard]] virtual PortRead read(Report& report, int timeout_ms) noexcept = 0;
  // False: the device did not take it. It may be gone.
  [[nodiscard]] virtual bool write(const Report& report) noexcept = 0;
};

// Throws Error: kNotFound if there is no such device, kDevice if it cannot be opened, with why and what to do.
using PortOpener = std::function<std::unique_ptr<ReportPort>()>;

inline bool Report::operator==(const Report& other) const noexcept {
  return size == other.size &&
         std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), other.bytes.begin());
}

}  // namespace palpate
