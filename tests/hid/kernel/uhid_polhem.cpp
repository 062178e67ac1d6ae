// SPDX-License-Identifier: Apache-2.0
// uhid_polhem [--count N] [--other-usage] [--silent] [--faults SHARE] [--unplug-after REPORTS --replug-ms MS]
//
// Emulated arms as HID devices of the running kernel, by /dev/uhid, until it is killed.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include "tests/hid/kernel/guest_polhem.hpp"

namespace palpate {
namespace {

class UhidPolhem {
 public:
  UhidPolhem(const GuestOptions& options, int number) : options_(options), number_(number), polhem_(options.faults) {
    descriptor_ = open("/dev/uhid", O_RDWR | O_CLOEXEC);
    if (descriptor_ < 0) std::perror("/dev/uhid"), std::exit(1);
    plugIn();
  }
  [[nodiscard]] int descriptor() const { return descriptor_; }

  void serve() {
    uhid_event event = {};
    if (read(descriptor_, &event, sizeof event) <= 0) return;
    if (event.type == UHID_OPEN && !options_.silent) send(polhem_.arm().state());
    if (event.type != UHID_OUTPUT || options_.silent) return;
    Report report;
    report.size = std::min<std::size_t>(event.u.output.size, report.bytes.size());
    std::memcpy(report.bytes.data(), event.u.output.data, report.size);
    ++reports_;
    if (options_.silent_after >= 0 && reports_ > options_.silent_after) return;
    for (const Report& answer : polhem_.reports().answersTo(report)) send(answer);
    if (reports_ == options_.unplug_after) replug();
  }

 private:
  void tell(const uhid_event& event) {
    if (write(descriptor_, &event, sizeof event) < 0) std::perror("uhid");
  }
  void plugIn() {
    uhid_event event = {};
    event.type = UHID_CREATE2;
    uhid_create2_req& create = event.u.create2;
    std::snprintf(reinterpret_cast<char*>(create.name), sizeof create.name, "Emulated Polhem");
    std::snprintf(reinterpret_cast<char*>(create.uniq), sizeof create.uniq, "E%d", number_);
    const std::vector<std::uint8_t> descriptor = reportDescriptor(options_.other_usage);
    std::copy(descriptor.begin(), descriptor.end(), create.rd_data);
    create.rd_size = static_cast<__u16>(descriptor.size());
    create.bus = 3;  // USB
    create.vendor = 0x1234;
    create.product = 0x0006;
    tell(event);
  }
  void replug() {
    uhid_event event = {};
    event.type = UHID_DESTROY;
    tell(event);
    polhem_.arm().restart();
    usleep(static_cast<useconds_t>(1000 * options_.replug_ms));
    plugIn();
  }
  void send(const Report& report) {
    uhid_event event = {};
    event.type = UHID_INPUT2;
    event.u.input2.size = static_cast<__u16>(report.size);
    std::memcpy(event.u.input2.data, report.bytes.data(), report.size);
    tell(event);
  }

  const GuestOptions& options_;
  int number_, descriptor_, reports_ = 0;
  GuestPolhem polhem_;
};

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  using namespace palpate;
  const GuestOptions o = guestOptions(count, words);
  std::vector<std::unique_ptr<UhidPolhem>> devices;
  std::vector<pollfd> waiting;
  for (int i = 0; i < o.count; ++i) {
    devices.push_back(std::make_unique<UhidPolhem>(o, i));
    waiting.push_back({devices.back()->descriptor(), POLLIN, 0});
  }
  while (poll(waiting.data(), waiting.size(), -1) > 0) {
    for (std::size_t i = 0; i < devices.size(); ++i)
      if ((waiting[i].revents & POLLIN) != 0) devices[i]->serve();
  }
  return 0;
}
