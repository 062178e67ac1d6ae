// SPDX-License-Identifier: Apache-2.0
#include "apps/report/trace_csv.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>

#include "base/atomic_file.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostBytesOfNumber = 32;  // of any double, float or 64-bit integer in shortest form
constexpr std::size_t kColumns = 22;
constexpr std::size_t kRowsBetween = 4096;  // some milliseconds

// One row of text in a buffer that is large enough for any record.
class Row {
 public:
  template <typename Number>
  void add(Number value) {
    end_ = std::to_chars(end_, buffer_ + sizeof(buffer_), value).ptr;
    *end_++ = ',';
  }
  void add(const double (&v)[3]) {
    for (const double x : v) add(x);
  }
  // NaN has two signs in binary; the trace knows one.
  void add(float value) {
    if (std::isnan(value)) value = std::abs(value);
    end_ = std::to_chars(end_, buffer_ + sizeof(buffer_), value).ptr;
    *end_++ = ',';
  }
  [[nodiscard]] std::string_view finish() {
    end_[-1] = '\n';
    return {buffer_, static_cast<std::size_t>(end_ - buffer_)};
  }

 private:
  char buffer_[kColumns * kMostBytesOfNumber];
  char* end_ = buffer_;
};

void writeRow(const TickRecord& record, AtomicFile& out) {
  Row row;
  row.add(record.tick);
  row.add(record.time_s);
  row.add(record.hip_W);
  row.add(record.vhip_W);
  row.add(record.normal_W);
  row.add(record.force_W);
  row.add(record.density);
  row.add(record.in_contact ? 1 : 0);
  row.add(record.plane_age_ticks);
  row.add(record.window_version);
  row.add(record.faults);
  row.add(record.tick_cost_ns);
  row.add(record.energy_J);
  row.add(record.edit_version);
  out.write(row.finish());
}

}  // namespace

void writeTraceCsv(const std::filesystem::path& file, const std::vector<TickRecord>& records,
                   const std::string& ended_early, const std::function<void()>& between) {
  AtomicFile out(file);
  out.write(kTraceHeader);
  out.write("\n");
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (between && i % kRowsBetween == 0) between();
    writeRow(records[i], out);
  }
  if (!ended_early.empty()) out.write("# " + ended_early + "\n");
  out.commit();
}

}  // namespace palpate
