// SPDX-License-Identifier: Apache-2.0
#include "tests/damage/judge.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/mesh/mesh_file.hpp"
#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "engine/field/volume.hpp"
#include "engine/files/volume_file.hpp"

namespace palpate::damage {
namespace {

using Kind = Verdict::Kind;

constexpr double kWallPerProcessor = 20;  // wall time over processor time, on a busy machine

template <class T>
std::uint32_t addTo(std::uint32_t crc, const T& plain) {
  return crc32c({reinterpret_cast<const char*>(&plain), sizeof plain}, crc);
}

std::uint32_t fingerprintOf(const Volume& volume) {
  const std::vector<float> values = volume.toDense();
  std::uint32_t crc = crc32c({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)});
  for (int axis = 0; axis < 3; ++axis) {
    crc = addTo(crc, volume.size()[axis]);
    crc = addTo(crc, volume.lattice().origin_W[axis]);
    crc = addTo(crc, volume.lattice().spacing_m[axis]);
    for (int row = 0; row < 3; ++row) crc = addTo(crc, volume.lattice().R_WL(row, axis));
  }
  return addTo(crc, volume.facts().is_level_set);
}

std::uint32_t fingerprintOf(const TriangleMesh& mesh) {
  std::uint32_t crc = 0;
  for (const Vec3& vertex : mesh.vertices_W) {
    for (int axis = 0; axis < 3; ++axis) crc = addTo(crc, vertex[axis]);
  }
  for (const auto& triangle : mesh.triangles) crc = addTo(crc, triangle);
  return crc;
}

// What the reader process reports: this struct, then the text.
struct Report {
  Kind kind = Kind::kCrashed;
  std::uint32_t fingerprint = 0;
};

Report readFileOf(const WholeFile& file, const std::string& name, std::string& words) {
  try {
    if (file.is_mesh) return {Kind::kRead, fingerprintOf(readMeshFile(name))};
    const Volume volume = loadVolume(name);
    words = volume.facts().remark;
    return {Kind::kRead, fingerprintOf(volume)};
  } catch (const Error& error) {
    words = error.what();
    const bool good = words.starts_with(name) && words.find('\n') == std::string::npos && !error.remedy().empty();
    return {good ? Kind::kRefused : Kind::kBadMessage, 0};
  } catch (const std::exception& other) {
    words = other.what();
    return {Kind::kThrown, 0};
  }
}

[[noreturn]] void runReader(int to, const WholeFile& file, const std::string& name) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  std::string words;
  const Report report = readFileOf(file, name, words);
  std::string bytes(reinterpret_cast<const char*>(&report), sizeof report);
  bytes += words.substr(0, 2000);
  static_cast<void>(!write(to, bytes.data(), bytes.size()));
  _exit(0);
}

// Reads until the other end is closed. False if nothing more came for so long.
bool readAll(int from, double seconds, std::string& bytes) {
  std::array<char, 4096> block;
  for (;;) {
    pollfd wait = {from, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(seconds * 1000));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    const ssize_t got = read(from, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return true;
    bytes.append(block.data(), static_cast<std::size_t>(got));
  }
}

double secondsOf(const rusage& used) {
  const auto of = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return of(used.ru_utime) + of(used.ru_stime);
}

}  // namespace

Verdict judge(const WholeFile& file, const std::string& folder, const Limits& limits) {
  const std::string name = file.loaded.empty() ? folder : folder + "/" + file.loaded;
  std::array<int, 2> ends = {-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  const pid_t reader = fork();
  if (reader < 0) throw std::runtime_error("no process");
  if (reader == 0) runReader(ends[1], file, name);
  close(ends[1]);
  std::string bytes;
  const bool in_time = readAll(ends[0], kWallPerProcessor * limits.seconds, bytes);
  close(ends[0]);
  if (!in_time) kill(reader, SIGKILL);
  int status = 0;
  rusage used = {};
  while (wait4(reader, &status, 0, &used) < 0 && errno == EINTR) {
  }
  Verdict verdict;
  verdict.seconds = secondsOf(used);
  verdict.memory_bytes = static_cast<std::size_t>(used.ru_maxrss) * 1024;
  if (!in_time || verdict.seconds > limits.seconds + 1) {  // the system counts whole seconds
    verdict.kind = Kind::kTooLong;
  } else if (bytes.size() < sizeof(Report)) {
    verdict.words = WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "the process ended";
  } else {
    Report report;
    std::memcpy(&report, bytes.data(), sizeof report);
    verdict.kind = verdict.memory_bytes > limits.memory_bytes ? Kind::kTooLarge : report.kind;
    verdict.fingerprint = report.fingerprint;
    verdict.words = bytes.substr(sizeof report);
  }
  return verdict;
}

}  // namespace palpate::damage
