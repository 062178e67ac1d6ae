// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include <gtest/gtest.h>
#include <malloc.h>

#include "engine/files/writers.hpp"

namespace palpate {
namespace gzip_sink_test {

struct UncopiedSink {
  UncopiedSink() = default;
  UncopiedSink(const UncopiedSink& other) : copies(other.copies + 1) {
    if (copies > 1) throw std::runtime_error("no copy");
  }
  void operator()(std::string_view) const {}
  int copies = 0;
};

// What libarchive holds for a stream, some KiB, would be lost with each. (The address sanitizer counts no such bytes,
// but finds what is lost by itself.)
TEST(GzipSink, AConstructorThatThrowsLosesNothing) {
  constexpr int kTimes = 1000;
  const ByteSink sink = UncopiedSink{};
  const std::size_t before = mallinfo2().uordblks;
  for (int i = 0; i < kTimes; ++i) EXPECT_THROW(GzipSink{sink}, std::runtime_error);
  EXPECT_LT(mallinfo2().uordblks, before + std::size_t{kTimes} * 100);
}

TEST(GzipSink, GivesOnWhatTheSinkThrows) {
  const ByteSink sink = [](std::string_view) { throw std::runtime_error("full"); };
  GzipSink packed(sink);
  packed.write("some bytes");
  EXPECT_THROW(packed.finish(), std::runtime_error);
}

}  // namespace gzip_sink_test
}  // namespace palpate
