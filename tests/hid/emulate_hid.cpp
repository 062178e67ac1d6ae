// SPDX-License-Identifier: Apache-2.0
// emulate_hid [OPTION ...] -- PROGRAM [ARGUMENT ...]: runs a program on a machine that has emulated HID devices.
//
// The devices' /sys is umockdev's, their nodes are packet sockets (hidraw_shim.cpp), and behind these are an emulated
// Polhem, whose hand goes along a path, or other things. Time is the reports': each one that the program writes moves
// the Polhem by one tick. Its own exit status is the program's. It prints nothing; --log writes what the devices took,
// --forces each force that the first one took.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <umockdev.h>
#include <unistd.h>

#include "servo/devices/placed_device.hpp"
#include "servo/safety/safety_gate.hpp"
#include "tests/hid/emulated_reports.hpp"

namespace palpate {
namespace {

struct Options {
  std::vector<std::string> devices = {"polhem"};  // polhem, teensy, gadget (a Polhem's numbers, but another thing),
                                                  // impostor (another file lies at a Polhem's node),
                                                  // silent (never answers), spacemouse, keyboard, none
  std::string path_csv;                           // the hand's way in the world; empty: it rests in the middle
  Vec3 at_W = Vec3::Zero();
  double rate_hz = 1000;
  double current_limit_A = 3;
  bool calibrated = true;
  ArmWiring wiring;         // of the motors
  int waits = 0;            // reports without force, after some with, after which the hand begins its way; 0: at once
  int asks_from = -1;       // report from which on its calibration button is pressed; 0: since before; -1: never
  bool forbidden = false;   // nobody may open the nodes
  int unplug_after = -1;    // reports after which it is unplugged; -1: never
  int replug_ms = -1;       // and plugged in again; -1: never
  int silent_after = -1;    // reports after which it answers no more; -1: never
  int garbled_after = -1;   // reports after which nothing it answers is a report of its; -1: never
  double slew_N_per_s = 0;  // that its account holds forces against, by the time between reports
  bool paced = false;       // it takes a millisecond for each report, as over a cable
  int press_from = -1;      // reports between which its handle's switch is pressed; -1: never
  int press_to = -1;
  double faults = 0;  // share of answers that are lost, garbled, short, double or late
  unsigned seed = 1;
  std::string log;     // file for the devices' own account
  std::string forces;  // file for the first device's forces, report by report
  std::vector<std::string> program;
};

constexpr const char* kUsage = "emulate_hid [OPTION ...] -- PROGRAM [ARGUMENT ...]";

Vec3 vectorOf(const std::string& text) {
  Vec3 v;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf", &v.x(), &v.y(), &v.z()) != 3) throw std::runtime_error(text);
  return v;
}

Options parsed(int count, char** words) {
  Options o;
  int i = 1;
  const auto value = [&] {
    if (++i >= count) throw std::runtime_error(kUsage);
    return std::string(words[i]);
  };
  for (; i < count && std::string(words[i]) != "--"; ++i) {
    const std::string word = words[i];
    if (word == "--devices") {
      o.devices.clear();
      std::istringstream names(value());
      for (std::string name; std::getline(names, name, ',');)
        if (name != "none") o.devices.push_back(name);
    } else if (word == "--path") {
      o.path_csv = value();
    } else if (word == "--at") {
      o.at_W = vectorOf(value());
    } else if (word == "--rate") {
      o.rate_hz = std::stod(value());
    } else if (word == "--uncalibrated") {
      o.calibrated = false;
    } else if (word == "--asks-from") {
      o.asks_from = std::stoi(value());
    } else if (word == "--motors") {  // what each plug drives, and how its leads are: 0,1,2:1,-1,1
      auto& [motor, sign, encoder] = o.wiring;
      if (std::sscanf(value().c_str(), "%d,%d,%d:%d,%d,%d", &motor[0], &motor[1], &motor[2], &sign[0], &sign[1],
                      &sign[2]) != 6)
        throw std::runtime_error(kUsage);
    } else if (word == "--waits") {
      o.waits = std::stoi(value());
    } else if (word == "--forbidden") {
      o.forbidden = true;
    } else if (word == "--unplug-after") {
      o.unplug_after = std::stoi(value());
    } else if (word == "--replug-ms") {
      o.replug_ms = std::stoi(value());
    } else if (word == "--silent-after") {
      o.silent_after = std::stoi(value());
    } else if (word == "--press") {
      if (std::sscanf(value().c_str(), "%d:%d", &o.press_from, &o.press_to) != 2) throw std::runtime_error(kUsage);
    } else if (word == "--paced") {
      o.paced = true;
    } else if (word == "--garbled-after") {
      o.garbled_after = std::stoi(value());
    } else if (word == "--slew") {
      o.slew_N_per_s = std::stod(value());
    } else if (word == "--faults") {
      o.faults = std::stod(value());
    } else if (word == "--seed") {
      o.seed = static_cast<unsigned>(std::stoul(value()));
    } else if (word == "--log") {
      o.log = value();
    } else if (word == "--forces") {
      o.forces = value();
    } else {
      throw std::runtime_error(word + ": " + kUsage);
    }
  }
  for (++i; i < count; ++i) o.program.emplace_back(words[i]);
  if (o.program.empty()) throw std::runtime_error(kUsage);
  return o;
}

// The hand's way in the device's frame: the world's, as the program's --place-at and its usual turn put it.
SampledPath pathOf(const Options& o) {
  if (o.path_csv.empty()) return {{0}, {Vec3(0, 0.02, 0)}, SampledPath::Interpolation::kLinear};
  std::ifstream in(o.path_csv);
  std::string line;
  std::getline(in, line);
  std::vector<double> times;
  std::vector<Vec3> points;
  while (std::getline(in, line)) {
    double t = 0, x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &x, &y, &z) != 4) continue;
    times.push_back(t);
    points.push_back(facingThePatient().transpose() * (Vec3(x, y, z) - o.at_W));
  }
  return {std::move(times), std::move(points), SampledPath::Interpolation::kLinear};
}

struct Look {
  const char* usb;    // "1234:0006"
  std::size_t bytes;  // of its reports
  const char* name;
  const char* usage;  // of its report descriptor, as bytes
};

Look lookOf(const std::string& device) {
  constexpr const char* kPolhem = "06abff0a0002";
  if (device == "teensy") return {"16C0:0486", 64, "Teensyduino RawHID", kPolhem};
  if (device == "gadget") return {"1234:0006", 14, "A lamp", "0600ff0901"};
  if (device == "spacemouse") return {"256F:C635", 7, "SpaceMouse Compact", "05010908"};
  if (device == "keyboard") return {"046D:C31C", 8, "Keyboard", "05010906"};
  return {"1234:0006", 14, "mbed Polhem", kPolhem};
}

std::string testbedText(const std::string& device, std::size_t number) {
  const Look look = lookOf(device);
  const std::string vendor = std::string(look.usb).substr(0, 4), product = std::string(look.usb).substr(5);
  const std::string usb = fmt::format("/devices/pci0000:00/0000:00:14.0/usb1/1-{}", number + 1);
  const std::string interface = fmt::format("{}/1-{}:1.0", usb, number + 1);
  const std::string hid = fmt::format("{}/0003:{}:{}.{:04}", interface, vendor, product, number + 1);
  const std::string descriptor =
      fmt::format("{}a101150026ff00750895{:02x}0901810295{:02x}09029102c0", look.usage, look.bytes, look.bytes);
  std::string hex = descriptor;
  std::erase(hex, ' ');
  std::string lower = vendor + product;
  return fmt::format(
      "P: {usb}\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: PRODUCT={vendor}/{product}/100\nA: idVendor={vendor}\\n\n"
      "A: idProduct={product}\\n\nA: manufacturer=Emulated\\n\nA: product={name}\\n\nA: serial=E{number}\\n\n"
      "A: bcdDevice=0100\\n\n\n"
      "P: {interface}\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\nA: bInterfaceNumber=00\\n\n\n"
      "P: {hid}\nE: SUBSYSTEM=hid\nE: HID_ID=0003:0000{vendor}:0000{product}\nE: HID_NAME=Emulated {name}\n"
      "E: HID_UNIQ=E{number}\nH: report_descriptor={hex}\n\n"
      "P: {hid}/hidraw/hidraw{number}\nN: hidraw{number}\nE: DEVNAME=/dev/hidraw{number}\nE: SUBSYSTEM=hidraw\n"
      "L: device=../../../{hid_name}\nA: dev={node}\n\n",
      fmt::arg("usb", usb), fmt::arg("interface", interface), fmt::arg("hid", hid), fmt::arg("vendor", vendor),
      fmt::arg("product", product), fmt::arg("name", look.name), fmt::arg("number", number), fmt::arg("hex", hex),
      fmt::arg("node", device == "impostor" ? std::string("1:3") : fmt::format("240:{}", number)),
      fmt::arg("hid_name", fmt::format("0003:{}:{}.{:04}", vendor, product, number + 1)));
}

class Socket {
 public:
  explicit Socket(int descriptor = -1) : descriptor_(descriptor) {}
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~Socket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  [[nodiscard]] int get() const { return descriptor_; }

 private:
  int descriptor_;
};

Socket listening(const std::string& file) {
  Socket socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", file.c_str());
  if (bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 || listen(socket.get(), 4) != 0)
    throw std::runtime_error(file + ": " + std::strerror(errno));
  return socket;
}

class Emulated {
 public:
  Emulated(const Options& options, std::string device, const std::string& sockets, std::size_t number, const Path& path)
      : options_(options),
        name_(std::move(device)),
        socket_(fmt::format("{}/hidraw{}", sockets, number)),
        listener_(listening(socket_)) {
    parameters_.report_bytes = static_cast<int>(lookOf(name_).bytes == 64 ? 64 : 14);
    parameters_.current_limit_A = options.current_limit_A;
    arm_ =
        std::make_unique<EmulatedPolhem>(parameters_, HandParameters{}, path, 1 / options.rate_hz, options.calibrated);
    if (options.calibrated) arm_->wire(options.wiring, parameters_.home_counts);
    arm_->waitForPushes(options.waits);
    if (options.asks_from == 0) arm_->pressCalibration();
    reports_of_ =
        std::make_unique<EmulatedReports>(*arm_, options.faults, options.seed + static_cast<unsigned>(number));
  }

  [[nodiscard]] int listener() const { return listener_.get(); }
  [[nodiscard]] int connection() const { return connection_.get(); }

  void accept() {
    Socket made(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    connection_ = std::move(made);
    if (answers()) send(arm_->state());
  }

  // False: the program closed the node.
  void serve() {
    Report report;
    const ssize_t got = recv(connection_.get(), report.bytes.data(), report.bytes.size(), 0);
    if (got <= 0) {
      connection_ = Socket();
      return;
    }
    report.size = static_cast<std::size_t>(got);
    ++reports_;
    times_us_.push_back(g_get_monotonic_time());
    if (reports_ == options_.asks_from) arm_->pressCalibration();
    arm_->press(reports_ >= options_.press_from && reports_ < options_.press_to);
    if (options_.paced) usleep(1000);
    if (!answers() || (options_.silent_after >= 0 && reports_ > options_.silent_after)) return;
    const bool garbled = options_.garbled_after >= 0 && reports_ > options_.garbled_after;
    for (Report answer : reports_of_->answersTo(report)) {
      if (garbled) answer.size = 3;
      send(answer);
    }
    if (reports_ == options_.unplug_after) unplug();
  }

  void unplug() {
    there_ = false;
    unlink(socket_.c_str());  // first, or the program is back before the listener has gone
    listener_ = Socket();
    connection_ = Socket();
    arm_->restart();
    forces_before_ = arm_->forces_D().size();
  }
  void plugIn() {
    listener_ = listening(socket_);
    there_ = true;
  }
  [[nodiscard]] bool wasUnplugged() const { return !there_; }

  // How far a force rose above what the slew limit allows in the time since the report before, and in the servo's tick
  // that may lie beside it. After a stall of the servo it must begin at nothing, since the arm's own watchdog may have
  // cut what there was; so no time beyond that of a stall counts.
  [[nodiscard]] double beyondSlew_N() const {
    const double stall_s = SafetyParameters{}.stall_s;
    double most_N = 0;
    for (std::size_t i = 1; i < std::min(times_us_.size(), arm_->forces_D().size()); ++i) {
      const Vec3& force = arm_->forces_D()[i];
      const double gap_s = 1e-6 * static_cast<double>(times_us_[i] - times_us_[i - 1]);
      const double time_s = std::min(gap_s, stall_s) + 1 / options_.rate_hz;
      const double rise_N = std::min((force - arm_->forces_D()[i - 1]).norm(), force.norm());
      most_N = std::max(most_N, rise_N - options_.slew_N_per_s * time_s);
    }
    return most_N;
  }
  // The longest time without any force after the first one [s].
  [[nodiscard]] double longestWithout_s() const {
    double longest_s = 0;
    std::int64_t since_us = -1;  // below 0: there is a force
    bool pressed = false;
    for (std::size_t i = 0; i < std::min(times_us_.size(), arm_->forces_D().size()); ++i) {
      if (arm_->forces_D()[i].norm() > 0) {
        pressed = true;
        since_us = -1;
      } else if (pressed) {
        if (since_us < 0) since_us = times_us_[i];
        longest_s = std::max(longest_s, 1e-6 * static_cast<double>(times_us_[i] - since_us));
      }
    }
    return longest_s;
  }

  // The force that acted with each report.
  [[nodiscard]] std::string forcesCsv() const {
    std::string csv = "time_us,x_N,y_N,z_N\n";
    for (std::size_t i = 0; i < std::min(times_us_.size(), arm_->forces_D().size()); ++i) {
      const Vec3& force = arm_->forces_D()[i];
      csv += fmt::format("{},{},{},{}\n", times_us_[i], force.x(), force.y(), force.z());
    }
    return csv;
  }

  // What the arm did, and what it goes on to do when nobody writes any more.
  [[nodiscard]] std::string account() {
    double largest_N = 0, slew_N = 0, later_N = 0;
    const double beyond_N = beyondSlew_N();
    Vec3 before = Vec3::Zero();
    for (std::size_t i = 0; i < arm_->forces_D().size(); ++i) {
      const Vec3& force = arm_->forces_D()[i];
      largest_N = std::max(largest_N, force.norm());
      // Down to nothing it may fall at once; towards anything else it goes by steps, whatever its direction.
      if (force.norm() > 0) slew_N = std::max(slew_N, (force - before).norm());
      if (forces_before_ > 0 && i >= forces_before_) later_N = std::max(later_N, force.norm());
      before = force;
    }
    arm_->passSilence(0.4);
    const double before_N = arm_->force_D().norm();
    arm_->passSilence(0.2);
    return fmt::format(
        "{} reports {} force_max_N {} force_rise_max_N {} faults {} left_400ms_N {} left_600ms_N {} silent {} extra {} "
        "spoiled {} force_after_unplugging_max_N {} beyond_slew_N {} without_s {}\n",
        name_, reports_, largest_N, slew_N, reports_of_->faults(), before_N, arm_->force_D().norm(),
        reports_of_->silent(), reports_of_->extra(), reports_of_->spoiled(), later_N, beyond_N, longestWithout_s());
  }

 private:
  [[nodiscard]] bool answers() const { return name_ == "polhem" || name_ == "teensy"; }
  void send(const Report& report) {
    if (connection_.get() >= 0)
      static_cast<void>(::send(connection_.get(), report.bytes.data(), report.size, MSG_NOSIGNAL | MSG_DONTWAIT));
  }
  const Options& options_;
  std::string name_, socket_;
  Socket listener_, connection_;
  PolhemParameters parameters_;
  std::unique_ptr<EmulatedPolhem> arm_;
  std::unique_ptr<EmulatedReports> reports_of_;
  int reports_ = 0;
  std::vector<std::int64_t> times_us_;  // of the reports
  std::size_t forces_before_ = 0;       // ticks before it was unplugged; 0: it was not
  bool there_ = true;
};

class Machine {
 public:
  explicit Machine(const Options& options) : options_(options), path_(pathOf(options)) {
    char folder[] = "/tmp/palpate-hid-XXXXXX";
    if (mkdtemp(folder) == nullptr) throw std::runtime_error("mkdtemp");
    sockets_ = folder;
    chmod(folder, 0755);  // for programs that become another user
    testbed_ = umockdev_testbed_new();
    gchar* root = umockdev_testbed_get_root_dir(testbed_);
    chmod(root, 0755);
    g_free(root);
    for (const std::string& device : options.devices) {
      plugIn(device, devices_.size());
      devices_.push_back(std::make_unique<Emulated>(options, device, sockets_, devices_.size(), path_));
    }
  }
  ~Machine() {
    g_object_unref(testbed_);
    for (std::size_t i = 0; i < devices_.size(); ++i) unlink(fmt::format("{}/hidraw{}", sockets_, i).c_str());
    rmdir(sockets_.c_str());
  }
  Machine(const Machine&) = delete;
  Machine& operator=(const Machine&) = delete;

  int run() {
    const pid_t child = start();
    int status = 0;
    std::int64_t gone_ms = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      serve();
      for (std::size_t i = 0; i < devices_.size(); ++i) {
        if (!devices_[i]->wasUnplugged()) continue;
        // The testbed cannot take a node of the same name twice. One that comes again stays in /sys meanwhile, and what
        // is behind it is gone: it cannot be opened. tests/hid/kernel has a kernel that takes it away and brings it.
        const bool comes_again = options_.replug_ms >= 0;
        if (gone_ms == 0 && !comes_again) umockdev_testbed_remove_device(testbed_, sysPath(i).c_str());
        if (gone_ms == 0) gone_ms = nowMs();
        if (!comes_again || nowMs() < gone_ms + options_.replug_ms) continue;
        devices_[i]->plugIn();
        gone_ms = 0;
      }
    }
    if (!options_.forces.empty()) std::ofstream(options_.forces) << devices_.front()->forcesCsv();
    if (!options_.log.empty()) {
      std::ofstream log(options_.log);
      for (const auto& device : devices_) log << device->account();
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  static std::int64_t nowMs() { return g_get_monotonic_time() / 1000; }
  std::string sysPath(std::size_t i) const {
    const std::string text = testbedText(options_.devices[i], i);
    const std::size_t at = text.rfind("P: ") + 3;
    return "/sys" + text.substr(at, text.find('\n', at) - at);
  }
  void plugIn(const std::string& device, std::size_t number) {
    GError* error = nullptr;
    if (umockdev_testbed_add_from_string(testbed_, testbedText(device, number).c_str(), &error) == 0)
      throw std::runtime_error(error != nullptr ? error->message : "umockdev");
    gchar* root = umockdev_testbed_get_root_dir(testbed_);
    const std::string node = fmt::format("{}/dev/hidraw{}", root, number);
    chmod(node.c_str(), options_.forbidden ? 0 : 0666);
    g_free(root);
  }

  pid_t start() {
    const pid_t child = fork();
    if (child != 0) return child;
    const char* preload = std::getenv("LD_PRELOAD");
    const std::string more = preload != nullptr ? fmt::format(":{}", preload) : "";
    setenv("LD_PRELOAD", fmt::format("{}:libumockdev-preload.so.0{}", PALPATE_HID_SHIM, more).c_str(), 1);
    setenv("PALPATE_HID_SOCKETS", sockets_.c_str(), 1);
    std::vector<char*> words;
    for (const std::string& word : options_.program) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    execvp(words[0], words.data());
    std::fprintf(stderr, "%s: %s\n", words[0], std::strerror(errno));
    _exit(127);
  }

  void serve() {
    std::vector<pollfd> waiting;
    for (const auto& device : devices_) {
      waiting.push_back({device->listener(), POLLIN, 0});
      waiting.push_back({device->connection(), POLLIN, 0});  // -1 is passed over
    }
    constexpr int kLook_ms = 10;
    if (poll(waiting.data(), waiting.size(), kLook_ms) <= 0) return;
    for (std::size_t i = 0; i < devices_.size(); ++i) {
      if (waiting[2 * i].revents != 0) devices_[i]->accept();
      if (waiting[2 * i + 1].revents != 0 && devices_[i]->connection() == waiting[2 * i + 1].fd) devices_[i]->serve();
    }
  }

  const Options& options_;
  SampledPath path_;
  std::string sockets_;
  UMockdevTestbed* testbed_;
  std::vector<std::unique_ptr<Emulated>> devices_;
};

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  try {
    const palpate::Options options = palpate::parsed(count, words);
    return palpate::Machine(options).run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "emulate_hid: %s\n", error.what());
    return 125;
  }
}
