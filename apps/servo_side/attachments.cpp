// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/attachments.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/other_version.hpp"

namespace palpate {
namespace {

// Counts come from another process; so many of anything fit into no memory, and their bytes into no number.
constexpr std::uint64_t kMost = std::uint64_t{1} << 34U;

std::size_t counted(std::uint64_t count) {
  if (count > kMost) refuseOtherVersion("attachment", "it is too long");
  return static_cast<std::size_t>(count);
}

class Writer {
 public:
  Writer(const char* name, std::size_t bytes) : memory_(name, std::max<std::size_t>(1, bytes)) {}
  void put(const void* values, std::size_t bytes) {
    if (bytes > 0) std::memcpy(memory_.data() + done_, values, bytes);
    done_ += bytes;
  }
  [[nodiscard]] SealedMemory taken() { return std::move(memory_); }

 private:
  SealedMemory memory_;
  std::size_t done_ = 0;
};

class Reader {
 public:
  Reader(Descriptor memory, std::size_t bytes)
      : memory_(std::move(memory), std::max<std::size_t>(1, bytes), SealedMemory::Pages::kWhenUsed) {}
  void take(void* values, std::size_t bytes) {
    if (bytes > 0) std::memcpy(values, memory_.data() + done_, bytes);
    done_ += bytes;
  }

 private:
  SealedMemory memory_;
  std::size_t done_ = 0;
};

void put(Writer& writer, const std::vector<Vec3>& points) {
  for (const Vec3& point : points) writer.put(point.data(), 3 * sizeof(double));
}
void take(Reader& reader, std::vector<Vec3>& points) {
  for (Vec3& point : points) reader.take(point.data(), 3 * sizeof(double));
}

// A bool holds 0 or 1 and nothing else, whatever the other side wrote.
void makeFlags(TickRecord& record) noexcept {
  auto* const bytes = reinterpret_cast<std::byte*>(&record);
  for (const std::size_t flag : {offsetof(TickRecord, in_contact), offsetof(TickRecord, damped)})
    bytes[flag] = bytes[flag] == std::byte{0} ? std::byte{0} : std::byte{1};
}

}  // namespace

SealedMemory wayMemory(const SampledPath& way) {
  Writer writer("palpate-way", way.times_s().size() * 4 * sizeof(double));
  writer.put(way.times_s().data(), way.times_s().size() * sizeof(double));
  put(writer, way.points_W());
  return writer.taken();
}

SampledPath wayOf(Descriptor memory, std::uint64_t points, bool is_linear) {
  const std::size_t count = counted(points);
  Reader reader(std::move(memory), count * 4 * sizeof(double));
  std::vector<double> times_s(count);
  std::vector<Vec3> points_W(count);
  reader.take(times_s.data(), count * sizeof(double));
  take(reader, points_W);
  return {std::move(times_s), std::move(points_W),
          is_linear ? SampledPath::Interpolation::kLinear : SampledPath::Interpolation::kCubic};
}

SealedMemory meshMemory(const TriangleMesh& mesh) {
  constexpr std::size_t kTriangle = sizeof mesh.triangles.front();
  Writer writer("palpate-mesh", mesh.vertices_W.size() * 3 * sizeof(double) + mesh.triangles.size() * kTriangle);
  put(writer, mesh.vertices_W);
  writer.put(mesh.triangles.data(), mesh.triangles.size() * kTriangle);
  return writer.taken();
}

TriangleMesh meshOf(Descriptor memory, std::uint64_t vertices, std::uint64_t triangles) {
  const std::size_t triangle_bytes = counted(triangles) * sizeof(std::array<std::uint32_t, 3>);
  Reader reader(std::move(memory), counted(vertices) * 3 * sizeof(double) + triangle_bytes);  // has that many bytes
  TriangleMesh mesh;
  mesh.vertices_W.resize(static_cast<std::size_t>(vertices));
  mesh.triangles.resize(static_cast<std::size_t>(triangles));
  take(reader, mesh.vertices_W);
  reader.take(mesh.triangles.data(), triangle_bytes);
  return mesh;
}

SealedMemory recordsMemory(const RunRecords& records) {
  const std::size_t ticks = records.ticks.size() * sizeof(TickRecord);
  Writer writer("palpate-records", ticks + records.recording.size());
  writer.put(records.ticks.data(), ticks);
  writer.put(records.recording.data(), records.recording.size());
  return writer.taken();
}

bool makeSound(TickRecord& record) noexcept {
  makeFlags(record);
  const auto is_place = [](const double(&v)[3]) {
    constexpr double kMost = 1e6;  // [m], [N]: beyond all that a servo meets
    return std::ranges::all_of(v, [](double x) { return std::abs(x) <= kMost; });
  };
  return is_place(record.hip_W) && is_place(record.vhip_W) && is_place(record.normal_W) && is_place(record.force_W) &&
         std::isfinite(record.time_s) && std::isfinite(record.depth_m) && std::isfinite(record.energy_J);
}

RunRecords recordsOf(Descriptor memory, std::uint64_t ticks, std::uint64_t recording_bytes) {
  RunRecords records;
  const std::size_t tick_bytes = counted(ticks) * sizeof(TickRecord);
  Reader reader(std::move(memory), tick_bytes + counted(recording_bytes));
  records.ticks.resize(static_cast<std::size_t>(ticks));
  records.recording.resize(static_cast<std::size_t>(recording_bytes));
  reader.take(static_cast<void*>(records.ticks.data()), tick_bytes);
  for (TickRecord& record : records.ticks) makeFlags(record);
  reader.take(records.recording.data(), records.recording.size());
  return records;
}

}  // namespace palpate
