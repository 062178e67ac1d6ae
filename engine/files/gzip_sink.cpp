// SPDX-License-Identifier: Apache-2.0
// gzip through zlib. The stream holds no time and no name, so the same bytes give the same file.
#include <algorithm>
#include <array>
#include <new>

#include <zlib.h>

#include "engine/files/writers.hpp"

namespace palpate {

struct GzipSink::State {
  explicit State(ByteSink to) : sink(std::move(to)) {
    constexpr int kLevel = 4, kLargestWindow = 15, kGzip = 16, kMemory = 8;  // the last is zlib's default
    if (deflateInit2(&stream, kLevel, Z_DEFLATED, kLargestWindow + kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
    clear();
  }
  ~State() { deflateEnd(&stream); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  // Packs what is in the stream. Passes it on in blocks, and at the end what is left.
  void pack(int flush) {
    int result = Z_OK;
    do {
      result = deflate(&stream, flush);  // cannot fail: the stream is whole, and there is room
      if (stream.avail_out == 0 || result == Z_STREAM_END) passOn();
    } while (stream.avail_in > 0 || (flush == Z_FINISH && result != Z_STREAM_END));
  }

  void passOn() {
    const std::size_t count = packed.size() - stream.avail_out;
    clear();
    if (count > 0) sink({reinterpret_cast<const char*>(packed.data()), count});
  }
  void clear() noexcept {
    stream.next_out = packed.data();
    stream.avail_out = static_cast<uInt>(packed.size());
  }

  ByteSink sink;
  z_stream stream = {};
  std::array<Bytef, std::size_t{1} << 16> packed = {};
};

GzipSink::GzipSink(const ByteSink& sink) : state_(std::make_unique<State>(sink)) {}

GzipSink::~GzipSink() = default;

void GzipSink::write(std::string_view bytes) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kPiece, bytes.size()))) {
    // zlib does not write there.
    state_->stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    state_->stream.avail_in = static_cast<uInt>(std::min(kPiece, bytes.size()));
    state_->pack(Z_NO_FLUSH);
  }
}

void GzipSink::finish() {
  state_->stream.avail_in = 0;
  state_->pack(Z_FINISH);
}

}  // namespace palpate
