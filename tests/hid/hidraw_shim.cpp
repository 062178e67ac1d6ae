// SPDX-License-Identifier: Apache-2.0
// A library to be preloaded: /dev/hidrawN becomes one end of a packet socket, whose other end an emulated device holds.
//
// umockdev (its own preloaded library) gives the program a /sys in which the device is found; it does not carry reads
// and polls as hidraw does. So here opening a node connects to the socket PALPATE_HID_SOCKETS/hidrawN; read, write and
// poll are then the kernel's own, on whole packets. hidapi asks hidraw for the size of its report descriptor, the
// program for its USB numbers, and fstat() must say that the node is a character device. A device that is gone gives
// ENODEV, as hidraw does.
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

namespace {

constexpr int kMostDescriptors = 1024;
constexpr int kHidrawMajor = 240;
int node_of[kMostDescriptors];  // the number of a hidraw node and 1; 0: another descriptor

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool isNode(int descriptor) {
  return descriptor >= 0 && descriptor < kMostDescriptors && node_of[descriptor] != 0;
}

// -1: the path is no node of ours.
int nodeOf(const char* path) {
  int node = -1;
  return path != nullptr && std::getenv("PALPATE_HID_SOCKETS") != nullptr &&
                 std::sscanf(path, "/dev/hidraw%d", &node) == 1
             ? node
             : -1;
}

int openNode(const char* path, int node) {
  if (access(path, R_OK | W_OK) != 0) return -1;  // the testbed's node has the rights
  const int descriptor = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (descriptor < 0 || descriptor >= kMostDescriptors) return -1;
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s/hidraw%d", std::getenv("PALPATE_HID_SOCKETS"), node);
  if (connect(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    close(descriptor);
    errno = ENODEV;
    return -1;
  }
  node_of[descriptor] = node + 1;
  return descriptor;
}

// As umockdev's /sys has them.
int numbersOf(int node, void* to) {
  char name[64];
  std::snprintf(name, sizeof name, "/sys/class/hidraw/hidraw%d/device/uevent", node);
  std::FILE* const file = std::fopen(name, "re");
  unsigned bus = 0, vendor = 0, product = 0;
  char line[256];
  bool is_known = false;
  while (file != nullptr && !is_known && std::fgets(line, sizeof line, file) != nullptr)
    is_known = std::sscanf(line, "HID_ID=%x:%x:%x", &bus, &vendor, &product) == 3;
  if (file != nullptr) std::fclose(file);
  auto* const info = static_cast<hidraw_devinfo*>(to);
  *info = {.bustype = bus, .vendor = static_cast<__s16>(vendor), .product = static_cast<__s16>(product)};
  errno = EINVAL;
  return is_known ? 0 : -1;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const auto mode = static_cast<mode_t>((flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, int) : 0);
  va_end(more);
  if (const int node = nodeOf(path); node >= 0) return openNode(path, node);
  static const auto real = next<int (*)(const char*, int, ...)>("open");
  return real(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const auto mode = static_cast<mode_t>((flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, int) : 0);
  va_end(more);
  if (const int node = nodeOf(path); node >= 0) return openNode(path, node);
  static const auto real = next<int (*)(const char*, int, ...)>("open64");
  return real(path, flags, mode);
}

int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* const argument = va_arg(more, void*);
  va_end(more);
  if (isNode(descriptor)) {
    if (request == static_cast<unsigned long>(HIDIOCGRDESCSIZE)) {
      *static_cast<int*>(argument) = 32;
      return 0;
    }
    if (request == static_cast<unsigned long>(HIDIOCGRAWINFO)) return numbersOf(node_of[descriptor] - 1, argument);
    errno = EINVAL;
    return -1;
  }
  static const auto real = next<int (*)(int, unsigned long, ...)>("ioctl");
  return real(descriptor, request, argument);
}

int fstat(int descriptor, struct stat* facts) noexcept {
  static const auto real = next<int (*)(int, struct stat*)>("fstat");
  const int result = real(descriptor, facts);
  if (result == 0 && isNode(descriptor)) {
    facts->st_mode = S_IFCHR | 0600;
    facts->st_rdev = makedev(kHidrawMajor, static_cast<unsigned>(node_of[descriptor] - 1));
  }
  return result;
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  static const auto real = next<ssize_t (*)(int, const void*, size_t)>("write");
  if (!isNode(descriptor)) return real(descriptor, bytes, count);
  const ssize_t sent = send(descriptor, bytes, count, MSG_NOSIGNAL);
  if (sent < 0 && (errno == EPIPE || errno == ECONNRESET)) errno = ENODEV;
  return sent;
}

int close(int descriptor) {
  static const auto real = next<int (*)(int)>("close");
  if (isNode(descriptor)) node_of[descriptor] = 0;
  return real(descriptor);
}

}  // extern "C"
