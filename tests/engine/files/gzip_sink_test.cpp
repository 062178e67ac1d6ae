// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <malloc.h>

#include "engine/files/unpacker.hpp"
#include "engine/files/writers.hpp"
#include "tests/apps/report/temporary_folder.hpp"

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

// What zlib holds for a stream, some 256 KiB, would be lost with each. (The address sanitizer counts no such bytes,
// but finds what is lost by itself.)
TEST(GzipSink, AConstructorThatThrowsLosesNothing) {
  constexpr int kTimes = 1000;
  const ByteSink sink = UncopiedSink{};
  const std::size_t before = mallinfo2().uordblks;
  for (int i = 0; i < kTimes; ++i) EXPECT_THROW(GzipSink{sink}, std::runtime_error);
  EXPECT_LT(mallinfo2().uordblks, before + std::size_t{kTimes} * 100);
}

std::string packed(std::string_view bytes, std::size_t piece) {
  std::string all;
  const ByteSink sink = [&](std::string_view more) { all += more; };
  GzipSink to(sink);
  for (; !bytes.empty(); bytes.remove_prefix(std::min(piece, bytes.size()))) to.write(bytes.substr(0, piece));
  to.finish();
  return all;
}

// Runs of equal bytes and noise, in sizes around those of zlib's window and of the pieces in which the sink works.
TEST(GzipSink, IsUnpackedToTheSameBytes) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "packed.gz";
  std::mt19937 random(7);
  for (const std::size_t size : {0, 1, 32767, 32769, 65536, 65537, 1 << 20, (1 << 20) + 1, 3000000}) {
    std::string bytes(size, 'x');
    for (std::size_t n = 0; n < size; n += 1 + random() % 3)
      bytes[n] = static_cast<char>(n % 4096 < 1000 ? random() : 0);
    const std::string once = packed(bytes, size + 1);
    std::ofstream(file, std::ios::binary) << once;
    std::string got(size + 1, '?');
    got.resize(Unpacker(file.string(), 0, Packing::kGzip).read(got.data(), got.size()));  // checks the checksum, too
    EXPECT_TRUE(got == bytes) << size;
    EXPECT_TRUE(packed(bytes, size + 1) == once) << size;  // no time in it
    EXPECT_EQ(once.substr(4, 4), std::string(4, '\0')) << size;
  }
}

TEST(GzipSink, GivesOnWhatTheSinkThrows) {
  const ByteSink sink = [](std::string_view) { throw std::runtime_error("full"); };
  GzipSink packed(sink);
  packed.write("some bytes");
  EXPECT_THROW(packed.finish(), std::runtime_error);
}

}  // namespace gzip_sink_test
}  // namespace palpate
